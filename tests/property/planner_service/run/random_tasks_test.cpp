// Tests of random tasks and lifelong goals on small random grids, with robots that just fit through a cell.
// What a robot reaches is found a second time, cell by cell.
#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "planner_service/run/planner_service.h"

namespace coppice {
namespace {

constexpr std::uint64_t seeds = 150;

OccupancyMap random_grid(Random& random) {
  OccupancyMap map{.width = 2 + static_cast<int>(random.index(9)),
                   .height = 1 + static_cast<int>(random.index(9)),
                   .blocked = {}};
  const double share = random.uniform(0, 0.5);
  for (int k = 0; k < map.width * map.height; ++k) map.blocked.push_back(random.uniform() < share);
  return map;
}

Point2 centre(const OccupancyMap& map, int cell) {
  return {cell % map.width + 0.5, cell / map.width + 0.5};
}

/// A robot not wider than a cell drives from cell to cell, up, down, left and right.
std::vector<int> cells_around(const OccupancyMap& map, int first) {
  std::set<int> seen{first};
  std::vector<int> cells{first};
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const int i = cells[k] % map.width;
    const int j = cells[k] / map.width;
    for (const auto& [u, v] : {std::pair{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}}) {
      if (!map.is_blocked(u, v) && seen.insert(v * map.width + u).second) cells.push_back(v * map.width + u);
    }
  }
  return cells;
}

std::size_t largest_part(const OccupancyMap& map) {
  std::size_t most = 0;
  for (int cell = 0; cell < map.width * map.height; ++cell) {
    if (!map.is_blocked(cell % map.width, cell / map.width))
      most = std::max(most, cells_around(map, cell).size());
  }
  return most;
}

int cell_at(const OccupancyMap& map, const Point2& p) {
  return static_cast<int>(p.y()) * map.width + static_cast<int>(p.x());
}

void expect_apart(const std::vector<StartAndGoal>& tasks, Point2 StartAndGoal::*place, double radius) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = (tasks[i].*place - tasks[j].*place).norm();
      EXPECT_GE(distance, 2 * radius);
    }
  }
}

TEST(RandomTasks, AsManyTasksAsCellsAreDrawnApartInOnePart) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const OccupancyMap map = random_grid(random);
    const double radius = random.uniform(0.3, 0.5);
    const std::size_t room = largest_part(map);
    if (room < 2) continue;
    const ClearanceField field(map);
    const int robots = seed % 3 == 0 ? static_cast<int>(room) : 1 + static_cast<int>(random.index(room));
    const auto tasks = random_tasks(field, robots, radius, 0.4, random);
    ASSERT_EQ(tasks.size(), static_cast<std::size_t>(robots));
    const std::vector<int> part = cells_around(map, cell_at(map, tasks[0].start));
    EXPECT_EQ(part.size(), room);
    for (const auto& [start, goal] : tasks) {
      EXPECT_TRUE(field.is_free(start, radius) && field.is_free(goal, radius));
      EXPECT_EQ(std::ranges::count(part, cell_at(map, start)), 1);
      EXPECT_EQ(std::ranges::count(part, cell_at(map, goal)), 1);
      EXPECT_NE(start, goal);
    }
    expect_apart(tasks, &StartAndGoal::start, radius);
    expect_apart(tasks, &StartAndGoal::goal, radius);
  }
}

TEST(RandomTasks, TooManyTasksAreRefusedWithTheNumberThatFits) {
  for (std::uint64_t seed = 1; seed <= seeds / 10; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const OccupancyMap map = random_grid(random);
    const std::size_t room = largest_part(map);
    if (room < 2) continue;
    try {
      random_tasks(ClearanceField(map), static_cast<int>(room) + 1, 0.45, 0.4, random);
      ADD_FAILURE();
    } catch (const std::invalid_argument& problem) {
      EXPECT_NE(std::string(problem.what()).find("room for " + std::to_string(room) + " robots"),
                std::string::npos)
          << problem.what();
    }
  }
}

TEST(RandomTasks, TheSameSeedDrawsTheSameTasks) {
  for (std::uint64_t seed = 1; seed <= seeds / 10; ++seed) {
    Random random(seed);
    const OccupancyMap map = random_grid(random);
    if (largest_part(map) < 4) continue;
    const ClearanceField field(map);
    Random one(seed);
    Random other(seed);
    const auto tasks = random_tasks(field, 3, 0.45, 0.4, one);
    const auto again = random_tasks(field, 3, 0.45, 0.4, other);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      EXPECT_EQ(tasks[k].start, again[k].start);
      EXPECT_EQ(tasks[k].goal, again[k].goal);
    }
  }
}

