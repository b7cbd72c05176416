// How one robot gets its reservation: a trajectory in space and time, planned around those of the others.
//
// A robot that has a path announces it. The robots plan one after the other, by priority (priority.h): each
// plans for itself as soon as nobody waits who is to plan before it. It publishes its trajectory, and with it
// the reservations around which it was planned (its basis). If two robots plan at the same time, neither is
// in the other's basis; where the two come too close, the second one plans again.
//
// A robot that finds no trajectory around all others is urgent until it is at its goal: it plans around as
// many as possible, and the rest plan again (trajectory_planner.h). Urgent robots, and those of a joint plan,
// do not give way to it.
//
// Two robots that know each other's reservations count on each other to stay in their strips and to keep the
// order (held_reservation.h). A robot leaves its strip only when no other robot can still count on it to stay
// there.
//
// A joint plan has a trajectory for each of its members, which becomes the member's reservation. So the
// robots of a plan keep its order like any other.
//
// A state machine like the agent that owns it: times are fleet time, seconds; metres.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"
#include "motion/lattice/packed_roadmap.h"
#include "robot_agent/agreement/held_reservation.h"
#include "robot_agent/agreement/reservations.h"
#include "robot_agent/agreement/trajectory_planner.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

class Reserver {
 public:
  /// `others` outlives it.
  Reserver(RobotName robot, const RunId& run, const Reservations& others)
      : robot_(std::move(robot)), run_(run), others_(&others), state_(nothing) {}

  /// The robot drives by its reservation, or has driven to its end.
  bool holds() const { return std::holds_alternative<HeldReservation>(state_); }
  /// The reservation that it holds.
  HeldReservation& held() { return std::get<HeldReservation>(state_); }
  const HeldReservation& held() const { return std::get<HeldReservation>(state_); }
  bool wants() const { return std::holds_alternative<Wanted>(state_); }
  /// The robot waits for its turn, and has not planned in vain on its way to its goal.
  bool waits_for_its_turn() const { return wants() && !is_urgent_; }
  std::uint32_t number() const { return holds() ? held().message().number : 0; }
  /// Grows with each reservation of another robot that this robot heeds.
  std::uint32_t reservations_version() const { return holds() ? others_->news() : 0; }
  /// To be called for each period of the body.
  void come_to(const Driver& body) {
    if (holds()) held().come_to(body);
  }
  double progress() const { return holds() ? held().progress() : 0; }
  /// The robot for which this one waits at a gate; empty: none.
  const RobotName& waits_for() const { return holds() ? held().waits_for() : nobody_; }
  /// The robot carries out its part of a joint plan.
  bool executes_plan() const {
    return holds() && !held().message().plan.leader.empty() && !held().finished();
  }

  /// The robot stands, and is to drive along a path. Announces it.
  void want(const Path& path, const FleetMember& self, const ClearanceField& field, double now,
            std::vector<Outgoing>& out);
  /// The robot stands. It has no reservation any more, and wants none. Tells the others, if it is news.
  void drop(const FleetMember& self, const Fleet& fleet, double now, std::vector<Outgoing>& out);

  /// Plans if it is this robot's turn: from where it stands along `path`, or beside it. It departs at
  /// `ready`, at the earliest.
  void plan(const Path& path, double ready, const FleetMember& self, const Limits& limits, const Fleet& fleet,
            MapRoadmaps& roadmaps, double now, std::vector<Outgoing>& out);
  /// Takes up the part of this robot in a joint plan, if it has one that begins where the robot stands.
  void adopt(const JointPlanMessage& plan, const FleetMember& self, const Fleet& fleet, double now,
             std::vector<Outgoing>& out);
  /// Once in each control step. Two robots may have planned without each other, and keep apart. The one that
  /// planned second names the other in its basis: so both know in which order they pass.
  void name_those_beside(double now, std::vector<Outgoing>& out);
  /// What another robot has reserved, if it keeps to that.
  std::optional<KnownReservation> reservation_of(const FleetMember& m) const;
  /// The robot may try anew: something has changed since the last attempt, or that was a while ago.
  bool may_try(double now) const;

  /// A state of another robot came.
  void hear(const RobotState& state);
  /// What to tell these robots: the reservations of theirs that this robot heeds.
  std::vector<ReservationId> knows(std::span<const RobotName> robots);
  /// Whether this robot has told another one that it heeds a reservation of that robot.
  bool has_told(const RobotName& robot) const { return told_.contains(robot); }
  /// The process was started in mid-run, or slept: others may rely on a reservation that it does not know.
  /// `last_state`: the stamp of the last state that was said before.
  void begin_anew(const Fleet& fleet, double last_state, double now);
  /// Once in each control step. Robots that have heard that this one has given up its reservation rely on it
  /// no longer than until they come to rest.
  void note_who_heard(const Fleet& fleet, double now);
  /// Whether this robot, which stands, may move off the strip of its last reservation: no other robot counts
  /// on it to stay there any more, or meets it before it has ceased to.
  bool may_leave_strip(const FleetMember& self, const Fleet& fleet, double now) const;
  /// Whether the order of the reservations keeps this robot and another one apart, whatever that does next.
  /// `age`: of the other's state, at most, seconds.
  bool passes(const RobotState& other, double age, double now);

 private:
  struct None {
    double tried_at;     ///< the last attempt that failed
    std::uint32_t news;  ///< of the others, up to then
  };
  struct Wanted {
    Priority priority = Priority::usual;
    double way = 0;                     ///< metres
    double since = 0;                   ///< it has waited for the next one
    std::optional<RobotName> next{};    ///< whose turn it is; an empty name: robots that were not heard
    std::set<RobotName> passed_over{};  ///< they took too long
  };
  /// Another robot may rely on this one to stay in the strip of a reservation that it has given up.
  struct Relies {
    RobotName robot;         ///< empty: it is not known which one
    std::uint32_t number;    ///< of the reservation
    double until;            ///< fleet time
    bool has_heard = false;  ///< that it was given up
  };

  static constexpr None nothing{-1e9, 0};

  std::uint32_t next_number(double now);
  void say(ReservationMessage message, const FleetMember& self, double now, std::vector<Outgoing>& out);
  RobotName next_to_plan(const Wanted& wanted, const Fleet& fleet) const;
  bool is_turn(Wanted& wanted, const Fleet& fleet, double now) const;
  HeldReservation& hold(ReservationMessage message, const Limits& limits, double now,
                        std::vector<Outgoing>& out);
  std::vector<OtherRobot> others_to_reckon_with(const Fleet& fleet, double now) const;
  void leave_strip(const Fleet& fleet, double now);
  bool may_rely(const RobotName& robot) const;
  bool may_be_met(const Relies& other, const FleetMember& self, const Fleet& fleet, double now) const;

  RobotName robot_;
  RobotName nobody_;  ///< empty
  RunId run_;
  const Reservations* others_;
  std::uint32_t number_ = 0;  ///< of the last message
  bool is_urgent_ = false;    ///< it has planned in vain on its way to its goal
  bool is_news_ = false;      ///< others have not been told that there is no reservation
  bool has_begun_anew_ = false;
  std::variant<None, Wanted, HeldReservation> state_;
  std::map<RobotName, std::uint32_t> knows_this_;  ///< the number of this robot that another one has heard of
  struct Told {
    std::uint32_t number = 0;
    std::uint32_t times = 0;
  };
  std::map<RobotName, Told> told_;
  std::size_t next_told_ = 0;
  std::vector<Relies> rely_on_strip_;
};

}  // namespace coppice
