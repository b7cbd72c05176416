#include "bench/reference_figures.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "files/text_file.h"

namespace coppice {

namespace {

constexpr const char* header = "scenario,planner,sum,last,goals_per_second";
constexpr std::size_t columns_of_a_line = 5;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

struct Place {
  const std::filesystem::path& path;
  int line;

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(fmt::format("{}:{}: {}", path.string(), line, problem));
  }
  /// Nothing for an empty cell.
  std::optional<double> figure(const std::string& cell) const {
    if (cell.empty()) return {};
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value) || value <= 0)
      fail(fmt::format("\"{}\" is no figure, expected a number above 0 or nothing", cell));
    return value;
  }
};

}  // namespace

std::vector<ReferenceFigures> read_reference_figures(const std::filesystem::path& path) {
  std::istringstream text(read_text(path));
  std::vector<ReferenceFigures> all;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    const Place place{path, number};
    if (line.ends_with('\r')) line.pop_back();
    if (number == 1) {
      if (line != header) place.fail(fmt::format("expected the header \"{}\"", header));
      continue;
    }
    const std::vector<std::string> cells = split(line);
    if (cells.size() != columns_of_a_line)
      place.fail(fmt::format("has {} columns, expected {}", cells.size(), columns_of_a_line));
    if (cells[0].empty() || cells[1].empty()) place.fail("names no scenario or no planner");
    all.push_back(
        {cells[0], cells[1], place.figure(cells[2]), place.figure(cells[3]), place.figure(cells[4])});
  }
  if (all.empty()) Place{path, 1}.fail("holds no figures");
  return all;
}

}  // namespace coppice
