// Tests of robots that carry out trajectories at very different speeds and stop now and then. Each heeds only
// the order in which the trajectories pass. So the robots never touch, and all reach the end.
#include "motion/trajectory/reserved_order.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "motion/lattice/safe_interval_search.h"
#include "motion/trajectory/polyline.h"
#include "planning/geometry/voronoi_roadmap.h"
#include "tests/unit/motion/plans.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::radius;
constexpr double speed = 20;

struct Reserved {
  Trajectory trajectory;
  Polyline way;
  std::vector<Gates> before{};  ///< by robot
  double progress = 0;
  double pace = 1;
  int pause = 0;
};

/// The robots plan one after the other, around those that have planned.
std::vector<Reserved> plan(const ClearanceField& field, std::span<const StartAndGoal> tasks) {
  Lattice lattice(field, (1 + reserved_stray_radii) * radius, radius);
  const VoronoiRoadmap roadmap(field);
  std::vector<Reserved> robots;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    SpaceTime taken(field.bounds(), radius);
    for (const Reserved& other : robots) taken.add(other.trajectory, radius);
    for (std::size_t k = i + 1; k < tasks.size(); ++k)
      taken.add_standing(tasks[k].start, radius, SpaceTime::forever);
    const auto path = roadmap.way(tasks[i].start, tasks[i].goal, radius);
    if (!path) continue;
    const auto found = SafeIntervalSearch(field, lattice, radius, *path).search(taken, 0, {speed, 40});
    if (found) robots.push_back({*found, Polyline(path_of(*found))});
  }
  for (Reserved& own : robots) {
    for (const Reserved& other : robots) {
      const bool self = &own == &other;
      Order order = self ? Order{} : order_of(own.trajectory, radius, other.trajectory, radius, 0);
      EXPECT_TRUE(order.too_close.empty());
      own.before.emplace_back(std::move(order.gates));
    }
  }
  return robots;
}

/// Drives on by one step, up to the first closed gate.
void drive(Reserved& own, const std::vector<Reserved>& robots, Random& random) {
  if (own.pause == 0 && random.uniform() < 0.005) own.pause = 100;
  if (own.pause > 0 && --own.pause > 0) return;
  double end = std::min(own.way.length(), own.progress + own.pace);
  for (std::size_t k = 0; k < robots.size(); ++k)
    end = std::min(end, own.before[k].open(own.progress, 0, robots[k].progress));
  own.progress = std::max(own.progress, end);
}

TEST(ReservedOrder, RobotsThatHeedItNeverTouchAndAllArriveAtAnySpeed) {
  std::size_t driven = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    const ClearanceField field(seed % 2 == 0 ? test::open_map(160, 160)
                                             : generate_map(MapKind::room, 200, 200, random));
    const auto tasks = random_tasks(field, 14, radius, 0.2, random);
    std::vector<Reserved> robots = plan(field, tasks);
    driven += robots.size();
    for (Reserved& robot : robots) robot.pace = random.uniform(0.05, 1.5);
    const auto there = [](const Reserved& r) { return r.progress >= r.way.length() - 1e-9; };
    for (int step = 0; step < 40'000 && !std::ranges::all_of(robots, there); ++step) {
      for (Reserved& robot : robots) drive(robot, robots, random);
      for (std::size_t a = 0; a < robots.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          const double distance =
              (robots[a].way.at(robots[a].progress) - robots[b].way.at(robots[b].progress)).norm();
          ASSERT_GE(distance, 2 * radius) << "seed " << seed << " step " << step << ": " << a << " and " << b;
        }
      }
    }
    EXPECT_TRUE(std::ranges::all_of(robots, there)) << "seed " << seed;
  }
  EXPECT_GT(driven, 80U);
}

TEST(ReservedOrder, RobotsThatPlannedWithoutEachOtherMayNotKeepApart) {
  const Trajectory own{{0, {0, 50}}, {5, {100, 50}}};
  const Trajectory crossing{{0, {50, 0}}, {5, {50, 100}}};
  EXPECT_GT(beyond(order_of(own, radius, crossing, radius, 0).too_close), 40);
  const Order later = order_of(own, radius, crossing, radius, -3);
  EXPECT_TRUE(later.too_close.empty());  // the other passes first by far
  ASSERT_FALSE(later.gates.empty());
  EXPECT_LT(later.gates.front().at, 50 - 2 * radius + 1);
  EXPECT_GT(later.gates.back().needed, 50 + 2 * radius);
  EXPECT_TRUE(order_of(own, radius, crossing, radius, 3).gates.empty());
}

TEST(ReservedOrder, RobotsThatBeganTooCloseKeepApartOnlyLater) {
  const Trajectory own{{0, {0, 50}}, {5, {100, 50}}};
  const Trajectory standing{{0, {0, 60.1}}, {2, {0, 60.1}}, {5, {0, 100}}};
  const double too_close_up_to = beyond(order_of(own, radius, standing, radius, 0).too_close);
  EXPECT_GT(too_close_up_to, 0);
  EXPECT_LT(too_close_up_to, 10);
}

TEST(ReservedOrder, RobotsWhoseGoalsAreTooCloseKeepApartUntilBothAreNearTheirGoals) {
  const Trajectory own{{0, {0, 50}}, {5, {100, 50}}};
  const Trajectory other{{0, {100, 160}}, {5, {100, 60.1}}};
  const Order order = order_of(own, radius, other, radius, 0);
  ASSERT_EQ(order.too_close.size(), 1u);
  EXPECT_GT(order.too_close.front().begin, 90);
  EXPECT_LT(order.too_close.front().begin, 100);
  EXPECT_EQ(order.too_close.front().end, 100);
}

}  // namespace
}  // namespace coppice