// This includes places behind a door of one cell.
TEST(RandomTasks, AllPlacesAreDrawnAboutEquallyOften) {
  OccupancyMap map{.width = 9, .height = 3, .blocked = std::vector<std::uint8_t>(27, 0)};
  map.blocked[4] = map.blocked[22] = 1;
  const ClearanceField field(map);
  std::vector<int> starts(27, 0);
  Random random(1);
  constexpr int draws = 5000;
  for (int k = 0; k < draws; ++k)
    ++starts[static_cast<std::size_t>(cell_at(map, random_tasks(field, 1, 0.45, 0, random)[0].start))];
  for (std::size_t cell = 0; cell < starts.size(); ++cell) {
    if (map.blocked[cell] != 0) continue;
    EXPECT_GT(starts[cell], draws / 25 / 2) << cell;
    EXPECT_LT(starts[cell], draws / 25 * 2) << cell;
  }
}

/// A service whose agents arrive at once at every goal.
class Lifelong {
 public:
  explicit Lifelong(const Scenario& scenario)
      : scenario_(scenario), service_(scenario, {.lifelong = 1000}, 0) {
    service_.step(0);
    service_.step(4);  // no broker came
  }
  /// The goal of the robot's next mission, if it gets one.
  std::optional<Point2> next_goal(std::size_t robot, std::uint32_t mission, double now) {
    const std::string& name = scenario_.robots[robot].name;
    service_.on(
        arrival_of(AgentStatus{.robot = name, .mission = mission, .phase = Phase::arrived, .run = {4}}, now));
    for (const Message& message : service_.step(now)) {
      const auto* next = std::get_if<Mission>(&message);
      if (next != nullptr && next->robot == name && next->number == mission + 1) return next->goal;
    }
    return std::nullopt;
  }
  const PlannerService& service() const { return service_; }

 private:
  Scenario scenario_;
  PlannerService service_;
};

TEST(LifelongGoals, ASingleRobotGetsAGoalIfItReachesAnotherPlace) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Scenario scenario{.map_name = "grid", .map = random_grid(random), .robots = {}};
    const OccupancyMap& map = scenario.map;
    const double radius = random.uniform(0.3, 0.5);
    const auto cell = static_cast<int>(random.index(map.blocked.size()));
    if (map.is_blocked(cell % map.width, cell / map.width)) continue;
    // Its goal is not always the centre of a cell.
    const double off = (0.5 - radius) * random.uniform(-1, 1);
    const Point2 goal = centre(map, cell) + Point2(off, -off);
    scenario.robots = {{"a", goal, goal, radius, 1, 2, 0.1}};
    Lifelong run(scenario);
    const std::vector<int> part = cells_around(map, cell);
    Point2 here = goal;
    for (std::uint32_t mission = 1; mission <= 5; ++mission) {
      const auto next = run.next_goal(0, mission, 4 + mission);
      ASSERT_EQ(next.has_value(), part.size() > 1 || here != centre(map, cell));
      EXPECT_EQ(run.service().robots_without_goal().empty(), next.has_value());
      if (!next) break;
      EXPECT_EQ(std::ranges::count(part, cell_at(map, *next)), 1);
      EXPECT_NE(*next, here);
      here = *next;
    }
  }
}

/// Robots a, b, ... in the first cells of a corridor that is one cell wide.
Scenario corridor(int cells, int robots) {
  OccupancyMap map{
      .width = cells, .height = 1, .blocked = std::vector<std::uint8_t>(static_cast<std::size_t>(cells), 0)};
  Scenario scenario{.map_name = "corridor", .map = map, .robots = {}};
  for (int k = 0; k < robots; ++k)
    scenario.robots.push_back(
        {std::string(1, static_cast<char>('a' + k)), centre(map, k), centre(map, k), 0.4, 1, 2, 0.1});
  return scenario;
}

TEST(LifelongGoals, TheOnlyFreeCellIsFoundAmongManyTakenOnes) {
  constexpr int robots = 20;
  const Scenario scenario = corridor(robots + 1, robots);
  Lifelong run(scenario);
  int free = robots;
  for (int k = 0; k < robots; ++k) {
    EXPECT_EQ(run.next_goal(static_cast<std::size_t>(k), 1, 5), centre(scenario.map, free));
    free = k;
  }
}

TEST(LifelongGoals, AFullCorridorHasNoGoal) {
  Lifelong run(corridor(3, 3));
  EXPECT_EQ(run.next_goal(1, 1, 5), std::nullopt);
  EXPECT_EQ(run.service().robots_without_goal(),
            std::vector<std::string>{"b gets no new goal: other robots take all 3 places that it can go to"});
}

}  // namespace
}  // namespace coppice
