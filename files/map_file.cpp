#include "coppice/files/map_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "coppice/files/input_error.h"
#include "coppice/planning/map_generator.h"
#include "files/file_kind.h"
#include "files/ros_map_file.h"
#include "files/text_file.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

/// The lines of a text, numbered from 1, without their line ends (\n or \r\n).
class Lines {
 public:
  Lines(std::string_view text, const std::filesystem::path& path) : rest_(text), path_(path) {}

  bool at_end() const { return rest_.empty(); }

  std::string_view next(const char* expected) {
    ++number_;
    if (rest_.empty()) fail(fmt::format("the file ends here, expected {}", expected));
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(fmt::format("{}:{}: {}", path_.string(), number_, problem));
  }

 private:
  std::string_view rest_;
  const std::filesystem::path& path_;
  int number_ = 0;
};

int read_size(Lines& lines, std::string_view name) {
  const std::string expected = fmt::format("\"{} N\" with N from 1 to {}", name, largest_map_file_side);
  const std::string_view line = lines.next(expected.c_str());
  int value = 0;
  if (line.starts_with(name) && line.size() > name.size() + 1 && line[name.size()] == ' ') {
    const char* begin = line.data() + name.size() + 1;
    const char* end = line.data() + line.size();
    const auto [rest, problem] = std::from_chars(begin, end, value);
    if (problem != std::errc{} || rest != end) value = 0;
  }
  if (value < 1 || value > largest_map_file_side)
    lines.fail(fmt::format("expected {}, found \"{}\"", expected, line));
  return value;
}

/// Ground (. and G) and swamp (S). In maps of the League of Robot Runners E and S are stations, which robots
/// may cross.
bool is_free(char cell) {
  return cell == '.' || cell == 'G' || cell == 'S' || cell == 'E';
}

/// Out of bounds (@, O), trees and water. The format has no other cells.
bool is_known_as_blocked(char cell) {
  return cell == '@' || cell == 'O' || cell == 'T' || cell == 'W';
}

/// One line for all cells that the format does not have: "2 cells \"x\", 1 cell \"#\"".
void warn_of_unknown_cells(const std::map<char, std::size_t>& unknown, const std::filesystem::path& path) {
  if (unknown.empty()) return;
  std::string cells;
  for (const auto& [cell, count] : unknown) {
    const std::string shown = cell > ' ' && cell < 127
                                  ? fmt::format("\"{}\"", cell)
                                  : fmt::format("of byte {}", static_cast<unsigned char>(cell));
    cells += fmt::format("{}{} cell{} {}", cells.empty() ? "" : ", ", count, count == 1 ? "" : "s", shown);
  }
  spdlog::warn("{}: {} count as blocked: the format does not have them", path.string(), cells);
}

OccupancyMap parse_moving_ai(std::string_view text, const std::filesystem::path& path, MapWarnings warnings) {
  Lines lines(text, path);
  if (const auto line = lines.next("\"type octile\""); !line.starts_with("type ")) {
    lines.fail(fmt::format("expected \"type octile\", found \"{}\"", line.substr(0, 40)));
  }
  OccupancyMap map;
  map.height = read_size(lines, "height");
  map.width = read_size(lines, "width");
  if (const auto line = lines.next("\"map\""); line != "map") {
    lines.fail(fmt::format("expected \"map\", found \"{}\"", line.substr(0, 40)));
  }
  std::map<char, std::size_t> unknown;
  // A header may claim a larger map than the file holds.
  map.blocked.reserve(
      std::min(text.size(), static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height)));
  for (int j = 0; j < map.height; ++j) {
    const std::string_view row = lines.next(fmt::format("row {} of {}", j + 1, map.height).c_str());
    if (row.size() != static_cast<std::size_t>(map.width)) {
      lines.fail(fmt::format("expected {} cells, found {}", map.width, row.size()));
    }
    for (const char cell : row) {
      map.blocked.push_back(is_free(cell) ? 0 : 1);
      if (!is_free(cell) && !is_known_as_blocked(cell)) ++unknown[cell];
    }
  }
  while (!lines.at_end()) {
    if (!lines.next("").empty()) lines.fail(fmt::format("more than the {} rows of the header", map.height));
  }
  if (warnings == MapWarnings::logged) warn_of_unknown_cells(unknown, path);
  return map;
}

}  // namespace

void check_map(const OccupancyMap& map) {
  for (const auto& [member, side] : {std::pair("width", map.width), std::pair("height", map.height)}) {
    if (side < 1 || side > largest_map_file_side)
      throw InputError(fmt::format("{}: {}, expected 1 to {}", member, side, largest_map_file_side));
  }
  if (map.blocked.size() != map.frame().cells()) {
    throw InputError(
        fmt::format("blocked: {} entries, expected {} x {}", map.blocked.size(), map.width, map.height));
  }
  if (!is_sane_size(map.resolution)) {
    throw InputError(fmt::format("resolution: {}, expected a number above 0, from {} to {}", map.resolution,
                                 least_quantity, largest_quantity));
  }
  if (!is_sane(map.origin.x()) || !is_sane(map.origin.y()))
    throw InputError(fmt::format("origin: expected finite numbers, at most {}", largest_quantity));
}

OccupancyMap read_map(const std::filesystem::path& path, MapWarnings warnings) {
  refuse_other_kinds(path, {FileKind::map, FileKind::ros_map, FileKind::empty}, "a map (.map or .yaml)");
  const std::string ending = ending_of(path);
  if (ending == ".map") return parse_moving_ai(read_text(path), path, warnings);
  if (ending == ".yaml" || ending == ".yml") return read_ros_map(path, warnings);
  throw InputError(fmt::format("{}: unknown kind of map, expected .map (Moving AI) or .yaml (ROS map_server)",
                               path.string()));
}

OccupancyMap read_or_generate_map(const std::string& kind_or_file, int width, int height, Random& random) {
  if (const auto kind = map_kind(kind_or_file)) return generate_map(*kind, width, height, random);
  std::error_code too_long;  // set if the name is too long for the file system
  if (std::filesystem::exists(kind_or_file, too_long)) return read_map(kind_or_file);
  throw InputError(
      fmt::format("{}: neither a file nor a kind of map (blank, dense, maze, room)", kind_or_file));
}

void write_map(const std::filesystem::path& path, const OccupancyMap& map) {
  std::string text = fmt::format("type octile\nheight {}\nwidth {}\nmap\n", map.height, map.width);
  for (int j = 0; j < map.height; ++j) {
    for (int i = 0; i < map.width; ++i) text += map.is_blocked(i, j) ? '@' : '.';
    text += '\n';
  }
  write_file(path, text);
}

}  // namespace coppice
