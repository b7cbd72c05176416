#include "coppice/files/map_file.h"

#include <memory>
#include <sstream>

#include <gtest/gtest.h>
#include <png.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <zlib.h>

#include "coppice/files/input_error.h"
#include "tests/support.h"

namespace coppice {
namespace {

using test::TemporaryFolder;

std::string error_of_map(const std::filesystem::path& path) {
  try {
    read_map(path);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return {};
}

TEST(MapFile, MovingAiMapsAreRead) {
  const TemporaryFolder folder;
  const OccupancyMap map =
      read_map(folder.write("a.map", "type octile\nheight 2\nwidth 8\nmap\n.GS@OTWE\n@.......\n"));
  EXPECT_EQ(map.width, 8);
  EXPECT_EQ(map.height, 2);
  EXPECT_EQ(map.resolution, 1);
  const std::vector<std::uint8_t> expected{0, 0, 0, 1, 1, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(map.blocked, expected);
}

TEST(MapFile, CarriageReturnsAndAMissingLastLineEndAreAccepted) {
  const TemporaryFolder folder;
  const OccupancyMap map =
      read_map(folder.write("a.map", "type octile\r\nheight 2\r\nwidth 2\r\nmap\r\n.@\r\n@."));
  EXPECT_EQ(map.blocked, (std::vector<std::uint8_t>{0, 1, 1, 0}));
}

TEST(MapFile, EveryMistakeNamesTheLine) {
  const TemporaryFolder folder;
  const std::vector<std::array<std::string, 2>> cases{
      {"", "a.map:1: the file ends here"},
      {"kind octile\n", "a.map:1: expected \"type octile\""},
      {"type octile\nheight x\nwidth 2\nmap\n", "a.map:2: expected \"height N\""},
      {"type octile\nheight 1000000000\nwidth 1000000000\nmap\n", "a.map:2: expected \"height N\""},
      {"type octile\nheight 2\nwidth 0\nmap\n", "a.map:3: expected \"width N\""},
      {"type octile\nheight 2\nwidth 2\nmop\n", "a.map:4: expected \"map\""},
      {"type octile\nheight 2\nwidth 2\nmap\n..\n", "a.map:6: the file ends here, expected row 2 of 2"},
      {"type octile\nheight 2\nwidth 2\nmap\n..\n.\n", "a.map:6: expected 2 cells, found 1"},
      {"type octile\nheight 1\nwidth 2\nmap\n..\n..\n", "a.map:6: more than the 1 rows"}};
  for (const auto& [content, expected] : cases) {
    const std::string error = error_of_map(folder.write("a.map", content));
    EXPECT_NE(error.find(expected), std::string::npos) << content << "\nsaid: " << error;
  }
  EXPECT_NE(error_of_map(folder.path() / "none.map").find("none.map: cannot be read"), std::string::npos);
  EXPECT_NE(error_of_map(folder.write("a.txt", "")).find("unknown kind of map"), std::string::npos);
}

TEST(MapFile, AWrittenMapIsReadBack) {
  const TemporaryFolder folder;
  OccupancyMap map;
  map.width = 3;
  map.height = 2;
  map.blocked = {0, 1, 0, 1, 1, 0};
  write_map(folder.path() / "b.map", map);
  EXPECT_EQ(read_map(folder.path() / "b.map"), map);
}

// White is free, black is blocked, grey is unknown. The last row of the picture is row 0 of the map.
TEST(MapFile, RosPgmMapsAreRead) {
  const TemporaryFolder folder;
  std::string pgm = "P5\n# made by a test\n3 2\n255\n";
  for (const int shade : {254, 0, 205, 254, 254, 0}) pgm += static_cast<char>(shade);
  folder.write("site.pgm", pgm);
  const OccupancyMap map =
      read_map(folder.write("site.yaml",
                            "image: site.pgm\nresolution: 0.05\norigin: [-1.5, 2.0, 0.0]\nnegate: "
                            "0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"));
  EXPECT_EQ(map.resolution, 0.05);
  EXPECT_EQ(map.origin, Point2(-1.5, 2));
  EXPECT_EQ(map.y_axis, YAxis::up);
  EXPECT_EQ(map.blocked, (std::vector<std::uint8_t>{0, 0, 1, 0, 1, 1}));
}

TEST(MapFile, NegateInvertsTheShades) {
  const TemporaryFolder folder;
  folder.write("site.pgm", "P2\n2 1\n255\n255 0\n");
  const std::string yaml =
      "image: site.pgm\nresolution: 1\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  EXPECT_EQ(read_map(folder.write("a.yaml", yaml + "negate: 0\n")).blocked,
            (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(read_map(folder.write("b.yaml", yaml + "negate: 1\n")).blocked,
            (std::vector<std::uint8_t>{1, 0}));
}

TEST(MapFile, RosPngMapsAreRead) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> shades{254, 0, 205, 254};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = 2;
  image.height = 2;
  image.format = PNG_FORMAT_GRAY;
  ASSERT_NE(
      png_image_write_to_file(&image, (folder.path() / "site.png").c_str(), 0, shades.data(), 0, nullptr), 0);
  const OccupancyMap map =
      read_map(folder.write("site.yaml", "image: site.png\nresolution: 1\norigin: [0, 0, 0]\n"));
  EXPECT_EQ(map.blocked, (std::vector<std::uint8_t>{1, 0, 0, 1}));
}

std::string big_endian(std::uint32_t number) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(number >> shift);
  return bytes;
}

std::string png_chunk(const std::string& kind, const std::string& content) {
  const std::string checked = kind + content;
  const auto sum =
      crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()));
  return big_endian(static_cast<std::uint32_t>(content.size())) + checked +
         big_endian(static_cast<std::uint32_t>(sum));
}

constexpr int grey = 0;
constexpr int colour = 2;
constexpr int palette = 3;
constexpr int grey_alpha = 4;
constexpr int colour_alpha = 6;

/// A picture with one row of samples as they stand in the file. `chunks` come before them.
std::string png_row(std::uint32_t width, int depth, int kind, const std::string& samples,
                    const std::string& chunks = {}) {
  const std::string row = '\0' + samples;  // no filter
  std::string packed(compressBound(static_cast<uLong>(row.size())), '\0');
  uLongf size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(row.data()),
           static_cast<uLong>(row.size()));
  packed.resize(size);
  std::string format{static_cast<char>(depth), static_cast<char>(kind), 0, 0, 0};
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", big_endian(width) + big_endian(1) + format) + chunks +
         png_chunk("IDAT", packed) + png_chunk("IEND", "");
}

