// A robot's body and what it may choose in a control step: a velocity is proposed, and promises decide
// whether it is safe. The proposal is that of a way which a plan has cleared (following), or that of
// reciprocal velocity obstacles for a preferred velocity (evading): along the robot's path in a fleet without
// reservations, else to stand and evade.
//
// Time runs in control periods. The velocity is constant during a period. It was chosen one period earlier,
// so that all peers could receive it (promise.h). If no velocity is chosen in time, the body brakes on a line
// that the previous choice has shown to be free.
//
// A differential robot (kinematics.h) chooses among fewer velocities: all else is the same.
//
// Metres in the map frame, seconds of fleet time, metres per second, radians.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "coppice/motion/kinematics.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "motion/body/braking_line.h"
#include "motion/body/promise.h"

namespace coppice {

class Driver {
 public:
  /// Seconds for which a choice keeps clear of the other robots, where it can.
  static constexpr double horizon = 2;

  /// The robot stands at `start` at fleet time `time`.
  Driver(const Point2& start, double time, double radius, const Limits& limits, double period, double yaw = 0)
      : position_(start), time_(time), radius_(radius), limits_(limits), period_(period), yaw_(yaw) {}

  /// Continues the motion to which another driver had committed itself.
  Driver(const Promise& promise, double radius, const Limits& limits, double period);

  /// Passes one period: executes the velocity that was chosen. The next velocity is that of braking, unless
  /// another one is chosen.
  void advance();

  /// Chooses the twist of the period after the current one, from the decision time on.
  void take(const Twist& next) { next_ = next; }

  // What the robot may choose. A robot that is bound to stand brakes, whatever it wants.

  /// To brake, as if nothing was chosen.
  Twist braking() const { return braked(twist_, limits_, period_); }

  /// The safe velocity nearest to the one that reciprocal velocity obstacles propose for `preferred`.
  Twist evading(const Point2& preferred, std::span<const Neighbour> neighbours,
                const ClearanceField& field) const;

  /// `wanted`, but no faster than a differential robot may drive while it turns there from its heading: it
  /// strays by `stray` metres at most meanwhile.
  Point2 slow_to_turn(const Point2& wanted, double stray) const;

  /// Whether a robot may take a twist from decision_position() on, for one period, and then brake.
  using Allowed = std::function<bool(const Twist&)>;

  struct Followed {
    Twist next;
    /// False: the robot can take no velocity towards `wanted`, or a low one, because of an obstacle, of a
    /// robot that stands, or of what is allowed.
    bool is_led = true;
  };
  /// Along a way that a plan has cleared: towards `wanted`, or beside it, as fast as is safe and allowed,
  /// without reciprocal avoidance.
  Followed following(
      const Point2& wanted, std::span<const Neighbour> neighbours, const ClearanceField& field,
      const Allowed& allowed = [](const Twist&) { return true; }) const;

  /// For a robot that overlaps an obstacle a little: straight towards `to`, so that its clearance only grows
  /// (planning/geometry/way_out.h). It keeps clear of other robots as always. None: another robot, or the
  /// obstacle, is in the way.
  std::optional<Twist> driving_out(const Point2& to, std::span<const Neighbour> neighbours,
                                   const ClearanceField& field) const;

  /// A differential robot that stands turns on the spot, towards a yaw.
  Twist facing(double yaw) const;

  /// Whether another robot alone keeps this one from driving towards `wanted` as fast as that.
  bool is_blocked_by(const Neighbour& other, const Point2& wanted) const;

  /// If the robot stands, binds it to stand at least until the time `until`.
  void stay(double until);
  /// Whether the robot is bound to stand for more than `periods` periods from now on.
  bool bound_to_stand(int periods = 1) const { return time_ + periods * period_ + rounding < stays_until_; }

  /// The motion that the other robots may rely on.
  Promise promise() const;

  double time() const { return time_; }
  double period() const { return period_; }
  double radius() const { return radius_; }
  const Limits& limits() const { return limits_; }
  const Point2& position() const { return position_; }  ///< at time()
  double yaw() const { return yaw_; }                   ///< at time(); of a differential robot
  double angular_velocity() const {
    return twist_.angular_velocity;
  }  ///< radians a second, from time() on, for one period
  const Point2& velocity() const { return twist_.velocity; }  ///< from time() on, for one period
  Point2 decision_position() const { return position_ + period_ * twist_.velocity; }  ///< one period later
  bool stands() const { return twist_.velocity.isZero(0) && next_.velocity.isZero(0); }
  /// A differential robot turns on the spot, or will.
  bool turns_on_the_spot() const {
    return stands() && (twist_.angular_velocity != 0 || next_.angular_velocity != 0);
  }

 private:
  static constexpr double rounding = 1e-6;  ///< tolerance of times, seconds

  Point2 proposal(const Point2& preferred, std::span<const Neighbour> neighbours,
                  const ClearanceField& field) const;
  bool safe(const Twist& twist, std::span<const Neighbour> neighbours, const ClearanceField& field,
            std::size_t& suspect) const;
  bool leads_out(const Twist& twist, const ClearanceField& field) const;
  Twist nearest_to(const Point2& wanted) const;
  double decision_yaw() const {
    return wrapped(yaw_ + period_ * twist_.angular_velocity);
  }  ///< one period later
  std::vector<Twist> around_present() const;

  Point2 position_;
  double time_;
  double radius_;
  Limits limits_;
  double period_;
  double yaw_;
  Twist twist_{};
  Twist next_{};
  double stays_until_ = 0;
};

}  // namespace coppice
