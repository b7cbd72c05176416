// Paths for a whole fleet in one process: Algorithm 2 from beginning to end, then shorter paths for as long
// as there is time; no bus and no motion.
//
// Zhang, Wang, Meng, "Multi-robot Path Planning with Rapidly-exploring Random Disjointed-Trees", 2023; with
// one robot it is Algorithm 1, RRdT*. Metres.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planning/clearance_field.h"
#include "planning/ma_rrdt_star.h"
#include "planning/path_improvement.h"
#include "planning/random.h"

namespace coppice {

struct PlanningProblem {
  Point2 start;
  Point2 goal;
  double radius = 0;  ///< a disc of it is free at start and goal
};

struct FleetPlanSettings {
  double epsilon = 0;                ///< 0: from the map (step_length.h)
  std::size_t disjointed_trees = 0;  ///< 0: max(16, 2 n)
};

class FleetPlanner {
 public:
  /// `field` outlives it.
  FleetPlanner(const ClearanceField& field, std::span<const PlanningProblem> problems,
               const FleetPlanSettings& settings, Random random);

  /// Some hundred iterations. False once every robot is solved or is proved to have no path.
  bool search();
  bool solved(std::size_t robot) const { return planner_.solved(static_cast<GroupIndex>(robot)); }
  std::size_t open() const { return planner_.open_groups(); }

  /// Ends the search: each solved robot has a path from now on, straight off the trees.
  void take_first_paths();

  /// A bounded piece of improving the paths. False once nothing shorter turns up.
  bool improve();

  /// Whether every path has been pulled taut: the least that there is to improve.
  bool all_taut() const { return improver_->all_taut(); }

  /// From start to goal, keeps the radius clear; empty: none was found.
  const Path& path(std::size_t robot) const;
  /// Why there is none; empty if there is one.
  std::string reason(std::size_t robot) const;

  SampleCounts counts(std::size_t robot) const {
    return planner_.group_counts(static_cast<GroupIndex>(robot));
  }
  std::uint32_t grafted_trees(std::size_t robot) const {
    return planner_.grafted_trees(static_cast<GroupIndex>(robot));
  }
  SampleCounts disjointed_counts() const { return planner_.disjointed_counts(); }
  std::uint32_t frozen_trees() const { return planner_.frozen_trees(); }

  /// Edges of all trees, for a picture: whose root tree (index of the problem), or -1 for a disjointed one.
  struct Edge {
    Point2 from;
    Point2 to;
    int robot = -1;
  };
  std::vector<Edge> edges() const;

 private:
  void give_up_unreachable();

  const ClearanceField& field_;
  std::vector<PlanningProblem> problems_;
  double epsilon_;
  Random random_;
  MaRrdtStar<ClearanceField> planner_;
  std::vector<bool> unreachable_;
  std::uint64_t fruitless_ = 0;  ///< iterations since somebody succeeded
  bool doubted_ = false;
  std::optional<PathImprover<ClearanceField>> improver_;
  std::vector<std::size_t> robot_of_;  ///< in the improver, for each problem; npos without a path
};

}  // namespace coppice