/// The cells of a picture: '.' is free, '#' is not.
std::string cells_of(const std::string& picture, const std::string& fields = {},
                     const std::string& name = "site.png") {
  const TemporaryFolder folder;
  folder.write(name, picture);
  const OccupancyMap map =
      read_map(folder.write("site.yaml", "image: " + name + "\nresolution: 1\norigin: [0, 0, 0]\n" + fields));
  std::string cells;
  for (const std::uint8_t blocked : map.blocked) cells += blocked != 0 ? '#' : '.';
  return cells;
}

std::string octets(const std::vector<int>& values) {
  return {values.begin(), values.end()};
}

TEST(MapFile, PngSamplesCountWithoutGammaCorrection) {
  const std::string shades = octets({254, 205, 0, 206});
  const std::string gamma = png_chunk("gAMA", big_endian(100000));
  EXPECT_EQ(cells_of(png_row(4, 8, grey, shades)), ".##.");
  EXPECT_EQ(cells_of(png_row(4, 8, grey, shades, gamma)), ".##.");
  EXPECT_EQ(cells_of(png_row(4, 8, grey, shades, png_chunk("gAMA", big_endian(22000)))), ".##.");
  EXPECT_EQ(cells_of(png_row(4, 8, grey, shades, png_chunk("sRGB", octets({0})))), ".##.");
  EXPECT_EQ(cells_of(png_row(4, 16, grey, octets({254, 254, 205, 205, 0, 0, 206, 206}))), ".##.");
  EXPECT_EQ(cells_of(png_row(4, 16, grey, octets({254, 254, 205, 205, 0, 0, 206, 206}), gamma)), ".##.");
}

