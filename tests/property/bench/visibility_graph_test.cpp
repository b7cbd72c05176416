// The visibility graph finds shortest paths of a disc.

#include "bench/visibility_graph.h"

#include <cmath>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "coppice/planning/plan_paths.h"
#include "tests/ways.h"

namespace coppice {
namespace {

/// Free but for a rectangle of cells.
OccupancyMap map_with(int width, int height, int i, int j, int w, int h) {
  OccupancyMap map{.width = width, .height = height, .blocked = {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) map.blocked.push_back(x >= i && x < i + w && y >= j && y < j + h);
  }
  return map;
}

TEST(VisibilityGraph, AroundAWallThePathIsTwoTangentsAndAnArc) {
  // A wall from below up to (50, 40); start and goal are 30 m from it and 20 m below its end.
  const OccupancyMap map = map_with(100, 80, 50, 0, 1, 40);
  const ClearanceField field(map);
  VisibilityGraph graph(map, field);
  const double radius = 5;
  const PlanningProblem p{{20, 20}, {81, 20}, radius};
  const Path path = graph.path(p.start, p.goal, radius);
  ASSERT_TRUE(test::is_way(path, p, field));
  const double apart = std::hypot(30, 20);
  const double tangent = std::sqrt(apart * apart - radius * radius);
  const double turn = std::asin(radius / apart) + std::atan2(20, 30);
  const double shortest = 2 * (tangent + radius * turn) + 1;
  EXPECT_GE(length_of(path), shortest - 1e-6);
  EXPECT_LE(length_of(path), shortest + 0.024 * 2 * radius * turn);
}

TEST(VisibilityGraph, NoPlannerFindsAShorterPathThanItsArcsAllow) {
  for (const MapKind kind : {MapKind::room, MapKind::maze, MapKind::dense}) {
    Random random(7);
    const OccupancyMap map = generate_map(kind, 256, 256, random);
    const ClearanceField field(map);
    VisibilityGraph graph(map, field);
    std::vector<PlanningProblem> problems;
    for (const StartAndGoal& task : random_tasks(field, 8, 5, 0.3, random, 0.5))
      problems.push_back({task.start, task.goal, 5});
    const PathPlan plan = plan_paths(field, problems);
    for (std::size_t i = 0; i < problems.size(); ++i) {
      const PlanningProblem& p = problems[i];
      const Path path = graph.path(p.start, p.goal, p.radius);
      ASSERT_TRUE(test::is_way(path, p, field)) << i;
      EXPECT_LE(length_of(path), 1.003 * length_of(plan.robots[i].path)) << i;
    }
  }
}

TEST(VisibilityGraph, LaterSearchesFindTheSameAsTheFirst) {
  const OccupancyMap map = map_with(60, 60, 20, 20, 20, 20);
  const ClearanceField field(map);
  VisibilityGraph graph(map, field);
  for (int k = 0; k < 8; ++k) {
    const Point2 start(5 + 6 * k, 10);
    const Point2 goal(55 - 5 * k, 50);
    const Path path = graph.path(start, goal, 3);
    EXPECT_NEAR(length_of(path), length_of(VisibilityGraph(map, field).path(start, goal, 3)), 1e-12);
    EXPECT_NEAR(length_of(path), length_of(graph.path(goal, start, 3)), 1e-9);
  }
}

TEST(VisibilityGraph, AGoalThatIsShutInHasNoPath) {
  const OccupancyMap map = map_with(60, 20, 30, 0, 1, 20);
  const ClearanceField field(map);
  EXPECT_TRUE(VisibilityGraph(map, field).path({10, 10}, {50, 10}, 3).empty());
}

}  // namespace
}  // namespace coppice
