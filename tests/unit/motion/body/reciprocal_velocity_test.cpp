// Tests of half planes against the geometry that defines them, and of the linear programme against sampled
// velocities.
#include "coppice/motion/reciprocal_velocity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"

namespace coppice {
namespace {

constexpr double horizon = 2;
constexpr double time_step = 0.05;

Point2 random_in_disc(double radius, Random& random) {
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  return radius * std::sqrt(random.uniform()) * Point2(std::cos(angle), std::sin(angle));
}

Point2 inward(const HalfPlane& plane) {
  return {-plane.direction.y(), plane.direction.x()};
}

/// The least distance of the two centres if both discs keep their velocities for `seconds`.
double least_distance(const MovingDisc& a, const MovingDisc& b, double seconds) {
  const Point2 offset = b.position - a.position;
  const Point2 closing = b.velocity - a.velocity;
  const double squared = closing.squaredNorm();
  const double t = squared > 0 ? std::clamp(-offset.dot(closing) / squared, 0.0, seconds) : 0.0;
  return (offset + t * closing).norm();
}

double worst(std::span<const HalfPlane> planes, const Point2& v) {
  double most = -std::numeric_limits<double>::infinity();
  for (const HalfPlane& plane : planes) most = std::max(most, violation(plane, v));
  return most;
}

TEST(OrcaHalfPlane, ADistantDiscAllowsTheCurrentVelocity) {
  const MovingDisc self{{0, 0}, {10, 0}, 5};
  for (const MovingDisc& other : {MovingDisc{{0, 40}, {10, 0}, 5}, MovingDisc{{30, 0}, {20, 0}, 5},
                                  MovingDisc{{-30, 0}, {-5, 0}, 5}, MovingDisc{{400, 0}, {-10, 0}, 5}}) {
    EXPECT_LT(violation(orca_half_plane(self, other, horizon, time_step), self.velocity), 0);
  }
}

// The gap is 30 m and the horizon 2 s: the discs may approach at 15 m/s, and do at 16 m/s.
TEST(OrcaHalfPlane, HeadOnTheSmallestChangeIsToSlowDown) {
  const MovingDisc self{{0, 0}, {6, 0}, 5};
  const MovingDisc other{{40, 0}, {-10, 0}, 5};
  const HalfPlane half = orca_half_plane(self, other, horizon, time_step);
  EXPECT_NEAR((inward(half) - Point2(-1, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR(violation(half, {5.5, 0}), 0, 1e-12);
  const HalfPlane all = orca_half_plane(self, other, horizon, time_step, 1.0);
  EXPECT_NEAR(violation(all, {5, 0}), 0, 1e-12);
}

// At 40 m/s, a turn is the smaller change: over the right leg, whose sine is 10 m of 40 m.
TEST(OrcaHalfPlane, HeadOnAtSpeedTheSmallestChangeIsToTurnRight) {
  const MovingDisc self{{0, 0}, {20, 0}, 5};
  const MovingDisc other{{40, 0}, {-20, 0}, 5};
  const HalfPlane plane = orca_half_plane(self, other, horizon, time_step);
  EXPECT_NEAR((inward(plane) - Point2(-0.25, -std::sqrt(1 - 0.0625))).norm(), 0, 1e-12);
  EXPECT_NEAR(violation(plane, self.velocity), 5, 1e-12);  // half of 40 / 4
}

// All velocities within both half planes keep the discs apart within the horizon.
TEST(OrcaHalfPlane, DiscsWithinTheirHalfPlanesDoNotTouch) {
  Random random(1);
  int constrained = 0;
  for (int n = 0; n < 20000; ++n) {
    const MovingDisc a{random_in_disc(40, random), random_in_disc(20, random), random.uniform(0.1, 6)};
    const MovingDisc b{random_in_disc(40, random), random_in_disc(20, random), random.uniform(0.1, 6)};
    if ((a.position - b.position).norm() <= a.radius + b.radius) continue;
    const double share = random.uniform();
    const HalfPlane for_a = orca_half_plane(a, b, horizon, time_step, share);
    const HalfPlane for_b = orca_half_plane(b, a, horizon, time_step, 1 - share);
    const MovingDisc next_a{a.position, random_in_disc(20, random), a.radius};
    const MovingDisc next_b{b.position, random_in_disc(20, random), b.radius};
    if (violation(for_a, next_a.velocity) > 0 || violation(for_b, next_b.velocity) > 0) continue;
    ++constrained;
    ASSERT_GE(least_distance(next_a, next_b, horizon), a.radius + b.radius - 1e-9);
  }
  EXPECT_GT(constrained, 3000);
}

// The change is the smallest that suffices: if one disc changes and the other does not, they just touch.
TEST(OrcaHalfPlane, TheHalfPlaneIsAsWideAsTheObstacleAllows) {
  Random random(2);
  int avoided = 0;
  for (int n = 0; n < 20000; ++n) {
    const MovingDisc a{random_in_disc(40, random), random_in_disc(20, random), random.uniform(0.1, 6)};
    const MovingDisc b{random_in_disc(40, random), random_in_disc(20, random), random.uniform(0.1, 6)};
    const double radii = a.radius + b.radius;
    if ((a.position - b.position).norm() <= radii || least_distance(a, b, horizon) >= radii) continue;
    ++avoided;
    const HalfPlane plane = orca_half_plane(a, b, horizon, time_step, 1.0);
    ASSERT_NEAR(least_distance({a.position, plane.point, a.radius}, b, horizon), radii, 1e-6);
    // No velocity nearer than the point is outside of the obstacle.
    const double change = (plane.point - a.velocity).norm();
    for (int k = 0; k < 20; ++k) {
      const Point2 nearer = a.velocity + random_in_disc(0.999 * change, random);
      ASSERT_LT(least_distance({a.position, nearer, a.radius}, b, horizon), radii);
    }
  }
  EXPECT_GT(avoided, 500);
}

TEST(OrcaHalfPlane, OverlappingDiscsSeparateWithinATimeStep) {
  const MovingDisc self{{0, 0}, {0, 0}, 5};
  const MovingDisc other{{9, 0}, {0, 0}, 5};
  const HalfPlane plane = orca_half_plane(self, other, horizon, time_step);
  EXPECT_NEAR((inward(plane) - Point2(-1, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR(violation(plane, {-0.5 / time_step, 0}), 0, 1e-9);  // 1 m, of which each takes half
}

TEST(OrcaHalfPlane, CoincidentDiscsGiveUsablePlanes) {
  const MovingDisc still{{3, 4}, {0, 0}, 5};
  const MovingDisc moving{{3, 4}, {1, 2}, 5};
  for (const auto& [a, b] : {std::pair{still, still}, std::pair{still, moving}, std::pair{moving, still}}) {
    const HalfPlane plane = orca_half_plane(a, b, horizon, time_step);
    EXPECT_TRUE(plane.point.allFinite());
    EXPECT_NEAR(plane.direction.norm(), 1, 1e-12);
  }
  // Different velocities tell the discs apart: they leave in opposite directions.
  EXPECT_NEAR((inward(orca_half_plane(still, moving, horizon, time_step)) +
               inward(orca_half_plane(moving, still, horizon, time_step)))
                  .norm(),
              0, 1e-12);
  const MovingDisc point{{0, 0}, {0, 0}, 0};
  EXPECT_TRUE(orca_half_plane(point, point, horizon, time_step).point.allFinite());
}

TEST(SafeVelocity, TwoDiscsHeadOnGiveWayToTheSameSide) {
  const MovingDisc left{{0, 0}, {20, 0}, 5};
  const MovingDisc right{{60, 0}, {-20, 0}, 5};
  const HalfPlane for_left = orca_half_plane(left, right, horizon, time_step);
  const HalfPlane for_right = orca_half_plane(right, left, horizon, time_step);
  const Point2 a = safe_velocity({20, 0}, 20, {}, {&for_left, 1});
  const Point2 b = safe_velocity({-20, 0}, 20, {}, {&for_right, 1});
  EXPECT_LT(a.y(), -0.5);
  EXPECT_NEAR((a + b).norm(), 0, 1e-9);
  EXPECT_GE(least_distance({left.position, a, 5}, {right.position, b, 5}, horizon), 10 - 1e-9);
}

TEST(SafeVelocity, ThePreferredVelocityIsKeptWithinTheLimit) {
  EXPECT_EQ(safe_velocity({3, 4}, 10, {}, {}), Point2(3, 4));
  EXPECT_NEAR((safe_velocity({30, 40}, 10, {}, {}) - Point2(6, 8)).norm(), 0, 1e-12);
  EXPECT_EQ(safe_velocity({3, 4}, 0, {}, {}), Point2(0, 0));
  EXPECT_EQ(safe_velocity({0, 0}, 10, {}, {}), Point2(0, 0));
}

TEST(SafeVelocity, ParallelAndRepeatedPlanesAreHandled) {
  const HalfPlane up_to_2{{2, 7}, {0, 1}};  // vx <= 2
  const HalfPlane up_to_3{{3, -1}, {0, 1}};
  const HalfPlane from_1{{1, 0}, {0, -1}};  // vx >= 1
  const HalfPlane from_4{{4, 0}, {0, -1}};
  const auto best = [](std::vector<HalfPlane> soft) { return safe_velocity({5, 1}, 10, {}, soft); };
  EXPECT_NEAR((best({up_to_2, up_to_2, up_to_3}) - Point2(2, 1)).norm(), 0, 1e-9);
  EXPECT_NEAR((best({up_to_3, from_1, up_to_2}) - Point2(2, 1)).norm(), 0, 1e-9);
  EXPECT_NEAR(best({up_to_2, from_4}).x(), 3, 1e-9);  // half way between the two planes
  EXPECT_NEAR(best({up_to_3, up_to_2, from_4}).x(), 3, 1e-9);
}

TEST(SafeVelocity, ADiscBetweenObstaclesOnAllSidesStands) {
  std::vector<HalfPlane> hard;
  for (int k = 0; k < 7; ++k) {
    const double angle = 2 * std::numbers::pi * k / 7 + 0.1;
    hard.push_back({Point2::Zero(), Point2(std::cos(angle), std::sin(angle))});
  }
  const std::vector<HalfPlane> soft{{{5, 0}, {0, -1}}};  // requires vx >= 5
  EXPECT_NEAR(safe_velocity({7, 3}, 20, hard, {}).norm(), 0, 1e-6);
  EXPECT_NEAR(safe_velocity({7, 3}, 20, hard, soft).norm(), 0, 1e-6);
}

std::vector<HalfPlane> random_planes(std::size_t count, double nearest, double furthest, Random& random) {
  std::vector<HalfPlane> planes;
  for (std::size_t n = 0; n < count; ++n) {
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const Point2 normal(std::cos(angle), std::sin(angle));
    planes.push_back({-random.uniform(nearest, furthest) * normal, {normal.y(), -normal.x()}});
  }
  return planes;
}

// No sampled velocity is nearer to the preferred one. If the soft planes are infeasible, none violates them
// less.
TEST(SafeVelocity, NoSampledVelocityIsBetter) {
  constexpr double max_speed = 10;
  Random random(3);
  int feasible = 0;
  int infeasible = 0;
  for (int n = 0; n < 2000; ++n) {
    const auto hard = random_planes(random.index(5), 0, 6, random);
    const auto soft = random_planes(random.index(8), -3, 6, random);
    const Point2 preferred = random_in_disc(15, random);
    const Point2 v = safe_velocity(preferred, max_speed, hard, soft);
    ASSERT_LE(v.norm(), max_speed + 1e-6);
    ASSERT_LE(worst(hard, v), 1e-6);
    const double violated = worst(soft, v);
    const bool holds = violated <= 1e-6;
    ++(holds ? feasible : infeasible);
    for (int k = 0; k < 2000; ++k) {
      // Half of the samples are near the answer, where a better one would be hardest to see.
      const Point2 sample =
          k % 2 == 0 ? random_in_disc(max_speed, random) : Point2(v + random_in_disc(0.1, random));
      if (sample.norm() > max_speed || worst(hard, sample) > 0) continue;
      if (holds) {
        if (worst(soft, sample) > 0) continue;
        ASSERT_GE((sample - preferred).norm(), (v - preferred).norm() - 1e-6);
      } else {
        ASSERT_GE(worst(soft, sample), violated - 1e-6);
      }
    }
  }
  EXPECT_GT(feasible, 500);
  EXPECT_GT(infeasible, 300);
}

OccupancyMap open_map(int width, int height) {
  OccupancyMap map;
  map.width = width;
  map.height = height;
  map.blocked.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  return map;
}

std::vector<HalfPlane> planes_at(const ClearanceField& field, const Point2& p, double radius, double reach) {
  std::vector<HalfPlane> planes;
  obstacle_half_planes(field, p, radius, reach, 1.0, planes);
  return planes;
}

constexpr std::size_t wall_row = 6000;  // row 60 of a map that is 100 cells wide

TEST(ObstacleHalfPlanes, OpenSpaceGivesNoPlanes) {
  EXPECT_TRUE(planes_at(ClearanceField(open_map(100, 100)), {50, 50}, 5, 20).empty());
}

TEST(ObstacleHalfPlanes, AWallAndEachSideOfTheMapGiveOnePlane) {
  OccupancyMap map = open_map(100, 100);
  for (std::size_t i = 0; i < 100; ++i) map.blocked[wall_row + i] = 1;
  const ClearanceField field(map);
  const auto wall = planes_at(field, {50, 50}, 5, 20);
  ASSERT_EQ(wall.size(), 1u);
  EXPECT_NEAR((wall[0].point - Point2(0, 5)).norm(), 0, 1e-12);  // 10 m away, less the radius, in 1 s
  EXPECT_NEAR((inward(wall[0]) - Point2(0, -1)).norm(), 0, 1e-12);
  EXPECT_EQ(planes_at(field, {7, 8}, 5, 20).size(), 2u);
}

TEST(ObstacleHalfPlanes, ADiscThatTouchesMayOnlySlideOrLeave) {
  OccupancyMap map = open_map(100, 100);
  for (std::size_t i = 0; i < 100; ++i) map.blocked[wall_row + i] = 1;
  const ClearanceField field(map);
  for (const double y : {55.0, 55.5}) {  // touching, and 0.5 m too near
    const auto planes = planes_at(field, {50, y}, 5, 10);
    EXPECT_LE(worst(planes, {7, 0}), 1e-12);
    EXPECT_LE(worst(planes, {0, -7}), 1e-12);
    EXPECT_LE(worst(planes, {0, 0}), 1e-12);
    EXPECT_GT(worst(planes, {7, 0.1}), 0.05);
  }
}

TEST(ObstacleHalfPlanes, APositionInsideAnObstacleGivesUsablePlanes) {
  OccupancyMap map = open_map(50, 50);
  for (std::size_t j = 20; j < 30; ++j) {
    for (std::size_t i = 20; i < 30; ++i) map.blocked[j * 50 + i] = 1;
  }
  const ClearanceField field(map);
  for (const Point2& p : {Point2(25, 25), Point2(20.5, 25.5), Point2(20, 20), Point2(0, 0)}) {
    for (const HalfPlane& plane : planes_at(field, p, 5, 10)) {
      EXPECT_TRUE(plane.point.allFinite());
      EXPECT_NEAR(plane.direction.norm(), 1, 1e-12);
      EXPECT_LE(violation(plane, {0, 0}), 1e-12);
    }
  }
}

// A velocity within the half planes that is kept for the horizon leads into no obstacle.
TEST(ObstacleHalfPlanes, ThePlanesKeepTheDiscClearForTheHorizon) {
  Random random(4);
  OccupancyMap map = open_map(120, 120);
  map.resolution = 0.5;
  map.origin = Point2(-3, 11);
  for (int n = 0; n < 60; ++n) {
    const std::size_t i = random.index(110);
    const std::size_t j = random.index(110);
    for (std::size_t y = j; y < j + 1 + random.index(10); ++y) {
      for (std::size_t x = i; x < i + 1 + random.index(10); ++x) map.blocked[y * 120 + x] = 1;
    }
  }
  const ClearanceField field(map);
  constexpr double radius = 1.3;
  constexpr double max_speed = 8;
  constexpr double seconds = 0.5;
  std::vector<HalfPlane> planes;
  int tried = 0;
  int held = 0;
  while (tried < 5000) {
    const Point2 p = map.origin + Point2(random.uniform(0, 60), random.uniform(0, 60));
    if (!field.is_free(p, radius)) continue;
    planes.clear();
    obstacle_half_planes(field, p, radius, max_speed * seconds, seconds, planes);
    const Point2 v = random_in_disc(max_speed, random);
    ++tried;
    const Point2 safe = safe_velocity(v, max_speed, planes, {});
    ASSERT_TRUE(field.segment_free(p, p + 0.999999 * seconds * safe, radius - 1e-6));
    held += worst(planes, v) > 0 ? 1 : 0;
  }
  EXPECT_GT(held, 500);
}

}  // namespace
}  // namespace coppice