TEST(MapFile, TheShadeIsTheMeanOfTheColours) {
  EXPECT_EQ(cells_of(png_row(4, 8, colour, octets({254, 254, 254, 0, 255, 0, 255, 255, 0, 0, 0, 0}))),
            ".###");
  // (205 + 205 + 206) / 3 is a third above the shade of an unknown cell.
  EXPECT_EQ(cells_of(png_row(2, 8, colour, octets({205, 205, 206, 204, 205, 206}))), ".#");
  EXPECT_EQ(cells_of(png_row(2, 16, colour, octets({254, 0, 254, 0, 254, 0, 0, 0, 255, 255, 0, 0}))), ".#");
}

TEST(MapFile, LowBitDepthsAndPalettesAreScaledToAllShades) {
  EXPECT_EQ(cells_of(png_row(4, 1, grey, octets({0b10100000}))), ".#.#");
  EXPECT_EQ(cells_of(png_row(4, 2, grey, octets({0b11100100}))), ".###");
  EXPECT_EQ(cells_of(png_row(4, 4, grey, octets({0xfd, 0xc0}))), "..##");  // 221; 204
  const std::string colours = png_chunk("PLTE", octets({254, 254, 254, 0, 0, 0, 205, 205, 205, 0, 255, 0}));
  EXPECT_EQ(cells_of(png_row(4, 8, palette, octets({0, 1, 2, 3}), colours)), ".###");
  EXPECT_EQ(cells_of(png_row(4, 2, palette, octets({0b00011011}), colours)), ".###");
}

TEST(MapFile, TransparentPixelsAreUnknown) {
  for (const std::string mode : {"trinary", "scale"}) {
    const std::string field = "mode: " + mode + "\n";
    EXPECT_EQ(cells_of(png_row(4, 8, grey_alpha, octets({254, 255, 254, 254, 254, 0, 0, 255})), field),
              ".###");
    EXPECT_EQ(cells_of(png_row(2, 8, colour_alpha, octets({254, 254, 254, 255, 254, 254, 254, 9})), field),
              ".#");
    EXPECT_EQ(cells_of(png_row(2, 8, grey, octets({254, 255}), png_chunk("tRNS", octets({0, 254}))), field),
              "#.");
    const std::string colours = png_chunk("PLTE", octets({254, 254, 254, 255, 255, 255}));
    EXPECT_EQ(
        cells_of(png_row(2, 8, palette, octets({0, 1}), colours + png_chunk("tRNS", octets({7}))), field),
        "#.");
  }
  EXPECT_EQ(cells_of(png_row(3, 8, grey_alpha, octets({0, 255, 0, 0, 1, 255})), "mode: raw\n"), ".##");
}

TEST(MapFile, TheKindOfAPictureIsReadFromItsContent) {
  const std::string png = png_row(2, 8, grey, octets({254, 0}));
  const std::string pgm = "P5\n2 1\n255\n" + octets({254, 0});
  for (const std::string name : {"a.PNG", "a.png", "a.pgm", "a", "my site.v2"}) {
    EXPECT_EQ(cells_of(png, {}, name), ".#") << name;
    EXPECT_EQ(cells_of(pgm, {}, name), ".#") << name;
  }
}

TEST(MapFile, OtherKindsOfPicturesAreRefusedByName) {
  const std::vector<std::array<std::string, 2>> cases{{"\xff\xd8\xff\xe0 JFIF", "a JPEG picture"},
                                                      {"BM rest", "a BMP picture"},
                                                      {"GIF89a", "a GIF picture"},
                                                      {"P6\n1 1\n255\nabc", "a PPM picture"},
                                                      {"P4\n8 1\na", "a PBM picture"},
                                                      {"", "neither a PNG nor a PGM"}};
  for (const auto& [picture, expected] : cases) {
    const TemporaryFolder folder;
    folder.write("site.png", picture);
    const std::string error =
        error_of_map(folder.write("site.yaml", "image: site.png\nresolution: 1\norigin: [0, 0, 0]\n"));
    EXPECT_NE(error.find("site.png: is " + expected), std::string::npos) << error;
  }
}

