#include "files/ros_map_file.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <yaml-cpp/yaml.h>

#include "coppice/files/input_error.h"
#include "files/picture_file.h"
#include "files/text_file.h"
#include "planning/number_text.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

constexpr int unknown_shade = 205;

struct Meaning {
  std::string mode = "trinary";
  bool negate = false;
  double occupied = 0.65;
  double free = 0.196;
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw InputError(fmt::format("{}: {}", path.string(), problem));
}

/// yaml-cpp itself reads numbers by the locale of the program.
std::optional<double> number_in(const YAML::Node& node) {
  return node.IsDefined() && node.IsScalar() ? decimal_number(node.Scalar()) : std::nullopt;
}

double number_field(const YAML::Node& yaml, const char* field, double least, double most,
                    const std::filesystem::path& path) {
  const auto value = number_in(yaml[field]);
  if (!value) fail(path, fmt::format("{}: expected a number", field));
  if (!(*value >= least && *value <= most))
    fail(path, fmt::format("{}: {} is out of range, expected {} to {}", field, *value, least, most));
  return *value;
}

/// Reads 0, 1 or a YAML 1.1 truth value: yes, No, on, OFF, true, False and the like.
bool truth_field(const YAML::Node& yaml, const char* field, const std::filesystem::path& path) {
  const YAML::Node& node = yaml[field];
  if (node.IsScalar() && (node.Scalar() == "0" || node.Scalar() == "1")) return node.Scalar() == "1";
  try {
    return node.as<bool>();
  } catch (const YAML::Exception&) {
    fail(path, fmt::format("{}: expected 0, 1, true, false, yes, no, on or off", field));
  }
}

Meaning read_meaning(const YAML::Node& yaml, const std::filesystem::path& path) {
  Meaning meaning;
  if (yaml["mode"]) {
    const std::string said = yaml["mode"].Scalar();
    meaning.mode = said;
    std::ranges::transform(meaning.mode, meaning.mode.begin(),
                           [](unsigned char c) { return std::tolower(c); });
    if (meaning.mode != "trinary" && meaning.mode != "scale" && meaning.mode != "raw")
      fail(path, fmt::format("mode: \"{}\", expected trinary, scale or raw", said));
  }
  if (yaml["negate"]) meaning.negate = truth_field(yaml, "negate", path);
  if (yaml["occupied_thresh"]) meaning.occupied = number_field(yaml, "occupied_thresh", 0, 1, path);
  if (yaml["free_thresh"]) meaning.free = number_field(yaml, "free_thresh", 0, 1, path);
  if (meaning.free > meaning.occupied) fail(path, "free_thresh: is above occupied_thresh");
  return meaning;
}

/// Whether a pixel is free. Unknown, transparent and partly free pixels are blocked. In raw mode map_server
/// takes the value itself as the occupancy; 0 is free.
bool is_free(const Meaning& meaning, double shade, bool opaque) {
  if (!opaque) return false;
  if (meaning.mode == "raw") return shade == 0;
  const double occupancy = (meaning.negate ? shade : 255 - shade) / 255.0;
  return occupancy < meaning.free;
}

void refuse_fields_given_twice(const YAML::Node& yaml, const std::filesystem::path& path) {
  std::set<std::string> names;
  for (const auto& field : yaml) {
    if (field.first.IsScalar() && !names.insert(field.first.Scalar()).second)
      throw InputError(fmt::format("{}:{}: {}: is given twice", path.string(), field.first.Mark().line + 1,
                                   field.first.Scalar()));
  }
}

}  // namespace

OccupancyMap read_ros_map(const std::filesystem::path& path, MapWarnings warnings) {
  YAML::Node yaml;
  try {
    yaml = YAML::Load(read_text(path));
  } catch (const YAML::Exception& problem) {
    throw InputError(fmt::format("{}:{}: {}", path.string(), problem.mark.line + 1, problem.msg));
  }
  if (!yaml.IsMap()) fail(path, "expected the fields of a map_server map");
  refuse_fields_given_twice(yaml, path);
  if (!yaml["image"] || !yaml["image"].IsScalar())
    fail(path, "image: expected the name of a PGM or PNG file");
  OccupancyMap map;
  map.y_axis = YAxis::up;
  map.resolution = number_field(yaml, "resolution", 1e-4, 1e4, path);
  const YAML::Node origin = yaml["origin"];
  if (!origin || !origin.IsSequence() || origin.size() < 2 || origin.size() > 3) {
    fail(path, "origin: expected [x, y, yaw]");
  }
  std::vector<double> numbers;
  for (const YAML::Node& element : origin) {
    const auto number = number_in(element);
    if (!number) fail(path, "origin: expected numbers");
    numbers.push_back(*number);
  }
  map.origin = {numbers[0], numbers[1]};
  if (!is_sane(map.origin.x()) || !is_sane(map.origin.y()))
    fail(path, fmt::format("origin: expected finite numbers, at most {}", largest_quantity));
  if (numbers.size() == 3 && numbers[2] != 0)
    fail(path, "origin: a turned map (yaw other than 0) is not supported");
  const Meaning meaning = read_meaning(yaml, path);
  if (warnings == MapWarnings::logged && is_free(meaning, unknown_shade, true)) {
    spdlog::warn("{}: free_thresh {} makes shade {} free, which map savers write for unknown cells{}",
                 path.string(), meaning.free, unknown_shade, meaning.negate ? " (negate is on)" : "");
  }

  const std::filesystem::path image = path.parent_path() / yaml["image"].as<std::string>();
  std::error_code too_long;  // set if the name is too long for the file system
  if (!std::filesystem::exists(image, too_long))
    fail(path, fmt::format("image: {} does not exist", image.string()));
  const Picture picture = read_picture(image);
  map.width = picture.width;
  map.height = picture.height;
  map.blocked.resize(map.frame().cells());
  for (int row = 0; row < map.height; ++row) {
    for (int i = 0; i < map.width; ++i) {
      // The picture's last row is the map's lowest.
      const std::size_t from =
          static_cast<std::size_t>(map.height - 1 - row) * static_cast<std::size_t>(map.width) +
          static_cast<std::size_t>(i);
      const std::size_t to =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(i);
      map.blocked[to] = is_free(meaning, picture.shade(from), picture.is_opaque(from)) ? 0 : 1;
    }
  }
  return map;
}

}  // namespace coppice
