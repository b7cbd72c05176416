// A reservation that a robot drives by, and the order in which it passes the robots that have one, too.
//
// While the robot drives, order counts and time does not: where its way comes near the way of another, the
// robot whose trajectory passes first goes first (motion/trajectory/reserved_order.h).
//
// Two robots that know each other's reservations need not reckon with whatever the other one may do: each
// stays in the strip along its way and heeds its gates (docs/safety.md). Their order is confirmed once both
// are sure to know it, and neither has passed a gate that is closed to it.
//
// Times are fleet time, seconds; metres.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "messages/messages.h"
#include "messages/reservation_relation.h"
#include "motion/body/driver.h"
#include "motion/body/way_follower.h"
#include "motion/trajectory/corners.h"
#include "motion/trajectory/reserved_order.h"
#include "robot_agent/agreement/reservations.h"
#include "robot_agent/peers/fleet.h"
#include "robot_agent/timing.h"

namespace coppice {

/// Metres per second: a robot that drives more slowly, and wants to go on, is held up. A robot that speeds up
/// slowly is faster than that within Timing::waiting_lease.
inline double crawl(const Limits& limits) {
  constexpr double of_largest = 0.05;
  constexpr double of_speeding_up = 0.8;
  return std::min(of_largest * limits.max_speed,
                  of_speeding_up * Timing::waiting_lease * limits.max_acceleration);
}

class HeldReservation {
 public:
  /// The robot stands. `limits`: of this robot. `others` outlives it.
  HeldReservation(std::shared_ptr<const ReservationMessage> own, const Limits& limits,
                  const Reservations& others);

  /// The reservation is the robot's part of a joint plan. Until another member has taken up its own part, it
  /// counts as standing at the beginning of its way.
  void expect_members_of(const JointPlanMessage& plan);

  /// The robot's way goes on beyond the end of the reservation, where `rest` begins. It is to reserve anew
  /// there.
  void goes_on_along(Path rest) { rest_ = std::move(rest); }

  const ReservationMessage& message() const { return *own_; }
  /// The way of the reservation, and what lies beyond its end.
  Path way() const;
  const Path& rest() const { return rest_; }
  /// The end of the way.
  const Point2& leads_to() const { return rest_.empty() ? own_->trajectory.back().position : rest_.back(); }
  /// Metres along the way.
  double progress() const { return follower_.progress(); }
  bool finished() const { return follower_.finished(); }
  /// Metres between the robot and the way.
  double off_the_way(const Point2& p) const { return follower_.off_the_way(p); }

  /// Takes up the order with robots whose reservations are new.
  void look_at_others(const Fleet& fleet);
  /// Another robot has reserved at the same time, too close, and goes first. The robot is to stand, and to
  /// plan anew.
  bool is_overridden() const { return is_overridden_; }

  /// Whether a reservation was planned without this one, keeps apart from it, and has no order with it until
  /// this one names it in its basis.
  bool has_unnamed() const;
  /// The reservations with which this one has an order, or is to have one. Those of the same joint plan
  /// aside.
  std::vector<ReservationBasis> basis() const;
  /// The same trajectory under a new number, with another basis. Others may take the old number for left: so
  /// nothing is confirmed any more.
  void renew(std::shared_ptr<const ReservationMessage> own);

  /// Whether the order keeps this robot and another one apart, whatever that does next. `heard`: the number
  /// of this robot of which the other one has heard. `said_at`: fleet time of its state,
  /// at the earliest.
  bool passes(const RobotState& other, std::uint32_t heard, double said_at);
  /// Others may have taken this robot for failed, or may have been taken for that by it, and passed gates
  /// that were closed. What they say from `until` on shows whether they did.
  void doubt_all(double until);

  /// Metres along the way up to which the robot keeps `margin` metres from the robots that stand in its way;
  /// infinite without a margin. `limits`: of this robot.
  double open_before(std::span<const Neighbour> neighbours, double margin, const Limits& limits) const;
  /// To be called for each period of the body, whoever decides what it does.
  void come_to(const Driver& body);
  /// To be called in each control period, before what follows: looks how far the gates are open. `open`:
  /// metres along the way up to which the robot may come at most.
  void look_at_gates(const Fleet& fleet, double now, double open);
  /// `position`: where it takes effect.
  Point2 preferred_velocity(const Point2& position, const Limits& limits) const {
    return follower_.preferred_velocity(position, limits, control_period, open_);
  }
  /// Whether the robot stays in its strip and heeds its gates if it takes a twist from the decision time on,
  /// for one period, and then brakes.
  bool allows(const Driver& body, const Twist& twist) const;
  void led_past(bool everything) { follower_.led_past(everything); }