TEST(MapFile, ADamagedPngPictureIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = png_row(64, 8, colour, std::string(192, '\x7f'));
  for (std::size_t size = 8; size < whole.size(); ++size) {
    folder.write("site.png", whole.substr(0, size));
    const std::string error =
        error_of_map(folder.write("site.yaml", "image: site.png\nresolution: 1\norigin: [0, 0, 0]\n"));
    EXPECT_NE(error.find("site.png: cannot be read as PNG: "), std::string::npos) << size << ": " << error;
  }
}

TEST(MapFile, BooleansAndModesMayBeSpeltAsInYaml) {
  const std::string picture = png_row(2, 8, grey, octets({255, 0}));
  for (const std::string no : {"0", "no", "No", "NO", "n", "false", "False", "FALSE", "off", "Off", "'no'"})
    EXPECT_EQ(cells_of(picture, "negate: " + no + "\n"), ".#") << no;
  for (const std::string yes : {"1", "yes", "Yes", "YES", "y", "true", "True", "TRUE", "on", "On"})
    EXPECT_EQ(cells_of(picture, "negate: " + yes + "\n"), "#.") << yes;
  for (const std::string mode : {"trinary", "Trinary", "SCALE", "\"Scale\""})
    EXPECT_EQ(cells_of(picture, "mode: " + mode + "\n"), ".#") << mode;
  EXPECT_EQ(cells_of(picture, "mode: Raw\n"), "#.");
}

TEST(MapFile, ByteOrderMarksAndWindowsLineEndsChangeNothing) {
  const TemporaryFolder folder;
  const std::string mark = "\xef\xbb\xbf";
  folder.write("site.pgm", "P5\r\n2 1\r\n255\r\n" + octets({254, 0}));
  const std::string fields = "image: site.pgm\r\nresolution: 1\r\norigin: [0, 0, 0]\r\nnegate: no\r\n";
  for (const std::string name : {"a.yaml", "A.YAML", "a.yml"})
    EXPECT_EQ(read_map(folder.write(name, mark + fields)).blocked, (std::vector<std::uint8_t>{0, 1})) << name;
  const std::string rows = "type octile\r\nheight 1\r\nwidth 2\r\nmap\r\n.@\r\n";
  for (const std::string name : {"a.map", "A.MAP"})
    EXPECT_EQ(read_map(folder.write(name, mark + rows)).blocked, (std::vector<std::uint8_t>{0, 1})) << name;
  EXPECT_NE(error_of_map(folder.write("b.map", "\xff\xfet")).find("b.map:1: is UTF-16"), std::string::npos);
}

/// What is logged while `fn` runs.
template <class Fn>
std::string logged(Fn&& fn) {
  std::ostringstream lines;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(lines)));
  fn();
  spdlog::set_default_logger(before);
  return lines.str();
}

TEST(MapFile, AThresholdThatMakesUnknownCellsFreeCausesAWarning) {
  const std::string picture = png_row(3, 8, grey, octets({254, 205, 0}));
  const auto warning = [&](const std::string& fields) { return logged([&] { cells_of(picture, fields); }); };
  EXPECT_NE(warning("free_thresh: 0.25\n").find("site.yaml: free_thresh 0.25 makes shade 205 free"),
            std::string::npos);
  EXPECT_NE(warning("mode: scale\nfree_thresh: 0.2\n").find("makes shade 205 free"), std::string::npos);
  EXPECT_NE(warning("negate: 1\noccupied_thresh: 0.9\nfree_thresh: 0.85\n").find("(negate is on)"),
            std::string::npos);
  EXPECT_EQ(warning(""), "");
  EXPECT_EQ(warning("free_thresh: 0.196\n"), "");
  EXPECT_EQ(warning("negate: 1\nfree_thresh: 0.25\n"), "");
  EXPECT_EQ(warning("mode: raw\nfree_thresh: 0.25\n"), "");
}

