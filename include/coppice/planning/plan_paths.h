// Plans a path for each robot of a fleet, past the obstacles of the map. The paths of two robots may cross.
//
// MA-RRdT* and RRdT*: Zhang, Wang, Meng, "Multi-robot Path Planning with Rapidly-exploring Random
// Disjointed-Trees", 2023, Algorithms 2 and 1. RRT*: Karaman, Frazzoli, "Sampling-based Algorithms for
// Optimal Motion Planning", 2011.
//
// Metres in the map frame, seconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "coppice/planning/planner_kind.h"
#include "coppice/planning/tree_parameters.h"

namespace coppice {

/// The task of one robot, a disc.
struct PlanningProblem {
  Point2 start;
  Point2 goal;
  double radius = 0;  ///< metres, from 1e-4 to 1e9; a disc of this radius is free at start and goal
};

struct PlanSettings {
  PlannerKind planner = PlannerKind::ma_rrdt_star;
  std::uint64_t seed = 1;
  /// Seconds after which the search ends. Robots that have no path by then get none.
  double timeout = std::numeric_limits<double>::infinity();
  /// Seconds for shorter paths after all first paths. RRT* has no such phase.
  double improve = std::numeric_limits<double>::infinity();
  TreeParameters trees{};  ///< RRT* uses epsilon alone
};

struct SampleCounts {
  std::uint32_t valid = 0;    ///< nodes that joined a tree
  std::uint32_t invalid = 0;  ///< samples that hit an obstacle
};

/// An edge of a tree, for a picture.
struct TreeEdge {
  Point2 from;
  Point2 to;
  int robot = -1;  ///< index of the problem whose root tree has the edge; -1: a disjointed tree
};

struct PlannedPath {
  Path path{};           ///< from start to goal, clear of obstacles by the radius; empty: none was found
  std::string reason{};  ///< why there is no path
  double solved_after = 0;
  SampleCounts counts{};            ///< of its two root trees
  std::uint32_t grafted_trees = 0;  ///< inactive trees that it grafted onto its root trees
};

struct PathPlan {
  std::vector<PlannedPath> robots{};  ///< in the order of the problems
  SampleCounts disjointed{};          ///< of the disjointed trees
  std::uint32_t frozen_trees = 0;     ///< disjointed trees that became inactive
  std::vector<TreeEdge> edges{};      ///< of all trees; none with RRT*
  double plan_time = 0;               ///< seconds until all first paths
  double improve_time = 0;            ///< seconds after that
};

/// The clock of a plan, and a wish to end it.
struct PlanWatch {
  std::function<double()> clock{};  ///< seconds; without a clock no time is limited, and all times are 0
  std::function<bool()> stop{};     ///< asked again and again; true ends the plan early
};

/// A member of a problem that makes no sense, and the reason.
struct ProblemFault {
  std::size_t problem;
  std::string_view member;  ///< start, goal or radius
  std::string what;
};
std::optional<ProblemFault> first_fault(const ClearanceField& field,
                                        std::span<const PlanningProblem> problems);

/// The same seed gives the same paths if neither clock nor `stop` ends the plan. Throws std::invalid_argument
/// if there is a fault (first_fault, or fault_of the tree parameters).
PathPlan plan_paths(const ClearanceField& field, std::span<const PlanningProblem> problems,
                    const PlanSettings& settings = {}, const PlanWatch& watch = {});

}  // namespace coppice
