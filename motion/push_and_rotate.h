// A joint plan (joint_plan.h) for small and intricate puzzles, and for robots of several sizes.
//
// It is found by search: whoever can reach its goal past the others and shuts nobody in goes; where nobody
// can, somebody's way is cleared by sending those that stand in it to refuges, which may mean to clear the
// way of these first (as in Push and Rotate: de Wilde, ter Mors, Witteveen, 2014, in continuous space).
// Robots at their goals give way like any other and return. Attempts that lead nowhere are begun anew with
// other priorities.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "motion/joint_plan.h"
#include "motion/route_finders.h"
#include "planning/random.h"

namespace coppice {

class PushAndRotate {
 public:
  /// `field` outlives it. A robot that could not even reach its goal alone is stranded from the start.
  PushAndRotate(const ClearanceField& field, std::vector<JointTask> tasks, Random random);

  /// A bounded amount of work: some tens of route searches. True once the plan is there.
  bool step();
  /// The first plan that strands nobody without need, or else the one that strands the fewest.
  const JointPlan& plan() const { return best_; }

 private:
  struct Discs {
    std::vector<Disc> fixed;
    std::vector<Disc> movable;
    std::vector<std::size_t> movable_robot;
  };

  RouteFinder& finder(std::size_t robot) { return finders_.of(tasks_[robot].radius); }
  /// It can reach its goal when alone.
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
  std::vector<Path> direct_;  ///< each robot's way from its first position, alone; empty: it has none

  int attempts_ = 0;
  bool done_ = false;
  std::vector<Point2> at_;
  std::vector<Path> stood_;  ///< where each robot has already been in this attempt
  std::vector<Move> moves_;
  std::vector<std::size_t> priority_;
  std::vector<bool> tried_;  ///< in vain since anybody last moved
  std::optional<JointPlan> found_;
  JointPlan best_;
};

}  // namespace coppice