// The map of another program may have meant them to be free, as E of the League of Robot Runners once was.
TEST(MapFile, CellsThatTheFormatDoesNotHaveCauseAWarning) {
  const TemporaryFolder folder;
  const auto warning = [&](const std::string& rows) {
    return logged([&] { read_map(folder.write("a.map", "type octile\nheight 2\nwidth 4\nmap\n" + rows)); });
  };
  EXPECT_NE(warning(".x#x\n....\n")
                .find("a.map: 1 cell \"#\", 2 cells \"x\" count as blocked: the format does not have them"),
            std::string::npos);
  EXPECT_NE(warning(".\t..\n....\n").find("a.map: 1 cell of byte 9 count"), std::string::npos);
  EXPECT_EQ(warning(".GSE\n@OTW\n"), "");
  EXPECT_EQ(logged([&] {
              read_map(folder.write("a.map", "type octile\nheight 1\nwidth 1\nmap\nx\n"),
                       MapWarnings::left_out);
            }),
            "");
}

// Decoding would take 0.5 GB before the picture turns out to be empty.
TEST(MapFile, APngPictureTooShortForItsSizeIsRefusedByItsHeader) {
  const TemporaryFolder folder;
  const std::string one_bit_grey("\1\0\0\0\0", 5);
  folder.write("large.png", "\x89PNG\r\n\x1a\n" +
                                png_chunk("IHDR", big_endian(16384) + big_endian(16384) + one_bit_grey) +
                                png_chunk("IDAT", "abc"));
  const std::string error =
      error_of_map(folder.write("site.yaml", "image: large.png\nresolution: 1\norigin: [0, 0, 0]\n"));
  EXPECT_NE(error.find("large.png: truncated: 16384 x 16384 pixels"), std::string::npos) << error;
}

TEST(MapFile, EveryMistakeInARosMapNamesTheField) {
  const TemporaryFolder folder;
  folder.write("ok.pgm", "P2\n1 1\n255\n255\n");
  folder.write("short.pgm", "P5\n10 10\n255\nabc");
  folder.write("bad.png", "not a picture");
  const std::vector<std::array<std::string, 2>> cases{
      {"resolution: 1\norigin: [0, 0, 0]\n", "image: expected"},
      {"image: none.pgm\nresolution: 1\norigin: [0, 0, 0]\n", "image: "},
      {"image: " + std::string(5000, 'a') + ".pgm\nresolution: 1\norigin: [0, 0, 0]\n", "does not exist"},
      {"image: ok.pgm\norigin: [0, 0, 0]\n", "resolution: expected a number"},
      {"image: ok.pgm\nresolution: -1\norigin: [0, 0, 0]\n", "resolution: -1 is out of range"},
      {"image: ok.pgm\nresolution: .nan\norigin: [0, 0, 0]\n", "resolution: expected a number"},
      {"image: ok.pgm\nresolution: 1\n", "origin: expected [x, y, yaw]"},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0.5]\n", "origin: a turned map"},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nmode: fancy\n", "mode: \"fancy\""},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nmode: [a]\n", "mode: "},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: [1]\n", "negate: "},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nfree_thresh: 0.9\n", "free_thresh: is above"},
      {"image: short.pgm\nresolution: 1\norigin: [0, 0, 0]\n", "short.pgm: truncated"},
      {"image: bad.png\nresolution: 1\norigin: [0, 0, 0]\n", "bad.png: is neither a PNG nor a PGM picture"},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: maybe\n", "negate: expected 0, 1, true"},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\nnegate: 1\n",
       "site.yaml:5: negate: is given twice"},
      {"image: ok.pgm\nresolution: .inf\norigin: [0, 0, 0]\n", "resolution: expected a number"},
      {"image: [\n", "site.yaml:"}};
  for (const auto& [yaml, expected] : cases) {
    const std::string error = error_of_map(folder.write("site.yaml", yaml));
    EXPECT_NE(error.find(expected), std::string::npos) << yaml << "\nsaid: " << error;
  }
}

}  // namespace
}  // namespace coppice
