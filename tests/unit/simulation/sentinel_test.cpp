// Tests that the sentinel finds each broken lemma, and is silent while all hold. It is fed with plain facts.
#include "simulation/sentinel.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/motion/plans.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

constexpr double max_speed = 20;
using test::radius;
constexpr std::size_t a = 0;
constexpr std::size_t b = 1;

/// Two robots on open ground, which decide by turns in each control period.
class SentinelTest : public testing::Test {
 protected:
  SentinelTest() { stand_at({20, 20}, {20, 60}); }

  void stand_at(const Point2& first, const Point2& second) {
    Scenario scenario{.map = test::open_map(200, 100), .robots = {}};
    scenario.robots.push_back({"a", first, first, radius, max_speed, 2 * max_speed, 1});
    scenario.robots.push_back({"b", second, second, radius, max_speed, 2 * max_speed, 1});
    sentinel.emplace(scenario);
    bodies[a] = Driver(first, 0, radius, {max_speed, 2 * max_speed}, control_period);
    bodies[b] = Driver(second, 0, radius, {max_speed, 2 * max_speed}, control_period);
    look(a);
    look(b);
  }
  double now() const { return bodies[a].time(); }
  static std::string name(std::size_t robot) { return robot == a ? "a" : "b"; }

  void look(std::size_t robot, const std::vector<ReservationId>& left_out = {}) {
    sentinel->look(robot, {bodies[robot], {}, {}, left_out, field}, now());
  }
  void pass_a_period() {
    for (Driver& body : bodies) body.advance();
  }
  /// The robot chooses a velocity, or the next one to it that its limits allow. It sees nobody.
  void decide(std::size_t robot, const Point2& velocity, const std::vector<ReservationId>& left_out = {}) {
    bodies[robot].take(bodies[robot].following(velocity, {}, ground).next);
    look(robot, left_out);
  }
  void drive(std::size_t robot, const Point2& velocity, int periods,
             const std::vector<ReservationId>& left_out = {}) {
    for (int k = 0; k < periods && !sentinel->broken(); ++k) {
      pass_a_period();
      decide(robot, velocity, left_out);
    }
  }
  void say(std::size_t robot, const Promise& promise, std::uint32_t reservation = 0, double progress = 0) {
    sentinel->hear(RobotState{.robot = name(robot),
                              .promise = promise,
                              .radius = radius,
                              .max_speed = max_speed,
                              .max_acceleration = 2 * max_speed,
                              .round = {},
                              .reservation = reservation,
                              .reservation_progress = progress,
                              .waits_for = {},
                              .run = {}},
                   now());
  }
  void reserve(std::size_t robot, std::uint32_t number, const Point2& to) {
    sentinel->hear(ReservationMessage{.robot = name(robot),
                                      .number = number,
                                      .first_number = number,
                                      .radius = radius,
                                      .trajectory = {{0, bodies[robot].position()}, {9, to}},
                                      .run = {}},
                   now());
  }
  /// How the broken lemma begins; empty: all hold.
  std::string broken(std::size_t letters) const { return sentinel->broken().value_or("").substr(0, letters); }

  ClearanceField ground{test::open_map(200, 100)};
  ClearanceField field{test::open_map(200, 100)};  ///< as the sentinel sees it
  std::array<Driver, 2> bodies{Driver(Point2::Zero(), 0, 1, {}, 1), Driver(Point2::Zero(), 0, 1, {}, 1)};
  std::optional<Sentinel> sentinel;
};

TEST_F(SentinelTest, RobotsThatKeepApartBreakNothing) {
  drive(a, {20, 0}, 60);
  drive(a, {-20, 0}, 30);
  EXPECT_EQ(sentinel->broken().value_or(""), "");
  EXPECT_EQ(sentinel->decisions(), 92U) << "those of a, and the first one of each";
}

TEST_F(SentinelTest, ADecisionWhoseLineMeetsThatOfAnotherRobotIsFoundBeforeTheTwoTouch) {
  stand_at({20, 20}, {40, 20});
  drive(a, {20, 0}, 60);
  EXPECT_EQ(broken(16), "L6: the line of ") << *sentinel->broken();
  EXPECT_GT((bodies[a].position() - bodies[b].position()).norm(), 2 * radius + 1);
}

TEST_F(SentinelTest, LinesThatCrossAtDifferentTimesDoNotMeet) {
  stand_at({20, 20}, {60, 40});
  bodies[b] = Driver({.position = {60, 40},
                      .velocity = {0, -20},
                      .decision_time = control_period,
                      .next_velocity = {0, -20},
                      .expiry = 2 * control_period},
                     radius, {max_speed, 2 * max_speed}, control_period);
  drive(a, {20, 0}, 20);
  EXPECT_EQ(sentinel->broken().value_or(""), "");
}

TEST_F(SentinelTest, ADecisionThatLeadsIntoAnObstacleIsFound) {
  OccupancyMap map = test::open_map(200, 100);
  test::block(map, 60, 0, 61, 100);
  field = ClearanceField(map);
  drive(a, {20, 0}, 60);
  EXPECT_EQ(broken(40), "L6: the line of a leads into an obstacle") << *sentinel->broken();
  EXPECT_LT(bodies[a].position().x(), 60 - radius);
}

TEST_F(SentinelTest, ARobotThatBeginsInAnObstacleMayDriveOut) {
  OccupancyMap map = test::open_map(200, 100);
  test::block(map, 14, 0, 17, 100);
  field = ClearanceField(map);
  drive(a, {20, 0}, 10);
  EXPECT_EQ(sentinel->broken().value_or(""), "");
}

