// Discs on a circle that swap to the opposite side: the classic trial of reciprocal avoidance. All discs meet
// in the middle, and know only each other's velocities.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/motion/reciprocal_velocity.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::radius;
constexpr double max_speed = 20;
constexpr double time_step = 0.05;
constexpr double horizon = 2;
constexpr double seen_within = 100;  // metres; no disc further away can be reached within the horizon

struct Swap {
  std::vector<MovingDisc> discs;
  std::vector<Point2> goals;
};

Swap circle_of(int count, double circle) {
  Swap swap;
  for (int k = 0; k < count; ++k) {
    // Slightly uneven, so that no two discs meet in perfect symmetry.
    const double angle = 2 * std::numbers::pi * (k + 0.05 * std::sin(7.0 * k)) / count;
    const Point2 place = circle * Point2(std::cos(angle), std::sin(angle));
    swap.discs.push_back({place, Point2::Zero(), radius});
    swap.goals.emplace_back(-place);
  }
  return swap;
}

/// Straight to the goal without passing it, and a little to the right.
Point2 preferred_velocity(const Point2& position, const Point2& goal) {
  const Point2 way = goal - position;
  const double distance = way.norm();
  if (distance == 0) return Point2::Zero();
  const Point2 velocity = way * (std::min(max_speed, distance / time_step) / distance);
  return velocity + 0.02 * Point2(velocity.y(), -velocity.x());
}

void step(Swap& swap) {
  std::vector<Point2> next;
  std::vector<HalfPlane> planes;
  for (std::size_t k = 0; k < swap.discs.size(); ++k) {
    const MovingDisc& self = swap.discs[k];
    planes.clear();
    for (const MovingDisc& other : swap.discs) {
      if (&other == &self || (other.position - self.position).norm() > seen_within) continue;
      planes.push_back(orca_half_plane(self, other, horizon, time_step));
    }
    next.push_back(safe_velocity(preferred_velocity(self.position, swap.goals[k]), max_speed, {}, planes));
  }
  for (std::size_t k = 0; k < swap.discs.size(); ++k) {
    swap.discs[k].velocity = next[k];
    swap.discs[k].position += time_step * next[k];
  }
}

double least_distance(const Swap& swap) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < swap.discs.size(); ++k) {
    for (std::size_t n = 0; n < k; ++n) {
      least = std::min(least, (swap.discs[k].position - swap.discs[n].position).norm());
    }
  }
  return least;
}

bool all_arrived(const Swap& swap) {
  for (std::size_t k = 0; k < swap.discs.size(); ++k) {
    if ((swap.discs[k].position - swap.goals[k]).norm() > 0.5) return false;
  }
  return true;
}

void expect_swap(int count, double circle, double most_seconds) {
  Swap swap = circle_of(count, circle);
  double least = least_distance(swap);
  double seconds = 0;
  for (; seconds < most_seconds && !all_arrived(swap); seconds += time_step) {
    step(swap);
    least = std::min(least, least_distance(swap));
  }
  testing::Test::RecordProperty("seconds", std::to_string(seconds));
  testing::Test::RecordProperty("least_distance", std::to_string(least));
  EXPECT_TRUE(all_arrived(swap)) << "after " << seconds << " s";
  EXPECT_GE(least, 0.9 * 2 * radius);
}

TEST(CircleSwap, TenDiscsArriveAndKeepApart) {
  expect_swap(10, 100, 60);
}
TEST(CircleSwap, FiftyDiscsArriveAndKeepApart) {
  expect_swap(50, 200, 200);
}

}  // namespace
}  // namespace coppice
