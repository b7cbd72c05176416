// Plans paths for a whole fleet in one process, without bus and motion: Algorithm 2 from beginning to end,
// then shorter paths for as long as there is time.
//
// Zhang, Wang, Meng, "Multi-robot Path Planning with Rapidly-exploring Random Disjointed-Trees", 2023; with
// one robot it is Algorithm 1, RRdT*. Metres.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/plan_paths.h"
#include "coppice/planning/random.h"
#include "planning/trees/ma_rrdt_star.h"
#include "planning/trees/path_improvement.h"

namespace coppice {

class FleetPlanner {
 public:
  /// `field` must outlive it.
  FleetPlanner(const ClearanceField& field, std::span<const PlanningProblem> problems,
               const TreeParameters& trees, Random random);

  /// Other tasks, for robots with radii that the first ones had. The trees of earlier tasks serve them, too.
  void begin_mission(std::span<const PlanningProblem> problems);

  /// Runs some hundred iterations. Returns false once each robot is solved or is proved to have no path.
  bool search();
  bool solved(std::size_t robot) const;

  /// Ends the search. From now on each solved robot has a path, straight off the trees.
  void take_first_paths();

  /// Whether each path has been pulled taut, the first stage of improvement.
  bool all_taut() const { return !improver_ || improver_->all_taut(); }

  /// Does a bounded amount of work to improve the paths. Returns false once no shorter path turns up.
  bool improve() { return improver_ && improver_->step(); }

  /// The path from start to goal, which keeps the radius clear; empty if none was found.
  Path path(std::size_t robot) const;
  /// The reason why there is no path; empty if there is one.
  std::string reason(std::size_t robot) const;

  SampleCounts counts(std::size_t robot) const;
  std::uint32_t grafted_trees(std::size_t robot) const;
  SampleCounts disjointed_counts() const { return planner_ ? planner_->disjointed_counts() : SampleCounts{}; }
  std::uint32_t frozen_trees() const { return planner_ ? planner_->frozen_trees() : 0; }

  /// Edges of all trees, for a picture.
  std::vector<TreeEdge> edges() const;

 private:
  /// The problem of a robot and its progress.
  struct Robot {
    PlanningProblem problem;
    std::optional<GroupIndex> group;  ///< none: the straight line is the path
    bool unreachable = false;
    Path through;  ///< path through narrow passages, where sampling found none
    /// The robot's number in the improver; none: a straight path, or no path.
    std::optional<std::size_t> improved;
  };

  void settle_by_roadmap();

  const ClearanceField& field_;
  TreeParameters trees_;
  double smallest_radius_ = 0;
  Random random_;
  std::vector<Robot> robots_;
  GroupIndex first_group_ = 0;                         ///< of this mission
  std::optional<MaRrdtStar<ClearanceField>> planner_;  ///< for the robots whose straight line is not free
  std::uint64_t fruitless_ = 0;                        ///< iterations since a robot was solved
  std::optional<PathImprover<ClearanceField>> improver_;
};

}  // namespace coppice
