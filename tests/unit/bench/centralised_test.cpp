// Tests of the centralised planners that `coppice bench throughput` compares with.

#include "bench/centralised.h"

#include <algorithm>
#include <map>
#include <queue>
#include <string>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"

namespace coppice {
namespace {

/// A grid of cells of 1 m: `#` is blocked, `.` free. Small letters are starts, and the same capital letters
/// goals.
Scenario grid(const std::vector<std::string>& rows) {
  Scenario scenario{.map_name = "grid", .map = {}, .robots = {}};
  OccupancyMap& map = scenario.map;
  map.width = static_cast<int>(rows[0].size());
  map.height = static_cast<int>(rows.size());
  std::map<char, RobotTask> tasks;
  for (int j = 0; j < map.height; ++j) {
    for (int i = 0; i < map.width; ++i) {
      const char c = rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
      map.blocked.push_back(c == '#');
      const Point2 centre(i + 0.5, j + 0.5);
      if (c >= 'a' && c <= 'z') tasks[c].start = centre;
      if (c >= 'A' && c <= 'Z') tasks[static_cast<char>(c - 'A' + 'a')].goal = centre;
    }
  }
  for (auto& [name, task] : tasks) {
    task.name = name;
    task.radius = 0.35;
    task.max_speed = 1;
    task.max_acceleration = 4;
    task.goal_tolerance = 0.1;
    scenario.robots.push_back(task);
  }
  return scenario;
}

/// The least sum of arrival times, by a search over the cells of all robots at once.
std::optional<int> exhaustive(const Scenario& scenario) {
  using Cells = std::vector<int>;
  const OccupancyMap& map = scenario.map;
  const auto cell = [&](const Point2& p) {
    return static_cast<int>(p.y()) * map.width + static_cast<int>(p.x());
  };
  Cells start;
  Cells goal;
  for (const RobotTask& robot : scenario.robots) {
    start.push_back(cell(robot.start));
    goal.push_back(cell(robot.goal));
  }
  // A robot that has stopped at its goal costs nothing more, and never moves again.
  using State = std::pair<Cells, std::vector<bool>>;
  std::map<State, int> cost;
  std::priority_queue<std::pair<int, State>, std::vector<std::pair<int, State>>, std::greater<>> open;
  const auto offer = [&](const State& state, int value) {
    const auto [at, is_new] = cost.try_emplace(state, value);
    if (!is_new && at->second <= value) return;
    at->second = value;
    open.emplace(value, state);
  };
  const auto with_stops = [&](const State& state, int value) {
    const std::size_t n = start.size();
    for (std::size_t subset = 0; subset < std::size_t{1} << n; ++subset) {
      State stopped = state;
      bool is_valid = true;
      for (std::size_t k = 0; k < n; ++k) {
        if ((subset >> k & 1) == 0) continue;
        is_valid = is_valid && !state.second[k] && state.first[k] == goal[k];
        stopped.second[k] = true;
      }
      if (is_valid) offer(stopped, value);
    }
  };
  with_stops({start, std::vector<bool>(start.size(), false)}, 0);
  while (!open.empty()) {
    const auto [value, state] = open.top();
    open.pop();
    if (cost.at(state) < value) continue;
    if (std::ranges::count(state.second, true) == static_cast<std::ptrdiff_t>(start.size())) return value;
    std::vector<Cells> joint{{}};
    int moving = 0;
    for (std::size_t k = 0; k < start.size(); ++k) {
      std::vector<int> next{state.first[k]};
      moving += !state.second[k];
      const int i = state.first[k] % map.width;
      const int j = state.first[k] / map.width;
      if (!state.second[k]) {
        for (const auto& [x, y] :
             {std::pair(i + 1, j), std::pair(i - 1, j), std::pair(i, j + 1), std::pair(i, j - 1)}) {
          if (!map.is_blocked(x, y)) next.push_back(y * map.width + x);
        }
      }
      std::vector<Cells> longer;
      for (const Cells& before : joint) {
        for (const int c : next) {
          bool meets = false;
          for (std::size_t m = 0; m < before.size(); ++m)
            meets = meets || before[m] == c || (before[m] == state.first[k] && c == state.first[m]);
          if (meets) continue;
          longer.push_back(before);
          longer.back().push_back(c);
        }
      }
      joint = std::move(longer);
    }
    for (const Cells& cells : joint) with_stops({cells, state.second}, value + moving);
  }
  return std::nullopt;
}

TEST(ConflictBasedSearch, RobotsThatCrossWaitOnce) {
  const auto figures = conflict_based_search(grid({"#b#", "a.A", "#B#"}), 100);
  ASSERT_TRUE(figures);
  EXPECT_EQ(figures->sum, 5);
  EXPECT_EQ(figures->last, 3);
}

TEST(ConflictBasedSearch, TheSumIsTheLeastThereIs) {
  int solved = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    std::string cells(12, '.');
    for (int k = 0; k < 2; ++k) cells[random.index(12)] = '#';
    for (const char c : std::string("abcABC")) {
      std::size_t at = random.index(12);
      while (cells[at] != '.') at = random.index(12);
      cells[at] = c;
    }
    const Scenario scenario = grid({cells.substr(0, 4), cells.substr(4, 4), cells.substr(8, 4)});
    const auto least = exhaustive(scenario);
    const auto figures = conflict_based_search(scenario, 3000);
    if (!figures) continue;
    EXPECT_EQ(figures->sum, least) << cells;
    ++solved;
  }
  EXPECT_GT(solved, 30);
}

TEST(ConflictBasedSearch, OnlyRobotsInTheCentresOfCellsArePlannedFor) {
  Scenario scenario = grid({"a..A"});
  EXPECT_TRUE(is_for_conflict_based_search(scenario));
  scenario.robots[0].start.x() += 0.2;
  EXPECT_FALSE(is_for_conflict_based_search(scenario));
}

TEST(PrioritisedPlanning, ARobotMakesRoomForTheOneBeforeIt) {
  const auto figures = prioritised_planning(grid({"a.......A", "####B####", "####b####"}));
  ASSERT_TRUE(figures);
  EXPECT_GE(*figures->last, 8);
  EXPECT_LE(*figures->sum, 8 + 1 + 1);
}

TEST(PrioritisedPlanning, AGoalThatIsShutInGivesNoFigures) {
  EXPECT_FALSE(prioritised_planning(grid({"a.#.A"})));
}

}  // namespace
}  // namespace coppice
