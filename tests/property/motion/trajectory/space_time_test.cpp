// Tests of the times at which a disc may stand or depart among moving discs, against sampled motion.
#include "motion/trajectory/space_time.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"
#include "tests/unit/motion/trajectories.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::position_at;

using test::radius;
constexpr double other_radius = 4;
const Box<2> bounds{{0, 0}, {100, 100}};

Point2 random_point(Random& random) {
  return {random.uniform(10, 90), random.uniform(10, 90)};
}

Trajectory random_trajectory(Random& random) {
  Trajectory trajectory{{random.uniform(0, 3), random_point(random)}};
  for (int k = 0; k < 3; ++k) {
    const TimedPoint& last = trajectory.back();
    const bool waits = random.index(3) == 0;
    const Point2 next = waits ? last.position : random_point(random);
    trajectory.push_back({last.time + random.uniform(0.5, 4), next});
  }
  return trajectory;
}

bool holds(const std::vector<Interval>& intervals, double time) {
  return std::ranges::any_of(intervals, [&](const Interval& i) { return i.begin < time && time < i.end; });
}

/// Metres by which the other comes closer than kept_apart() to a disc that departs at `departure`, with room.
double intrusion(const Trajectory& other, const Point2& a, const Point2& b, double duration,
                 double departure) {
  double least = 1e9;
  constexpr int samples = 200;
  for (int k = 0; k <= samples; ++k) {
    const double y = duration * k / samples;
    const Point2 own = a + (b - a) * (k / static_cast<double>(samples));
    for (int shift = -5; shift <= 5; ++shift) {
      const double then = departure + y + room_in_time * shift / 5;
      least = std::min(least, (position_at(other, then) - own).norm());
    }
  }
  return kept_apart(radius, other_radius) - least;
}

TEST(SpaceTime, TheFirstDepartureIsFreeAndEachOneBeforeItIsBlocked) {
  Random random(1);
  int delayed = 0;
  int never = 0;
  for (int trial = 0; trial < 300; ++trial) {
    SpaceTime taken(bounds, radius);
    std::vector<Trajectory> others;
    for (int k = 0; k < 3; ++k) {
      others.push_back(random_trajectory(random));
      taken.add(others.back(), other_radius);
    }
    const Point2 a = random_point(random);
    const Point2 b = random_point(random);
    const double duration = random.uniform(0.5, 4);
    const auto too_close = [&](double departure) {
      double most = -1e9;
      for (const Trajectory& other : others)
        most = std::max(most, intrusion(other, a, b, duration, departure));
      return most;
    };
    const double from = random.uniform(0, 10);
    const double first = taken.first_departure(a, b, duration, from);
    ASSERT_GE(first, from);
    if (first < SpaceTime::forever) {
      EXPECT_LE(too_close(first), 1e-6) << "trial " << trial << " at " << first;
    }
    constexpr double sampling = 0.6;  // metres
    const double last = std::min(first, 30.0);
    for (int k = 0; k < 10 && first > from; ++k) {
      const double departure = from + (last - from) * k / 10;
      EXPECT_GT(too_close(departure), -sampling) << "trial " << trial << " at " << departure;
    }
    delayed += first > from ? 1 : 0;
    never += first == SpaceTime::forever ? 1 : 0;
  }
  EXPECT_GT(delayed, 100);
  EXPECT_GT(delayed - never, 30);
  EXPECT_GT(never, 30);
}

TEST(SpaceTime, APointIsBlockedIfAndOnlyIfTheOtherComesTooClose) {
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const Trajectory other = random_trajectory(random);
    SpaceTime taken(bounds, radius);
    taken.add(other, other_radius);
    const Point2 p = random_point(random);
    std::vector<Interval> times;
    taken.blocked_at(p, times);
    for (int k = 0; k < 10; ++k) {
      const double time = random.uniform(0, 15);
      const double too_close = intrusion(other, p, p, 1e-6, time);
      const bool decides = too_close > 1e-6 || too_close < -0.6;
      EXPECT_TRUE(!decides || holds(times, time) == (too_close > 0)) << "trial " << trial << " at " << time;
    }
  }
}

TEST(SpaceTime, ADiscThatStartsTooCloseMayLeaveButNotComeCloser) {
  SpaceTime taken(bounds, radius);
  taken.add_standing({50, 50}, radius, SpaceTime::forever);
  const Point2 start(60.2, 50);
  taken.start_at(start, 0);
  EXPECT_EQ(taken.first_departure(start, {90, 50}, 2, 0), 0);
  EXPECT_EQ(taken.first_departure(start, {58, 50}, 1, 0), SpaceTime::forever);
}

}  // namespace
}  // namespace coppice
