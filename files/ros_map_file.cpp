#include "files/ros_map_file.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <png.h>
#include <yaml-cpp/yaml.h>

#include "files/input_error.h"
#include "files/map_file.h"
#include "files/text_file.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

constexpr std::size_t largest_deflation = 1032;  // bytes that one deflated byte stands for, at most

/// Shades from 0 (black) to 255 (white), row by row from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> shades;
  std::vector<std::uint8_t> opaque;  ///< 0 where a transparent pixel leaves the cell unknown
};

struct Meaning {
  std::string mode = "trinary";
  bool negate = false;
  double occupied = 0.65;
  double free = 0.196;
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw InputError(fmt::format("{}: {}", path.string(), problem));
}

void check_size(const std::filesystem::path& path, long width, long height) {
  if (width < 1 || height < 1 || width > largest_map_file_side || height > largest_map_file_side) {
    fail(path, fmt::format("size {} x {} is out of range, expected 1 to {} pixels a side", width, height,
                           largest_map_file_side));
  }
}

/// The next whole number of a PGM header or of a plain (P2) picture, comments skipped.
long next_number(const std::string& data, std::size_t& at, const std::filesystem::path& path) {
  while (at < data.size() && (std::isspace(static_cast<unsigned char>(data[at])) != 0 || data[at] == '#')) {
    if (data[at] == '#') {
      while (at < data.size() && data[at] != '\n') ++at;
    } else {
      ++at;
    }
  }
  long value = 0;
  const std::size_t begin = at;
  while (at < data.size() && data[at] >= '0' && data[at] <= '9' && at - begin < 9)
    value = value * 10 + (data[at++] - '0');
  if (at == begin) fail(path, fmt::format("truncated or malformed PGM: expected a number at byte {}", at));
  return value;
}

Picture read_pgm(const std::filesystem::path& path) {
  const std::string data = read_file(path);
  const std::string magic = data.substr(0, 2);
  if (magic != "P5" && magic != "P2") fail(path, "not a PGM picture (expected P5 or P2)");
  std::size_t at = 2;
  const long width = next_number(data, at, path);
  const long height = next_number(data, at, path);
  const long white = next_number(data, at, path);
  check_size(path, width, height);
  if (white < 1 || white > 65535)
    fail(path, fmt::format("largest value {} is out of range, expected 1 to 65535", white));
  Picture picture{static_cast<int>(width), static_cast<int>(height), {}, {}};
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const std::size_t bytes = white > 255 ? 2 : 1;
  if (magic == "P5" && data.size() < at + 1 + pixels * bytes) {
    fail(path, fmt::format("truncated: {} x {} pixels need {} bytes, found {}", width, height, pixels * bytes,
                           data.size() - std::min(data.size(), at + 1)));
  }
  // Else a header of a few bytes would take the memory of a large map.
  if (magic == "P2" && (data.size() - at) / 2 < pixels)
    fail(path, fmt::format("truncated: {} x {} pixels need more than {} bytes", width, height, data.size()));
  ++at;  // the one white space that ends the header
  picture.shades.reserve(pixels);
  for (std::size_t k = 0; k < pixels; ++k) {
    long value = 0;
    if (magic == "P2") {
      value = next_number(data, at, path);
    } else {
      for (std::size_t b = 0; b < bytes; ++b) value = value * 256 + static_cast<unsigned char>(data[at++]);
    }
    if (value > white) fail(path, fmt::format("pixel {} is {}, above the largest value {}", k, value, white));
    picture.shades.push_back(static_cast<std::uint8_t>(
        std::lround(255.0 * static_cast<double>(value) / static_cast<double>(white))));
  }
  picture.opaque.assign(pixels, 1);
  return picture;
}

Picture read_png(const std::filesystem::path& path) {
  const std::string data = read_file(path);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, data.data(), data.size()) == 0) {
    fail(path, fmt::format("cannot be read as PNG: {}", image.message));
  }
  image.format = PNG_FORMAT_GA;
  std::vector<std::uint8_t> pixels;
  try {
    check_size(path, static_cast<long>(image.width), static_cast<long>(image.height));
    // As for a PGM picture. A pixel has one bit at least.
    const std::size_t least = std::size_t{image.width} * image.height / 8 / largest_deflation;
    if (data.size() < least)
      fail(path, fmt::format("truncated: {} x {} pixels need more than {} bytes, found {}", image.width,
                             image.height, least, data.size()));
    pixels.resize(PNG_IMAGE_SIZE(image));
  } catch (...) {
    png_image_free(&image);
    throw;
  }
  if (png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) == 0) {
    fail(path, fmt::format("cannot be read as PNG: {}", image.message));
  }
  Picture picture{static_cast<int>(image.width), static_cast<int>(image.height), {}, {}};
  for (std::size_t k = 0; k < pixels.size(); k += 2) {
    picture.shades.push_back(pixels[k]);
    picture.opaque.push_back(pixels[k + 1] == 255);
  }
  return picture;
}

