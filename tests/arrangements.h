// A few robots on a small grid of cells, and an exhaustive search that tells whether they can reach their
// goals.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coppice/planning/occupancy_map.h"
#include "coppice/planning/random.h"

namespace coppice::test {

/// Cells are numbered row by row.
struct Arrangement {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> blocked{};  ///< by cell
  std::vector<int> starts{};            ///< cells, by robot
  std::vector<int> goals{};             ///< cells, by robot

  /// Each cell becomes scale x scale cells of a map.
  OccupancyMap map(int scale) const {
    OccupancyMap map{.width = width * scale, .height = height * scale, .blocked = {}};
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x)
        map.blocked.push_back(blocked[static_cast<std::size_t>(y / scale * width + x / scale)]);
    }
    return map;
  }
  /// The centre of a cell on that map.
  Point2 centre(int cell, int scale) const {
    return scale * Point2(cell % width + 0.5, static_cast<double>(cell / width) + 0.5);
  }
};

inline std::string drawing(const Arrangement& a) {
  std::string text;
  for (std::size_t cell = 0; cell < a.blocked.size(); ++cell) {
    text += a.blocked[cell] != 0 ? '@' : '.';
    if ((cell + 1) % static_cast<std::size_t>(a.width) == 0) text += '\n';
  }
  for (std::size_t k = 0; k < a.starts.size(); ++k)
    text += std::to_string(a.starts[k]) + " -> " + std::to_string(a.goals[k]) + '\n';
  return text;
}

/// Rows have '.' for free cells and any other character for blocked ones. The tasks are the start and goal of
/// each robot.
inline Arrangement arrangement(const std::vector<std::string>& rows,
                               const std::vector<std::pair<int, int>>& tasks) {
  Arrangement a{.width = static_cast<int>(rows.front().size()), .height = static_cast<int>(rows.size())};
  for (const std::string& row : rows) {
    for (const char c : row) a.blocked.push_back(c != '.');
  }
  for (const auto& [start, goal] : tasks) {
    a.starts.push_back(start);
    a.goals.push_back(goal);
  }
  return a;
}

/// Small arrangements that need a robot to leave its path for another.
inline std::vector<Arrangement> known_arrangements() {
  return {
      arrangement({"@.@",  //
                   "...",  //
                   "@@@"},
                  {{5, 3}, {3, 5}}),
      arrangement({"....",  //
                   "..@.",  //
                   "@@..",  //
                   "...@"},
                  {{1, 11}, {12, 2}, {3, 7}}),
      arrangement({"......",  //
                   "@.@@@@",  //
                   "@.@@@@",  //
                   "@.@@@@"},
                  {{5, 2}, {4, 3}, {3, 4}, {1, 5}}),
      arrangement({".......",  //
                   "@@@.@@@"},
                  {{0, 6}, {6, 0}}),
      arrangement({"..@@@@..",  //
                   "........",  //
                   "..@@@@.."},
                  {{0, 7}, {16, 23}, {7, 0}, {23, 16}}),
      arrangement({"@@.@@",  //
                   "@@.@@",  //
                   ".....",  //
                   "@@.@@",  //
                   "@@.@@"},
                  {{2, 10}, {10, 22}, {22, 14}, {14, 2}}),
      arrangement({"...",  //
                   ".@.",  //
                   "..."},
                  {{0, 2}, {2, 8}, {8, 0}}),
  };
}

/// The arrangement, rotated by a right angle.
inline Arrangement turned(const Arrangement& a) {
  const auto moved = [&](int cell) { return cell % a.width * a.height + a.height - 1 - cell / a.width; };
  Arrangement turned{.width = a.height, .height = a.width, .blocked = a.blocked};
  for (int cell = 0; cell < a.width * a.height; ++cell)
    turned.blocked[static_cast<std::size_t>(moved(cell))] = a.blocked[static_cast<std::size_t>(cell)];
  for (const int cell : a.starts) turned.starts.push_back(moved(cell));
  for (const int cell : a.goals) turned.goals.push_back(moved(cell));
  return turned;
}

inline Arrangement mirrored(const Arrangement& a) {
  const auto moved = [&](int cell) { return cell / a.width * a.width + a.width - 1 - cell % a.width; };
  Arrangement mirrored{.width = a.width, .height = a.height, .blocked = a.blocked};
  for (int cell = 0; cell < a.width * a.height; ++cell)
    mirrored.blocked[static_cast<std::size_t>(moved(cell))] = a.blocked[static_cast<std::size_t>(cell)];
  for (const int cell : a.starts) mirrored.starts.push_back(moved(cell));
  for (const int cell : a.goals) mirrored.goals.push_back(moved(cell));
  return mirrored;
}

/// The arrangement in all eight rotations and reflections.
inline std::vector<Arrangement> all_symmetries(const Arrangement& a) {
  std::vector<Arrangement> all{a, mirrored(a)};
  while (all.size() < 8) all.push_back(turned(all[all.size() - 2]));
  return all;
}

/// Breadth-first search over all configurations: one robot at a time moves to one of the four neighbouring
/// cells.
inline bool has_solution(const Arrangement& a) {
  std::set<std::vector<int>> seen{a.starts};
  std::deque<std::vector<int>> open{a.starts};
  while (!open.empty()) {
    std::vector<int> at = open.front();
    open.pop_front();
    if (at == a.goals) return true;
    for (int& cell : at) {
      const int here = cell;
      for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        const int x = here % a.width + dx;
        const int y = here / a.width + dy;
        const int there = y * a.width + x;
        const bool inside = x >= 0 && y >= 0 && x < a.width && y < a.height;
        if (!inside || a.blocked[static_cast<std::size_t>(there)] != 0 ||
            std::ranges::find(at, there) != at.end())
          continue;
        cell = there;
        if (seen.insert(at).second) open.push_back(at);
        cell = here;
      }
    }
  }
  return false;
}

inline int between(int least, int most, Random& random) {
  return least + static_cast<int>(random.index(static_cast<std::size_t>(most - least + 1)));
}

/// Different free cells; empty if there are too few.
inline std::vector<int> drawn_cells(const std::vector<std::uint8_t>& blocked, std::size_t count,
                                    Random& random) {
  std::vector<int> free;
  for (std::size_t cell = 0; cell < blocked.size(); ++cell) {
    if (blocked[cell] == 0) free.push_back(static_cast<int>(cell));
  }
  if (free.size() <= count) return {};
  for (std::size_t k = 0; k < count; ++k) std::swap(free[k], free[k + random.index(free.size() - k)]);
  free.resize(count);
  return free;
}

/// Two to four robots on a grid with sides of three to six cells; drawn until there is a solution.
inline Arrangement drawn_arrangement(Random& random) {
  while (true) {
    Arrangement drawn{.width = between(3, 6, random), .height = between(3, 6, random)};
    const double density = random.uniform(0.2, 0.6);
    for (int cell = 0; cell < drawn.width * drawn.height; ++cell)
      drawn.blocked.push_back(random.uniform() < density);
    const auto robots = static_cast<std::size_t>(between(2, 4, random));
    drawn.starts = drawn_cells(drawn.blocked, robots, random);
    drawn.goals = drawn_cells(drawn.blocked, robots, random);
    if (!drawn.starts.empty() && has_solution(drawn)) return drawn;
  }
}

}  // namespace coppice::test
