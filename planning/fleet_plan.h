// Paths for a whole fleet in one process: Algorithm 2 from beginning to end, with no bus and no motion.
//
// Zhang, Wang, Meng, "Multi-robot Path Planning with Rapidly-exploring Random Disjointed-Trees", 2023; with
// one robot it is Algorithm 1, RRdT*. Metres.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "planning/clearance_field.h"
#include "planning/ma_rrdt_star.h"
#include "planning/random.h"

namespace coppice {

struct PlanningProblem {
  Point2 start;
  Point2 goal;
  double radius = 0;  ///< a disc of it is free at start and goal
};

struct RobotPlan {
  Path path;           ///< from start to goal, keeps the radius clear; empty: none was found
  std::string reason;  ///< why not
  SampleCounts counts;
  std::uint32_t grafted_trees = 0;
};

struct FleetPlan {
  std::vector<RobotPlan> robots;  ///< in the order of the problems
  SampleCounts disjointed;
  std::uint32_t trees_frozen = 0;
  /// Edges of all trees, for a picture: whose root tree (index of the problem), or -1 for a disjointed one.
  struct Edge {
    Point2 from;
    Point2 to;
    int robot = -1;
    bool active = false;
  };
  std::vector<Edge> edges;
};

struct FleetPlanSettings {
  double epsilon = 0;                ///< 0: from the map (step_length.h)
  std::size_t disjointed_trees = 0;  ///< 0: max(16, 2 n)
};

/// Runs until every robot has a path or is proved to have none, or until `stop`, asked every few hundred
/// iterations, says so. `on_solved` hears of each robot (its index) as soon as its root trees have met.
FleetPlan plan_fleet(const ClearanceField& field, std::span<const PlanningProblem> problems,
                     const FleetPlanSettings& settings, Random random, const std::function<bool()>& stop,
                     const std::function<void(std::size_t)>& on_solved);

}  // namespace coppice