double number_field(const YAML::Node& yaml, const char* field, double least, double most,
                    const std::filesystem::path& path) {
  double value = 0;
  try {
    value = yaml[field].as<double>();
  } catch (const YAML::Exception&) {
    fail(path, fmt::format("{}: expected a number", field));
  }
  if (!(value >= least && value <= most)) {
    fail(path, fmt::format("{}: {} is out of range, expected {} to {}", field, value, least, most));
  }
  return value;
}

Meaning read_meaning(const YAML::Node& yaml, const std::filesystem::path& path) {
  Meaning meaning;
  if (yaml["mode"]) meaning.mode = yaml["mode"].Scalar();
  if (meaning.mode != "trinary" && meaning.mode != "scale" && meaning.mode != "raw") {
    fail(path, fmt::format("mode: \"{}\", expected trinary, scale or raw", meaning.mode));
  }
  if (yaml["negate"]) {
    const std::string value = yaml["negate"].Scalar();
    if (value != "0" && value != "1" && value != "true" && value != "false")
      fail(path, "negate: expected 0 or 1");
    meaning.negate = value == "1" || value == "true";
  }
  if (yaml["occupied_thresh"]) meaning.occupied = number_field(yaml, "occupied_thresh", 0, 1, path);
  if (yaml["free_thresh"]) meaning.free = number_field(yaml, "free_thresh", 0, 1, path);
  if (meaning.free > meaning.occupied) fail(path, "free_thresh: is above occupied_thresh");
  return meaning;
}

/// Free only where the picture says so: what is unknown, or free to some degree only, is blocked. map_server
/// takes the raw value as the occupancy, 0 being free.
bool is_free(const Meaning& meaning, std::uint8_t shade, bool opaque) {
  if (meaning.mode == "raw") return shade == 0;
  if (!opaque) return false;
  const double occupancy = (meaning.negate ? shade : 255 - shade) / 255.0;
  return occupancy < meaning.free;
}

}  // namespace

OccupancyMap read_ros_map(const std::filesystem::path& path) {
  YAML::Node yaml;
  try {
    yaml = YAML::Load(read_file(path));
  } catch (const YAML::Exception& problem) {
    throw InputError(fmt::format("{}:{}: {}", path.string(), problem.mark.line + 1, problem.msg));
  }
  if (!yaml.IsMap()) fail(path, "expected the fields of a map_server map");
  if (!yaml["image"] || !yaml["image"].IsScalar())
    fail(path, "image: expected the name of a PGM or PNG file");
  OccupancyMap map;
  map.y_axis = YAxis::up;
  map.resolution = number_field(yaml, "resolution", 1e-4, 1e4, path);
  const YAML::Node origin = yaml["origin"];
  if (!origin || !origin.IsSequence() || origin.size() < 2 || origin.size() > 3) {
    fail(path, "origin: expected [x, y, yaw]");
  }
  try {
    map.origin = {origin[0].as<double>(), origin[1].as<double>()};
    if (!is_sane(map.origin.x()) || !is_sane(map.origin.y()))
      fail(path, fmt::format("origin: expected finite numbers, at most {}", largest_quantity));
    if (origin.size() == 3 && origin[2].as<double>() != 0)
      fail(path, "origin: a turned map (yaw other than 0) is not supported");
  } catch (const YAML::Exception&) {
    fail(path, "origin: expected numbers");
  }
  const Meaning meaning = read_meaning(yaml, path);

  const std::filesystem::path image = path.parent_path() / yaml["image"].as<std::string>();
  std::error_code too_long;  // as a name
  if (!std::filesystem::exists(image, too_long))
    fail(path, fmt::format("image: {} does not exist", image.string()));
  const Picture picture = image.extension() == ".png" ? read_png(image) : read_pgm(image);
  map.width = picture.width;
  map.height = picture.height;
  map.blocked.resize(picture.shades.size());
  for (int row = 0; row < map.height; ++row) {
    for (int i = 0; i < map.width; ++i) {
      // The picture's last row is the lowest of the map.
      const std::size_t from =
          static_cast<std::size_t>(map.height - 1 - row) * static_cast<std::size_t>(map.width) +
          static_cast<std::size_t>(i);
      const std::size_t to =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(i);
      map.blocked[to] = is_free(meaning, picture.shades[from], picture.opaque[from] != 0) ? 0 : 1;
    }
  }
  return map;
}

}  // namespace coppice