TEST_F(SentinelTest, ABodyThatIsNotOnTheLineOfItsLastDecisionIsFound) {
  drive(a, {20, 0}, 5);
  pass_a_period();
  const Point2 aside = bodies[a].position() + Point2(0, 0.01);
  bodies[a] = Driver(aside, now(), radius, {max_speed, 2 * max_speed}, control_period);
  look(a);
  EXPECT_EQ(broken(10), "A1: a is n") << *sentinel->broken();
}

TEST_F(SentinelTest, AStateThatContradictsThePromiseOfTheLastOneIsFound) {
  drive(a, {20, 0}, 5);
  say(a, bodies[a].promise());
  drive(a, {20, 0}, 1);
  say(a, bodies[a].promise());
  EXPECT_EQ(sentinel->broken().value_or(""), "");
  Promise elsewhere = bodies[a].promise();
  elsewhere.position.x() += 0.01;
  say(a, elsewhere);
  EXPECT_EQ(broken(12), "L1: a does n") << *sentinel->broken();
}

TEST_F(SentinelTest, ARobotThatSetsOffAlthoughItHasBoundItselfToStandIsFound) {
  bodies[a].stay(0.2);
  say(a, bodies[a].promise());
  Promise promise = bodies[a].promise();
  promise.stamp += control_period;
  promise.decision_time += control_period;
  promise.next_velocity = {1, 0};
  say(a, promise);
  EXPECT_EQ(broken(12), "L1: a does n") << *sentinel->broken();
}

TEST_F(SentinelTest, AClockThatIsFurtherOffThanAnAgentCountsOnIsFound) {
  ClockOffset clock;
  clock.hear(0, 0.1);
  clock.hear_echo(0, 0.2, 0.3);
  sentinel->check_clock(a, b, clock, now());
  EXPECT_EQ(sentinel->broken().value_or(""), "") << "between -0.2 and 0.1 s";
  clock = {};
  clock.hear(0, 0.3);
  clock.hear_echo(0, -0.1, 0.3);
  sentinel->check_clock(a, b, clock, now());
  EXPECT_EQ(broken(4), "L3: ") << "between 0.1 and 0.3 s";
}

TEST_F(SentinelTest, AProgressThatIsNotThatOfTheTurnIsFound) {
  reserve(a, 7, {80, 20});
  drive(a, {20, 0}, 20);
  const double true_progress = bodies[a].decision_position().x() - 20;
  say(a, bodies[a].promise(), 7, true_progress);
  EXPECT_EQ(sentinel->broken().value_or(""), "");
  say(a, bodies[a].promise(), 7, true_progress - 1);
  EXPECT_EQ(broken(14), "L14: a says th") << *sentinel->broken();
}

TEST_F(SentinelTest, ARobotThatStaysInTheStripOnWhichAnotherOneReliesBreaksNothing) {
  reserve(b, 7, {80, 60});
  drive(a, {20, 0}, 10, {{"b", 7}});
  drive(b, {20, 0}, 20);
  EXPECT_EQ(sentinel->broken().value_or(""), "");
}

TEST_F(SentinelTest, ARobotThatLeavesTheStripOnWhichAnotherOneReliesIsFoundLongBeforeTheTwoTouch) {
  stand_at({20, 20}, {20, 40});
  reserve(b, 7, {80, 40});
  drive(a, {20, 0}, 10, {{"b", 7}});
  reserve(b, 8, {20, 10});
  drive(b, {0, -20}, 20);
  EXPECT_EQ(broken(43), "L14: b leaves the strip of its reservation ") << *sentinel->broken();
  EXPECT_GT((bodies[a].position() - bodies[b].position()).norm(), 3 * radius);
}

TEST_F(SentinelTest, ARobotMayLeaveItsStripOnceThoseWhoReliedOnItStand) {
  reserve(b, 7, {80, 60});
  drive(a, {20, 20}, 3, {{"b", 7}});
  for (int k = 0; k < 5; ++k) pass_a_period();
  ASSERT_TRUE(bodies[a].stands());
  drive(b, {0, -20}, 5);
  EXPECT_EQ(sentinel->broken().value_or(""), "");
}

TEST_F(SentinelTest, ARobotMayLeaveItsStripIfItCannotMeetThoseWhoRelyOnIt) {
  stand_at({20, 20}, {180, 60});
  reserve(b, 7, {120, 60});
  drive(a, {20, 20}, 10, {{"b", 7}});
  drive(b, {0, -20}, 5);
  EXPECT_EQ(sentinel->broken().value_or(""), "");
}

TEST_F(SentinelTest, ARobotThatReliesOnOneThatHasLeftItsStripIsFound) {
  stand_at({20, 20}, {20, 45});
  reserve(b, 7, {80, 45});
  drive(b, {0, -20}, 10);
  EXPECT_EQ(sentinel->broken().value_or(""), "");
  drive(a, {20, 0}, 10, {{"b", 7}});
  EXPECT_EQ(broken(14), "L14: a relies ") << *sentinel->broken();
}

TEST_F(SentinelTest, ARobotThatReliesOnAReservationThatWasNeverMadeIsFound) {
  drive(a, {20, 0}, 3, {{"b", 7}});
  EXPECT_EQ(broken(14), "L14: a relies ") << *sentinel->broken();
}

TEST_F(SentinelTest, ARobotThatLeavesItsOwnStripAndLeavesOthersOutIsFound) {
  reserve(a, 3, {80, 20});
  reserve(b, 7, {80, 60});
  say(a, bodies[a].promise(), 3, 0);
  drive(a, {0, -20}, 5, {{"b", 7}});
  EXPECT_EQ(broken(16), "L14: a leaves it") << *sentinel->broken();
}

}  // namespace
}  // namespace coppice
