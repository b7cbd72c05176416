// Tests of gates on the way of a robot.
#include "motion/trajectory/precedence.h"

#include <limits>

#include <gtest/gtest.h>

#include "motion/body/way_follower.h"

namespace coppice {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

TEST(Precedence, ALegEndsWhereTheWayTurnsByARightAngleOrMore) {
  const Path way{{0, 0}, {10, 0}, {20, 5}, {20, 20}, {5, 20}, {9, 20}};
  const std::vector<Path> legs = legs_of(way);
  ASSERT_EQ(legs.size(), 3u);
  EXPECT_EQ(legs[0], Path({{0, 0}, {10, 0}, {20, 5}, {20, 20}}));
  EXPECT_EQ(legs[1], Path({{20, 20}, {5, 20}}));
  EXPECT_EQ(legs[2], Path({{5, 20}, {9, 20}}));
  EXPECT_TRUE(legs_of({}).empty());
  EXPECT_TRUE(legs_of({{1, 1}}).empty());
}

TEST(Precedence, AGateIsClosedUntilTheOtherRobotHasComeFarEnough) {
  Gates gates({{10, 50}, {30, 80}});
  EXPECT_EQ(gates.open(0, 0.1, 0), 10);
  EXPECT_EQ(gates.open_if(0, 0.1, 60), 30) << "a look ahead passes no gate";
  EXPECT_EQ(gates.open(0, 0.1, 49), 10);
  EXPECT_EQ(gates.open(0, 0.1, 49.95), 30);
  EXPECT_EQ(gates.left().size(), 1u);
  EXPECT_EQ(gates.open(29, 0.1, 100), never);
  EXPECT_TRUE(gates.all_open());
}

TEST(Precedence, AGateBehindTheRobotDoesNotCount) {
  Gates gates({{10, 50}});
  EXPECT_EQ(gates.open(10.2, 0.1, 0), never);
}

// The second robot crosses the way of the first one once that is through.
TEST(Precedence, ARobotDrivesUpToAClosedGate) {
  WayFollower follower(legs_of({{50, -40}, {50, 40}}), 5, 0.25);
  Gates gates({{28, 62}});
  Point2 position(50, -40);
  const auto drive = [&](double first) {
    for (int k = 0; k < 200; ++k) {
      const double open = gates.open(follower.progress(), gate_slack_radii * 5, first);
      follower.come_to(position);
      position += 0.05 * follower.preferred_velocity(position, {20, 40}, 0.05, open);
    }
  };
  drive(40);
  EXPECT_NEAR(follower.progress(), 28, 0.05);
  drive(62);
  follower.come_to(position);
  EXPECT_TRUE(follower.finished());
}

}  // namespace
}  // namespace coppice
