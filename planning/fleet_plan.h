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

class FleetPlanner {
 public:
  /// `field` outlives it.
  FleetPlanner(const ClearanceField& field, std::span<const PlanningProblem> problems, Random random);

  /// Some hundred iterations. False once every robot is solved or is proved to have no path.
  bool search();
  bool solved(std::size_t robot) const;

  /// Ends the search: each solved robot has a path from now on, straight off the trees.
  void take_first_paths();

  /// Whether every path has been pulled taut: the least that there is to improve.
  bool all_taut() const { return !improver_ || improver_->all_taut(); }

  /// A bounded piece of improving the paths. False once nothing shorter turns up.
  bool improve() { return improver_ && improver_->step(); }

  /// From start to goal, keeps the radius clear; empty: none was found.
  const Path& path(std::size_t robot) const;
  /// Why there is none; empty if there is one.
  std::string reason(std::size_t robot) const;

  SampleCounts counts(std::size_t robot) const;
  std::uint32_t grafted_trees(std::size_t robot) const;
  SampleCounts disjointed_counts() const { return planner_ ? planner_->disjointed_counts() : SampleCounts{}; }
  std::uint32_t frozen_trees() const { return planner_ ? planner_->frozen_trees() : 0; }

  /// Edges of all trees, for a picture: whose root tree (index of the problem), or -1 for a disjointed one.
  struct Edge {
    Point2 from;
    Point2 to;
    int robot = -1;
  };
  std::vector<Edge> edges() const;

 private:
  /// One robot's problem and how far it has come.
  struct Robot {
    PlanningProblem problem;
    std::optional<GroupIndex> group;  ///< none: the straight line is its path
    bool unreachable = false;
    Path straight;
    Path through;                         ///< narrow passages, where sampling found no way
    std::optional<std::size_t> improved;  ///< its number in the improver; none: straight, or no path
  };

  void settle_by_roadmap();

  const ClearanceField& field_;
  double epsilon_ = 0;
  Random random_;
  std::vector<Robot> robots_;
  std::optional<MaRrdtStar<ClearanceField>> planner_;  ///< for those whose straight line is not free
  std::uint64_t fruitless_ = 0;                        ///< iterations since somebody succeeded
  std::optional<PathImprover<ClearanceField>> improver_;
};

}  // namespace coppice
