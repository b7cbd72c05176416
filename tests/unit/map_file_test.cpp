#include "files/map_file.h"

#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include "files/input_error.h"
#include "tests/support.h"

namespace coppice {
namespace {

using test::TemporaryFolder;

std::string error_of(const std::filesystem::path& path) {
  try {
    read_map(path);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return {};
}

TEST(MapFile, ReadsMovingAi) {
  const TemporaryFolder folder;
  const OccupancyMap map =
      read_map(folder.write("a.map", "type octile\nheight 2\nwidth 7\nmap\n.GS@OTW\n@......\n"));
  EXPECT_EQ(map.width, 7);
  EXPECT_EQ(map.height, 2);
  EXPECT_EQ(map.resolution, 1);
  const std::vector<std::uint8_t> expected{0, 0, 0, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(map.blocked, expected);
}

TEST(MapFile, ReadsCarriageReturnsAndAMissingLastLineEnd) {
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
    const std::string error = error_of(folder.write("a.map", content));
    EXPECT_NE(error.find(expected), std::string::npos) << content << "\nsaid: " << error;
  }
  EXPECT_NE(error_of(folder.path() / "none.map").find("none.map: cannot be read"), std::string::npos);
  EXPECT_NE(error_of(folder.write("a.txt", "")).find("unknown kind of map"), std::string::npos);
}

TEST(MapFile, WhatIsWrittenIsReadBack) {
  const TemporaryFolder folder;
  OccupancyMap map;
  map.width = 3;
  map.height = 2;
  map.blocked = {0, 1, 0, 1, 1, 0};
  write_map(folder.path() / "b.map", map);
  EXPECT_EQ(read_map(folder.path() / "b.map"), map);
}

// White is free, black is blocked, grey is unknown; the picture's last row is row 0 of the map.
TEST(MapFile, ReadsRosPgm) {
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

TEST(MapFile, NegateTurnsShadesRound) {
  const TemporaryFolder folder;
  folder.write("site.pgm", "P2\n2 1\n255\n255 0\n");
  const std::string yaml =
      "image: site.pgm\nresolution: 1\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  EXPECT_EQ(read_map(folder.write("a.yaml", yaml + "negate: 0\n")).blocked,
            (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(read_map(folder.write("b.yaml", yaml + "negate: 1\n")).blocked,
            (std::vector<std::uint8_t>{1, 0}));
}

TEST(MapFile, ReadsRosPng) {
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

// It would take half a gigabyte before it turned out that there is nothing to decode.
TEST(MapFile, APngPictureThatIsTooShortForItsSizeIsRefusedByItsHeader) {
  const TemporaryFolder folder;
  const std::string one_bit_grey("\1\0\0\0\0", 5);
  folder.write("large.png", "\x89PNG\r\n\x1a\n" +
                                png_chunk("IHDR", big_endian(16384) + big_endian(16384) + one_bit_grey) +
                                png_chunk("IDAT", "abc"));
  const std::string error =
      error_of(folder.write("site.yaml", "image: large.png\nresolution: 1\norigin: [0, 0, 0]\n"));
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
      {"image: ok.pgm\nresolution: .nan\norigin: [0, 0, 0]\n", "resolution: nan is out of range"},
      {"image: ok.pgm\nresolution: 1\n", "origin: expected [x, y, yaw]"},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0.5]\n", "origin: a turned map"},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nmode: fancy\n", "mode: \"fancy\""},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nmode: [a]\n", "mode: "},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: [1]\n", "negate: "},
      {"image: ok.pgm\nresolution: 1\norigin: [0, 0, 0]\nfree_thresh: 0.9\n", "free_thresh: is above"},
      {"image: short.pgm\nresolution: 1\norigin: [0, 0, 0]\n", "short.pgm: truncated"},
      {"image: bad.png\nresolution: 1\norigin: [0, 0, 0]\n", "bad.png: cannot be read as PNG"},
      {"image: [\n", "site.yaml:"}};
  for (const auto& [yaml, expected] : cases) {
    const std::string error = error_of(folder.write("site.yaml", yaml));
    EXPECT_NE(error.find(expected), std::string::npos) << yaml << "\nsaid: " << error;
  }
}

}  // namespace
}  // namespace coppice
