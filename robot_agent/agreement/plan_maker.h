// Makes the joint plan of a round for its leader: moves (motion/joint/joint_planner.h), and times for them
// (motion/joint/joint_schedule.h).
//
// First for robots that are a tenth larger: then their trajectories keep apart as reservations do
// (motion/trajectory/space_time.h), and the robots pass each other at full speed. If that brings not all of
// them to their goals, for robots that keep half a margin each, then for robots as large as they are, and in
// the end for these with those that have arrived at their very goals.
//
// The planner draws at random, and the robots of one plan may take twice as long as those of another. So
// where robots wait for long in a plan, more are made, until several in a row are no better than the best
// one. The times of that one are improved.
//
// Fleet time of the leader, seconds; metres in the map frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "coppice/planning/random.h"
#include "messages/messages.h"
#include "motion/joint/joint_planner.h"
#include "motion/joint/joint_schedule.h"
#include "motion/lattice/packed_roadmap.h"
#include "robot_agent/agreement/reservations.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

class PlanMaker {
 public:
  /// `roadmaps` must outlive it. `members`: as they stand, the leader first. `obstacles` stand for ever.
  /// `others`: the reservations of robots that are no members.
  PlanMaker(MapRoadmaps& roadmaps, std::vector<FleetMember> members, std::vector<JointTask> obstacles,
            std::span<const KnownReservation> others, Random random, double now);

  /// Does a bounded amount of work. Returns true once the plan is complete. If `everybody` is to be brought
  /// to the goal, it also returns true when it has found that this fails.
  bool step(double now, bool everybody);
  /// Some members are not brought to their goals. Valid once step() has returned true.
  bool strands() const;
  /// The plan, without its round and run. Valid once the plan is complete.
  JointPlanMessage message() const;

 private:
  /// A plan that may be made.
  struct Attempt {
    std::vector<JointTask> tasks;  ///< of the members, then of the obstacles
    int most_steps;                ///< of the planner
  };
  struct MakesMoves {
    std::unique_ptr<JointPlanner> planner;
    double since;  ///< the plan was begun
    int steps_left;
  };
  struct FindsTimes {
    JointPlan plan;
    std::unique_ptr<JointSchedule> schedule;
    double since;  ///< the plan was begun
  };
  struct ImprovesTimes {  ///< of the best plan
    JointPlan plan;
    std::unique_ptr<JointSchedule> schedule;
  };
  struct Fails {};
  struct Best {
    JointPlan plan;
    double sum;  ///< of its arrival times, fleet time
  };

  static std::vector<Attempt> attempts(std::span<const FleetMember> members,
                                       std::span<const JointTask> obstacles, const ClearanceField& field);
  MakesMoves first_attempt(Random random, double since) const;
  bool make_moves(MakesMoves& phase, double now, bool everybody);
  void begin_where_robots_stand(JointPlan& plan) const;
  std::unique_ptr<JointSchedule> schedule_of(const JointPlan& plan, double now) const;
  void compare(FindsTimes& phase, double now);
  void go_on(double now);
  double waiting(const FindsTimes& phase) const;

  MapRoadmaps& roadmaps_;
  std::vector<FleetMember> members_;
  std::vector<Disc> obstacles_;
  std::vector<KnownReservation> others_;
  Random random_;
  std::vector<Attempt> attempts_;  ///< those that may succeed, and at least the last resort
  std::optional<Best> best_{};
  int in_vain_ = 0;  ///< plans since then
  std::variant<MakesMoves, FindsTimes, ImprovesTimes, Fails> phase_;
};

}  // namespace coppice
