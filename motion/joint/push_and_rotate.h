// A joint plan (joint_plan.h) for small and intricate puzzles, and for robots of several sizes.
//
// The search moves each robot that can reach its goal past the others and shuts no robot in. If no robot can,
// it clears the way of one robot by sending those in the way to refuges; their ways may have to be cleared
// first (as in Push and Rotate: de Wilde, ter Mors, Witteveen, 2014, in continuous space). Robots at their
// goals give way like any other and return. Attempts that fail are repeated with other priorities.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/joint/joint_plan.h"
#include "motion/joint/route_finders.h"

namespace coppice {

class PushAndRotate {
 public:
  /// `field` must outlive it. A robot that could not reach its goal even if it were alone is stranded from
  /// the start.
  PushAndRotate(const ClearanceField& field, std::vector<JointTask> tasks, Random random);

  /// Does a bounded amount of work, some tens of route searches. Returns true once the plan is complete.
  bool step();
  /// The first plan that strands no robot without need, or else the plan that strands the fewest.
  const JointPlan& plan() const { return best_; }

 private:
  struct Discs {
    std::vector<Disc> fixed;
    std::vector<Disc> movable;
    std::vector<std::size_t> movable_robot;
  };

  RouteFinder& finder(std::size_t robot) { return finders_.of(tasks_[robot].radius); }
  /// Whether the robot could reach its goal if it were alone.
  bool hopeful(std::size_t robot) const { return !direct_[robot].empty(); }
  bool at_goal(std::size_t robot) const { return at_[robot] == tasks_[robot].goal.value_or(at_[robot]); }
  bool wants_to_move(std::size_t robot) const { return hopeful(robot) && !at_goal(robot); }
  std::vector<Disc> others(std::size_t robot) const;
  Discs discs_around(std::size_t robot, const std::vector<std::size_t>& fixed) const;
  void begin_attempt();
  void spread_out();
  void end_attempt();
  bool move_directly();
  bool shuts_in(std::size_t robot);
  bool clear_a_way();
  bool clear(std::size_t robot, const Path& way, std::vector<Sweep>& keep_clear,
             std::vector<std::size_t>& waiting, int depth);
  bool evacuate(std::size_t robot, std::vector<Sweep>& keep_clear, std::vector<std::size_t>& waiting,
                int depth);
  void commit(std::size_t robot, Path path);

  std::vector<JointTask> tasks_;
  Random random_;
  RouteFinders finders_;
  /// Each robot's way from its first position if it were alone; empty: it has none.
  std::vector<Path> direct_;

  int attempts_ = 0;
  bool done_ = false;
  std::vector<Point2> at_;
  std::vector<Path> stood_;  ///< the positions at which each robot has already been in this attempt
  std::vector<Move> moves_;
  std::vector<std::size_t> priority_;
  std::vector<bool> tried_;  ///< whether a direct move was tried in vain since a robot last moved
  std::optional<JointPlan> found_;
  JointPlan best_;
};

}  // namespace coppice
