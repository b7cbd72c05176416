// The part of one robot in a coordination round, which sorts out a cluster of robots that block each other.
//
// A robot that makes no progress calls a round: a new epoch with itself as leader, for the cluster around it.
// Each robot within the round's reach that hears of it, in the state of any peer, joins: it brakes and waits.
// When all members that are not failed stand, the leader makes a joint plan (motion/joint_planner.h) and
// publishes it. Each member executes its own moves in the order of the plan (motion/precedence.h). It is free
// again after its last move.
//
// A later round replaces an earlier one at any time. A member that leaves for a later round leaves the others
// free. A member that leaves with moves to make, because it was stopped or came too late, opens no gate: the
// first robot that waits for it calls a new round. A round of the whole fleet follows a round that did not
// sort out its cluster.
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
#include "motion/precedence.h"
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
  /// The robot whose progress this robot waits for; empty: none.
  const RobotName& waits_for() const { return waits_for_; }
  /// Fleet time before which that robot cannot have come far enough.
  double waits_until() const { return waits_until_; }
  /// The last joint plan of the whole fleet does not bring this robot to its goal.
  bool stranded() const { return stranded_; }

  /// The robot leads the round, and is making the joint plan.
  bool plans() const { return planner_ != nullptr; }
  /// Rounds that the robot called one after the other from the same position.
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

  /// Something has changed: rounds that did not help before may help now.
  void retry_after_change() { calls_in_vain_ = 0; }
  /// The robot has another goal: earlier failures say nothing about it.
  void forget_failures() {
    calls_in_vain_ = 0;
    stranded_ = false;
  }

  /// `position`: of this robot; none if it takes no part in rounds.
  void hear(const RobotState& state, const std::optional<Point2>& position);
  void hear(std::shared_ptr<const JointPlanMessage> plan);

  /// The robot takes no part any more.
  void leave();

  /// Begins a new round of the cluster around, or of the whole fleet, with this robot as its leader.
  void call(const FleetMember& self, const Fleet& fleet, double now);
  void call_everybody(const FleetMember& self, double now);

  /// To be called in each control period while the robot waits. take_own_plan() then returns a plan to
  /// publish, once.
  void wait(const FleetMember& self, const Fleet& fleet, MapRoadmaps& places, double now);
  std::optional<JointPlanMessage> take_own_plan();

  /// To be called in each control period while the robot executes its moves: the preferred velocity. Ends the
  /// stage after the last move. `position`: where the velocity takes effect.
  Point2 preferred_velocity(const FleetMember& self, const Fleet& fleet, const Point2& position,
                            const Limits& limits, double now);
  /// Whether that velocity leads past everything that stands.
  void led_past(bool everything) { follower_->led_past(everything); }
  /// Whether a robot close by has a next move that is earlier in the plan. A robot that is held up lets it go
  /// first.
  bool gives_way(const FleetMember& self, const Fleet& fleet, double now);

 private:
  struct Schedule {                 ///< of a member's moves
    std::vector<double> ends{};     ///< metres along its way
    std::vector<std::size_t> at{};  ///< in the plan
  };

  /// The part of a member in the plan, as far as this robot knows.
  enum class Part : std::uint8_t {
    under_way,
    done,  ///< it has made all its moves
    left,  ///< it made some moves, and makes no more: a robot that waits for it calls a new round
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
  std::uint32_t latest_epoch_ = 0;  ///< of all rounds that were heard of
  std::uint32_t forgotten_ = 0;     ///< epoch
  bool has_lost_plan_ = false;
  Stage stage_ = Stage::free;
  std::shared_ptr<const JointPlanMessage> plan_;  ///< of this round, until it is taken up
  std::optional<double> waiting_since_;
  std::optional<double> planned_since_;  ///< the leader waits no more
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
  Gates gates_;
  RobotName waits_for_;
  double waits_until_ = 0;
  bool stranded_ = false;
  struct Awaited {
    RobotName robot{};
    double progress = 0;
  };
  Awaited awaited_;           ///< the robot that it waited for last
  double awaited_since_ = 0;  ///< since then its progress has not changed
  double last_progress_ = 0;
  double last_progress_time_ = 0;
};

}  // namespace coppice
