// Tests that each violation of an invariant is found.
#include "simulation/invariants.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

Scenario open_ground() {
  Scenario scenario;
  scenario.map = {.width = 100, .height = 100, .blocked = std::vector<std::uint8_t>(10000, 0)};
  scenario.robots = {{"a", {20, 20}, {80, 20}, 5, 20, 40, 1}, {"b", {20, 60}, {80, 60}, 5, 20, 40, 1}};
  return scenario;
}

/// The track of a robot that drives to the right at 2 m/s, with a point each 0.05 s.
NamedTrack straight(const char* robot, const Point2& from, int periods) {
  NamedTrack named{robot, {.radius = 5, .points = {}}};
  for (int k = 0; k < periods; ++k) {
    named.track.points.push_back(
        {0.05 * k, from + Point2(0.1 * std::max(0, k - 1), 0), k > 0 ? Point2(2, 0) : Point2(0, 0)});
  }
  return named;
}

std::string first_broken(const std::vector<NamedTrack>& tracks) {
  const auto broken = broken_invariants(open_ground(), tracks, 0.05);
  return broken.empty() ? "" : broken.front();
}

TEST(Invariants, AGoodRunBreaksNoInvariant) {
  EXPECT_EQ(first_broken({straight("a", {20, 20}, 50), straight("b", {20, 60}, 50)}), "");
}

TEST(Invariants, EachBrokenInvariantIsFound) {
  const NamedTrack good = straight("b", {20, 60}, 50);
  EXPECT_EQ(first_broken({straight("a", {21, 20}, 50), good}), "a did not begin at its start");
  NamedTrack jumps = straight("a", {20, 20}, 50);
  jumps.track.points[7].position.y() += 0.01;
  EXPECT_EQ(first_broken({jumps, good}), "a jumped at 0.35 s");
  NamedTrack races = straight("a", {20, 20}, 50);
  races.track.points.back().velocity.x() = 21;
  EXPECT_EQ(first_broken({races, good}), "a drove 21.000 m/s at 2.45 s");
  NamedTrack bolts = straight("a", {20, 20}, 50);
  bolts.track.points.back().velocity.x() = 4.5;
  EXPECT_EQ(first_broken({bolts, good}), "a changed its speed too fast at 2.45 s");
  NamedTrack gap = straight("a", {20, 20}, 50);
  gap.track.points.erase(gap.track.points.begin() + 9);
  EXPECT_EQ(first_broken({gap, good}), "a has a gap in its record before 0.50 s");

  Scenario turning = open_ground();
  turning.robots[0].max_angular_speed = 1;
  turning.robots[0].max_angular_acceleration = 2;
  const auto broken_by = [&](int point, double yaw, double angular_velocity) {
    NamedTrack turns = straight("a", {20, 20}, 50);
    turns.track.points[point].yaw = yaw;
    turns.track.points[point].angular_velocity = angular_velocity;
    const auto broken = broken_invariants(turning, {turns, good}, 0.05);
    return broken.empty() ? "" : broken.front();
  };
  EXPECT_EQ(broken_by(7, 0, 0), "");
  EXPECT_EQ(broken_by(7, 0, 1.5), "a turned with 1.500 rad/s at 0.35 s");
  EXPECT_EQ(broken_by(7, 0, 0.5), "a changed its turning too fast at 0.35 s");
  EXPECT_EQ(broken_by(7, 0.3, 0), "a jumped to another yaw at 0.35 s");
  EXPECT_EQ(broken_by(49, 0, 0.09), "a drove sideways or backward at 2.45 s");

  Scenario scenario = open_ground();
  scenario.robots[1].start = {20, 29};
  const auto touched =
      broken_invariants(scenario, {straight("a", {20, 20}, 9), straight("b", {20, 29}, 9)}, 0.05);
  ASSERT_EQ(touched.size(), 1u);
  EXPECT_NE(touched[0].find("robots touched: least separation -1.0"), std::string::npos) << touched[0];
  scenario = open_ground();
  scenario.map.blocked[24 * 100 + 24] = 1;
  const auto wall = broken_invariants(scenario, {straight("a", {20, 20}, 30), good}, 0.05);
  ASSERT_EQ(wall.size(), 1u);
  EXPECT_NE(wall[0].find("obstacles were touched"), std::string::npos) << wall[0];
}

}  // namespace
}  // namespace coppice
