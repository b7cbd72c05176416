// Makes the joint plan of a round for its leader: moves (motion/joint_planner.h), and times for them
// (motion/joint_schedule.h).
//
// First for robots that are a tenth larger: then their trajectories keep apart as reservations do
// (motion/space_time.h), and the robots pass each other at full speed. If that brings not all of them to
// their goals, for robots as large as they are.
//
// The planner draws at random, and the robots of one plan may take twice as long as those of another. So
// where robots wait for long in a plan, more are made, until several in a row are no better than the best
// one. The times of that one are improved.
//
// Fleet time of the leader, seconds; metres in the map frame.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "messages/messages.h"
#include "motion/joint_planner.h"
#include "motion/joint_schedule.h"
#include "motion/packed_roadmap.h"
#include "planning/random.h"
#include "robot_agent/fleet.h"
#include "robot_agent/reservations.h"

namespace coppice {

class PlanMaker {
 public:
  /// `places` must outlive it. `members`: as they stand, the leader first. `obstacles` stand for ever.
  /// `others`: the reservations of robots that are no members.
  PlanMaker(MapRoadmaps& places, std::vector<FleetMember> members, std::vector<JointTask> obstacles,
            std::span<const KnownReservation> others, Random random);

  /// Does a bounded amount of work. Returns true once the plan is complete. If `everybody` is to be brought
  /// to the goal, it also returns true when it has found that this fails.
  bool step(double now, bool everybody);
  /// Some members are not brought to their goals.
  bool strands() const { return !plan_.stranded.empty(); }
  /// The plan, without its round and run.
  JointPlanMessage message() const;

 private:
  bool make_moves(double now, bool everybody);
  void begin_where_robots_stand();
  void schedule(double now);
  void compare(double now);
  void go_on(double now);
  double waiting() const;

  MapRoadmaps& places_;
  std::vector<FleetMember> members_;
  std::vector<JointTask> tasks_;  ///< of the members, then of the obstacles
  std::vector<KnownReservation> others_;
  Random random_;
  std::vector<JointTask> larger_;          ///< tasks of larger robots; empty: these have no room, or no plan
  double since_ = 0;                       ///< when the plan was begun
  int steps_left_;                         ///< of the planner, unless it is the last resort
  std::unique_ptr<JointPlanner> planner_;  ///< until there are moves
  JointPlan plan_{};
  std::unique_ptr<JointSchedule> schedule_;  ///< of the plan
  bool is_chosen_ = false;                   ///< the plan is the best one
  JointPlan best_{};
  double least_ = std::numeric_limits<double>::infinity();  ///< sum of its arrival times, fleet time
  int in_vain_ = 0;                                         ///< plans since then
};

}  // namespace coppice