  /// The robot that passes first, at the gate where this one stands; empty: none.
  const RobotName& waits_for() const { return waits_for_; }
  /// Seconds for which this robot may bind itself to stand meanwhile: the other one cannot have come far
  /// enough before. A robot that brakes slowly speeds up no further than it can brake within the lease.
  double lease(double now) const;
  /// The robots that wait for each other, one for the next: whether the last one of them comes on.
  bool is_worth_waiting() const { return is_worth_waiting_; }
  /// Of two robots close by that only promises keep apart, the one that is further behind its trajectory goes
  /// first. The other one, if it is held up, is to stand for a moment.
  bool gives_way(const Point2& position, const Fleet& fleet) const;
  /// Seconds for which the robot, which wants this velocity, is to stand, so that a robot that blocks it can
  /// pass; 0: not at all. That is where the above has not helped for long (`stalls`), or where the other
  /// robot is ahead, and so slow to speed up that this one would close every gap.
  double lets_others_pass_for(const Driver& body, const Point2& wanted, const Fleet& fleet, bool stalls,
                              double now) const;

 private:
  struct Pair {                ///< this robot and another one
    std::uint32_t number = 0;  ///< of the other's reservation
    bool is_awaited = false;   ///< the other robot is to take up its part of the same joint plan
    Gates gates{};
    std::vector<Gate> theirs{};  ///< before this robot
    bool is_related = false;     ///< one was planned around the other
    bool overrides = false;      ///< the other one: the two come too close, and this one plans anew
    /// The two planned without each other and keep apart, with room in time. This one is to name the other in
    /// its basis.
    bool is_to_be_named = false;
    double offset = 0;                 ///< seconds, to be added to the other's times
    std::vector<Stretch> too_close{};  ///< of this robot's way, where the two do not keep apart
    double they_beyond = -1;           ///< metres along the other's way beyond which the two keep apart
    std::vector<Corner> their_corners{};
    bool is_confirmed = false;  ///< both heed the order
  };
  /// A robot that goes first at the next gates: how far it has come, at least.
  struct First {
    const Pair* pair;
    Promise promise;
    Limits limits;
    double clock_error;
    double progress;
    double slip;  ///< metres by which its progress may be less than what it drives from the decision time on

    double progress_at(double time) const;
  };
  /// The robot at the end of a chain of waits.
  struct Awaited {
    RobotName robot{};
    double progress = 0;
    double since = 0;
  };

  Pair pair_with(const ReservationMessage& other, const Fleet& fleet) const;
  bool has_left(const Pair& pair, const FleetMember& m) const;
  bool may_be_confirmed(const Pair& pair, const RobotState& other) const;
  bool heeds_its_gates(const Pair& pair, const RobotState& other, double own_progress) const;
  double comes_to_rest_at() const;
  bool keeps_apart(const Pair& pair, double others_progress) const;
  bool goes_first(const FleetMember& m, double turn) const;
  bool leads_into_robot(const FleetMember& m) const;
  bool last_one_comes_on(const Fleet& fleet, double now);

  std::shared_ptr<const ReservationMessage> own_;
  Path rest_{};  ///< of the way, beyond the end of the reservation; empty: it leads to the end of the way
  const Reservations* others_;
  WayFollower follower_;
  RoundId round_{};  ///< of the joint plan that it is a part of
  std::map<RobotName, Pair> pairs_;
  std::vector<First> first_;  ///< in this period
  bool is_overridden_ = false;
  double doubts_until_ = -std::numeric_limits<double>::infinity();  ///< fleet time
  std::uint32_t news_ = ~std::uint32_t{0};                          ///< up to which the pairs are taken up
  std::vector<Corner> corners_;
  double open_ = 0;  ///< metres along the way up to which the robot may come in this period
  RobotName waits_for_;
  bool is_worth_waiting_ = false;
  double waits_until_ = 0;  ///< fleet time before which that robot cannot have come far enough
  double longest_lease_ = Timing::longest_lease;
  Awaited awaited_;
  double own_speed_ = 0;  ///< until the decision time
  Limits own_limits_;
};

}  // namespace coppice
