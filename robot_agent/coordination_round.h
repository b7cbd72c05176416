// A robot's part in sorting out a crowd that stands in its own way.
//
// Whoever makes no progress calls a round: a new epoch, of which it is the leader, for everybody in the crowd
// around it. Who hears of it, in anybody's state, and is within its reach joins: brakes and holds. Once all
// of these that are alive stand, the leader makes a joint plan (motion/joint_planner.h) and publishes it;
// each then drives its own moves in the plan's order (motion/precedence.h), and is free again after its last.
// A later round overrides an earlier one at any time; who is called away from a plan leaves the others free.
// A robot that leaves a plan with moves to make, for it was stopped or came too late, opens no gate: the
// first one that waits for it calls a new round. A round that does not sort out its crowd is followed by one
// of the whole fleet.
//
// A state machine like the agent that owns it: times are fleet time, seconds; metres.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "messages/messages.h"
#include "motion/joint_planner.h"
#include "motion/packed_roadmap.h"
#include "motion/way_follower.h"
#include "robot_agent/fleet.h"

namespace coppice {

/// The reach of a round of the whole fleet, metres.
inline constexpr double everywhere = 1e6;

class CoordinationRound {
 public:
  explicit CoordinationRound(RobotName robot) : robot_(std::move(robot)) {}

  const RoundId& id() const { return id_; }
  Stage stage() const { return stage_; }
  double progress() const { return follower_ ? follower_->progress() : 0; }
  /// Whose progress it waits for; empty for nobody.
  const RobotName& waits_for() const { return waits_for_; }
  /// Fleet time before which that cannot have come far enough.
  double waits_until() const { return waits_until_; }
  /// The last joint plan, of the whole fleet, does not bring this robot to its goal.
  bool stranded() const { return stranded_; }

  /// It leads, and is at work on the joint plan.
  bool plans() const { return planner_ != nullptr; }
  /// Knots that it called one after the other from the same place.
  int calls_in_vain() const { return calls_in_vain_; }

  /// The process before this one took part in a round with this epoch. `in_progress`: others count on moves
  /// that this process does not know.
  void forget(std::uint32_t epoch, bool in_progress) {
    latest_epoch_ = forgotten_ = epoch;
    has_lost_plan_ = in_progress;
  }
  /// Calls a round, once, if others count on a lost plan.
  void call_for_lost_plan(const FleetMember& self, const Fleet& fleet, double now) {
    if (std::exchange(has_lost_plan_, false) && stage_ == Stage::free) call(self, fleet, now);
  }

  /// What did not help before may do so now.
  void retry_after_change() { calls_in_vain_ = 0; }
  /// It is to go elsewhere: that no plan could help it until now says nothing.
  void forget_failures() {
    calls_in_vain_ = 0;
    stranded_ = false;
  }

  /// `position`: of this robot, none before it has a body.
  void hear(const RobotState& state, const std::optional<Point2>& position);
  void hear(std::shared_ptr<const JointPlanMessage> plan);

  /// It takes no more part.
  void leave();

  /// Begins a new round of the crowd around, or of the whole fleet, with this robot as its leader.
  void call(const FleetMember& self, const Fleet& fleet, double now);
  void call_everybody(const FleetMember& self, double now);

  /// Once a control period while waiting. `own_plan`, once, what to publish.
  void wait(const FleetMember& self, const Fleet& fleet, MapRoadmaps& places, double now);
  std::optional<JointPlanMessage> take_own_plan();

  /// Once a control period while executing: where to drive. Ends the stage when the last move is done.
  /// `position`: at the turn, from where the velocity will be driven.
  Point2 preferred_velocity(const FleetMember& self, const Fleet& fleet, const Point2& position,
                            const Limits& limits, double now);
  /// Whether that leads past what stands.
  void led_past(bool everything) { follower_->led_past(everything); }
  /// While executing: whether somebody close by, whose next move is earlier in the plan, is under way: a
  /// robot that is held up lets it go first.
  bool gives_way(const FleetMember& self, const Fleet& fleet, double now);

 private:
  struct Schedule {                 ///< of a member's moves
    std::vector<double> ends{};     ///< metres along its way
    std::vector<std::size_t> at{};  ///< in the plan
  };

  /// What is known of a member of the plan.
  enum class Part : std::uint8_t {
    under_way,
    done,  ///< it has made all its moves
    left,  ///< it made some, and makes no more: what waits for these calls a new round
  };

  bool calls_this(const RoundId& round) const {
    return is_later_epoch(round.epoch, forgotten_) && round.overrides(id_);
  }
  void join(const RoundId& id);
  void note_epoch(std::uint32_t epoch);
  void begin(const FleetMember& self, double reach, double now);
  void lead(const FleetMember& self, const Fleet& fleet, MapRoadmaps& places, double now);
  void publish(const FleetMember& self, double now);
  void take_up(const JointPlanMessage& plan, const FleetMember& self);
  bool has_made_all_moves(std::size_t member, double progress) const;
  std::size_t next_move(std::size_t member, double progress) const;

  RobotName robot_;
  RoundId id_;
  std::uint32_t latest_epoch_ = 0;  ///< of all that were heard of
  std::uint32_t forgotten_ = 0;     ///< epoch
  bool has_lost_plan_ = false;
  Stage stage_ = Stage::free;
  std::shared_ptr<const JointPlanMessage> plan_;  ///< of this round, until it is taken up
  std::optional<double> waiting_since_;
  std::optional<double> planned_since_;  ///< its leader holds no more
  std::optional<double> called_at_;
  Point2 called_from_ = Point2::Zero();
  int calls_in_vain_ = 0;
  std::vector<FleetMember> led_;  ///< the members as the planner was given them, this robot first
  std::unique_ptr<JointPlanner> planner_;
  std::optional<JointPlanMessage> own_plan_;
  std::vector<RobotName> members_;
  std::vector<Schedule> schedules_;
  std::vector<Part> parts_;  ///< of the members
  std::optional<WayFollower> follower_;
  RobotName waits_for_;
  double waits_until_ = 0;
  bool stranded_ = false;
  struct Awaited {
    RobotName robot{};
    double progress = 0;
  };
  Awaited awaited_;           ///< whom it waited for last
  double awaited_since_ = 0;  ///< that nothing of it has changed
  double last_progress_ = 0;
  double last_progress_time_ = 0;
};

}  // namespace coppice
