// The part of one robot in a coordination round, which sorts out a cluster of robots that block each other.
//
// A robot that makes no progress calls a round: a new epoch with itself as leader, for the cluster around it.
// Each robot within the round's reach that hears of it, in the state of any peer, joins: it brakes and waits.
// When all members that are not failed stand, the leader makes a joint plan (plan_maker.h) and publishes it.
// The plan has a trajectory for each member. A member takes up its own one as its reservation (reserver.h),
// and is free again.
//
// A later round replaces an earlier one at any time. A round of the whole fleet follows a round that did not
// sort out its cluster.
//
// A state machine like the agent that owns it: times are fleet time, seconds; metres.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "messages/messages.h"
#include "motion/lattice/packed_roadmap.h"
#include "robot_agent/agreement/plan_maker.h"
#include "robot_agent/agreement/reserver.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

/// The reach of a round of the whole fleet, metres.
inline constexpr double everywhere = 1e6;

class CoordinationRound {
 public:
  explicit CoordinationRound(RobotName robot) : robot_(std::move(robot)) {}

  const RoundId& id() const { return id_; }
  Stage stage() const { return stage_; }
  /// The last joint plan of the whole fleet does not bring this robot to its goal.
  bool stranded() const { return stranded_; }

  /// The robot leads the round, and is making the joint plan.
  bool plans() const { return maker_ != nullptr; }
  /// Rounds that the robot called one after the other from the same position.
  int calls_in_vain() const { return calls_in_vain_; }

  /// The process before this one took part in a round with this epoch.
  void forget(std::uint32_t epoch) { latest_epoch_ = forgotten_ = epoch; }

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

  /// Begins a new round of the cluster around, or of the whole fleet, with this robot as its leader. The
  /// robot is to drive along `way`. A round of one robot would sort out nothing: if nobody is near, the
  /// nearest robot counts as one of the cluster. Without other robots, or on a map that is too large for
  /// joint plans (MapRoadmaps), there is no round.
  void call(const FleetMember& self, const Path& way, const Fleet& fleet, const MapRoadmaps& roadmaps,
            double now);
  void call_everybody(const FleetMember& self, double now);

  /// To be called in each control period while the robot waits. take_own_plan() then returns a plan to
  /// publish, once, and take_up() a plan of which this robot is a member, once.
  void wait(const FleetMember& self, const Fleet& fleet, const Reserver& reserver, MapRoadmaps& roadmaps,
            double now);
  std::optional<JointPlanMessage> take_own_plan() { return std::exchange(own_plan_, std::nullopt); }
  std::shared_ptr<const JointPlanMessage> take_up() { return std::exchange(taken_up_, nullptr); }

 private:
  bool calls_this(const RoundId& round) const {
    return is_later_epoch(round.epoch, forgotten_) && round.overrides(id_);
  }
  void join(const RoundId& id);
  void note_epoch(std::uint32_t epoch);
  void begin(const FleetMember& self, double reach, double now);
  void lead(const FleetMember& self, const Fleet& fleet, const Reserver& reserver, MapRoadmaps& roadmaps,
            double now);
  bool waits_too_long(const Fleet& fleet, double now) const;
  void publish(const FleetMember& self, double now);

  RobotName robot_;
  RoundId id_;
  std::uint32_t latest_epoch_ = 0;  ///< of all rounds that were heard of
  std::uint32_t forgotten_ = 0;     ///< epoch
  Stage stage_ = Stage::free;
  std::shared_ptr<const JointPlanMessage> plan_;  ///< of this round, until it is taken up
  std::optional<double> waiting_since_;
  std::optional<double> planned_since_;  ///< the leader waits no more
  std::optional<double> called_at_;
  Point2 called_from_ = Point2::Zero();
  int calls_in_vain_ = 0;
  std::unique_ptr<PlanMaker> maker_;
  std::optional<JointPlanMessage> own_plan_;
  std::shared_ptr<const JointPlanMessage> taken_up_;
  bool stranded_ = false;
};

}  // namespace coppice
