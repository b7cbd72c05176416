// A robot's body and the control step that drives it: reciprocal velocity obstacles propose, promises
// dispose.
//
// Time runs in periods. During each the velocity is constant; it was chosen one period before, so that
// everybody could hear of it (promise.h). If nothing is chosen in time the body brakes in a straight line,
// which the choice before has shown to be free.
//
// Metres in the map frame, seconds of fleet time, metres per second.
#pragma once

#include <span>

#include "motion/kinematics.h"
#include "motion/promise.h"
#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

class Driver {
 public:
  /// Seconds that a choice keeps clear of the other robots, where it can.
  static constexpr double horizon = 2;

  /// Stands at `start`, at `time`.
  Driver(const Point2& start, double time, double radius, const Limits& limits, double period)
      : position_(start), time_(time), radius_(radius), limits_(limits), period_(period) {}

  /// Goes on as another one had committed itself.
  Driver(const Commitment& commitment, double radius, const Limits& limits, double period);

  /// One period passes: what was chosen is executed, and braking is what comes next unless something is
  /// chosen.
  void advance();

  /// Chooses the velocity of the period after the current one: the safe one that is nearest to what
  /// reciprocal velocity obstacles make of `preferred`.
  void choose(const Point2& preferred, std::span<const Neighbour> neighbours, const ClearanceField& field);

  /// The same along a way that a joint plan has cleared: towards `wanted`, as fast as is safe, with no
  /// avoidance of its own. False if what stands is in the way at any speed.
  bool follow(const Point2& wanted, std::span<const Neighbour> neighbours, const ClearanceField& field);

  /// If it stands: binds it to stand until the time `until` at least.
  void stay(double until);
  /// The next choice is for a period in which it is bound to stand.
  bool bound_to_stand(int periods = 1) const { return time_ + periods * period_ + rounding < stays_until_; }

  /// What the others may count on.
  Commitment commitment() const;

  double time() const { return time_; }
  double period() const { return period_; }
  double radius() const { return radius_; }
  const Limits& limits() const { return limits_; }
  const Point2& position() const { return position_; }  ///< at time()
  const Point2& velocity() const { return velocity_; }  ///< from time() on, for one period
  bool stands() const { return velocity_.isZero(0) && next_velocity_.isZero(0); }

 private:
  static constexpr double rounding = 1e-6;  ///< of times, seconds

  Point2 proposal(const Point2& preferred, std::span<const Neighbour> neighbours,
                  const ClearanceField& field) const;
  bool safe(const Point2& velocity, std::span<const Neighbour> neighbours, const ClearanceField& field,
            std::size_t& suspect) const;
  Point2 turn_position() const { return position_ + period_ * velocity_; }

  Point2 position_;
  double time_;
  double radius_;
  Limits limits_;
  double period_;
  Point2 velocity_ = Point2::Zero();
  Point2 next_velocity_ = Point2::Zero();
  double stays_until_ = 0;
};

}  // namespace coppice
