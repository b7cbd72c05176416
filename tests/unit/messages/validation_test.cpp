// Tests that messages of a hostile or broken sender are detected.
#include "messages/validation.h"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

namespace coppice {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Mission mission() {
  return {.robot = "r1",
          .number = 1,
          .map_id = "m",
          .start = {1, 2},
          .goal = {3, 4},
          .radius = 1,
          .max_speed = 2,
          .max_acceleration = 4,
          .goal_tolerance = 1};
}
RobotState state() {
  return {.robot = "r1",
          .promise = {.stamp = 1,
                      .position = {1, 2},
                      .velocity = {1, 0},
                      .decision_time = 1.05,
                      .next_velocity = {1, 0},
                      .expiry = 1.1},
          .radius = 1,
          .max_speed = 2,
          .max_acceleration = 4,
          .phase = Phase::driving,
          .round = {}};
}
InactiveTreesMessage tree() {
  return {.id = {1, 2},
          .map_id = "m",
          .radius = 1,
          .nodes = {{{0, 0}, -1, 2}, {{1, 0}, 0, 1}},
          .links = {{1, {1, 1}, 7}}};
}
JointPlanMessage plan() {
  return {.round = {1, "r1"}, .members = {{"r1", 1, false, {{0, {0, 0}}, {1, {1, 1}}}}}};
}

template <class M>
std::optional<std::string> problem(M message, const std::function<void(M&)>& spoil) {
  spoil(message);
  return problem_with(message);
}

TEST(Validation, ValidMessagesPass) {
  EXPECT_FALSE(problem_with(mission()));
  EXPECT_FALSE(problem_with(state()));
  EXPECT_FALSE(problem_with(tree()));
  EXPECT_FALSE(problem_with(plan()));
  EXPECT_FALSE(problem_with(MapMessage{"m", {.width = 1, .height = 2, .blocked = {0, 1}}}));
}

TEST(Validation, InvalidMissionsAreRefused) {
  using M = Mission;
  const std::vector<std::function<void(M&)>> spoilers{
      [](M& m) { m.robot.clear(); },
      [](M& m) { m.robot = std::string(65, 'x'); },
      [](M& m) { m.start.x() = nan; },
      [](M& m) { m.goal.y() = infinity; },
      [](M& m) { m.radius = 0; },
      [](M& m) { m.radius = -1; },
      [](M& m) { m.max_speed = nan; },
      [](M& m) { m.max_acceleration = 0; },
      [](M& m) { m.goal_tolerance = 0; },
      [](M& m) { m.fleet_size = 0; },
      [](M& m) { m.clock.scale = 0; },
      [](M& m) { m.clock.epoch = nan; },
      [](M& m) { m.clock.scale = 1e6; },
      [](M& m) { m.radius = 1e-300; },
      [](M& m) { m.max_speed = 1e6; },
      [](M& m) { m.max_acceleration = 1e-3; },
      [](M& m) { m.coordination = static_cast<Coordination>(3); }};
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(mission(), spoilers[k])) << k;
}

TEST(Validation, InvalidStatesAreRefused) {
  using M = RobotState;
  const std::vector<std::function<void(M&)>> spoilers{[](M& m) { m.promise.position.x() = nan; },
                                                      [](M& m) {
                                                        m.promise.velocity = {3, 0};
                                                      },
                                                      [](M& m) {
                                                        m.promise.next_velocity = {0, 3};
                                                      },
                                                      [](M& m) { m.promise.expiry = 1.0; },
                                                      [](M& m) { m.promise.decision_time = nan; },
                                                      [](M& m) { m.phase = static_cast<Phase>(9); },
                                                      [](M& m) { m.stage = static_cast<Stage>(3); },
                                                      [](M& m) { m.round.epoch = 1; },
                                                      [](M& m) { m.reservation_progress = -1; },
                                                      [](M& m) { m.radius = 2e9; },
                                                      [](M& m) { m.radius = 1e-300; },
                                                      [](M& m) { m.max_acceleration = 1e-3; },
                                                      [](M& m) { m.promise.expiry = 1e8; },
                                                      [](M& m) { m.promise.stamp = -2e9; },
                                                      [](M& m) { m.copies = 0; },
                                                      [](M& m) { m.robot = "r\x1b[2J"; },
                                                      [](M& m) { m.waits_for = "\xff"; },
                                                      [](M& m) {
                                                        m.echoes = {{"r2", 1, infinity}};
                                                      },
                                                      [](M& m) {
                                                        m.echoes.resize(33, {"r2", 1, 1});
                                                      }};
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(state(), spoilers[k])) << k;
}

TEST(Validation, RobotsThatTurnByMoreThanHalfATurnInAControlPeriodAreRefused) {
  const auto turning_at = [](double rate) {
    return [rate](auto& m) {
      m.max_angular_speed = rate;
      m.max_angular_acceleration = 100;
    };
  };
  EXPECT_FALSE(problem<Mission>(mission(), turning_at(fastest_turning)));
  EXPECT_FALSE(problem<RobotState>(state(), turning_at(fastest_turning)));
  const auto refused_mission = problem<Mission>(mission(), turning_at(1.01 * fastest_turning));
  const auto refused_state = problem<RobotState>(state(), turning_at(1.01 * fastest_turning));
  ASSERT_TRUE(refused_mission);
  ASSERT_TRUE(refused_state);
  EXPECT_NE(refused_mission->find("angular limit"), std::string::npos) << *refused_mission;
  EXPECT_NE(refused_state->find("angular limit"), std::string::npos) << *refused_state;
}

TEST(Validation, InvalidTreesAreRefused) {
  using M = InactiveTreesMessage;
  const std::vector<std::function<void(M&)>> spoilers{[](M& m) { m.nodes.clear(); },
                                                      [](M& m) { m.nodes[0].parent = 0; },
                                                      [](M& m) { m.nodes[1].parent = 1; },
                                                      [](M& m) { m.nodes[1].parent = -2; },
                                                      [](M& m) { m.nodes[1].parent = 7; },
                                                      [](M& m) {  // the parent is of the tree before
                                                        m.nodes.push_back({{5, 5}, -1, 1});
                                                        m.nodes.push_back({{6, 5}, 1, 1});
                                                      },
                                                      [](M& m) { m.nodes[1].position.x() = nan; },
                                                      [](M& m) { m.nodes[1].edge_clearance = -1; },
                                                      [](M& m) {
                                                        m.links = {{2, {1, 1}, 0}};
                                                      },
                                                      [](M& m) {
                                                        m.links = {{0, m.id, 2}};
                                                      },
                                                      [](M& m) { m.radius = 0; }};
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(tree(), spoilers[k])) << k;
}

TEST(Validation, InvalidJointPlansAreRefused) {
  using M = JointPlanMessage;
  const std::vector<std::function<void(M&)>> spoilers{
      [](M& m) { m.round.epoch = 0; }, [](M& m) { m.round.leader.clear(); },
      [](M& m) { m.members[0].radius = 0; }, [](M& m) { m.members[0].robot.clear(); },
      [](M& m) { m.members[0].trajectory[1].position.y() = infinity; },
      [](M& m) { m.members[0].trajectory[1].time = -1; }, [](M& m) { m.members.resize(4097, m.members[0]); },
      [](M& m) { m.members[0].radius = 1e-300; },
      // Pieces of the size of a robot would be endless for a way there.
      [](M& m) {
        m.members[0].trajectory[1].position = {2e6, 0};
      },
      [](M& m) {
        m.basis = {{"r2", 0, 0}};
      },
      [](M& m) {
        m.basis = {{"r2", 1, nan}};
      }};
  EXPECT_FALSE(problem_with(plan()));
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(plan(), spoilers[k])) << k;
}

TEST(Validation, InvalidReservationsAreRefused) {
  using M = ReservationMessage;
  const M fine{.robot = "r1",
               .number = 2,
               .first_number = 1,
               .radius = 1,
               .way = 3,
               .trajectory = {{0, {0, 0}}, {1, {1, 1}}},
               .basis = {{"r2", 3, 0.5}},
               .plan = {"r2", 1, 0.5},
               .run = {}};
  const std::vector<std::function<void(M&)>> spoilers{[](M& m) { m.robot.clear(); },
                                                      [](M& m) { m.number = 0; },
                                                      [](M& m) { m.first_number = 0; },
                                                      [](M& m) { m.first_number = 3; },
                                                      [](M& m) { m.radius = -1; },
                                                      [](M& m) { m.way = nan; },
                                                      [](M& m) { m.priority = static_cast<Priority>(4); },
                                                      [](M& m) { m.trajectory[0].time = 2; },
                                                      [](M& m) { m.trajectory.resize(65'537); },
                                                      [](M& m) { m.basis[0].robot.clear(); },
                                                      [](M& m) { m.plan.epoch = 0; },
                                                      [](M& m) { m.plan.shift = infinity; },
                                                      [](M& m) { m.plan.leader = "\xff"; }};
  EXPECT_FALSE(problem_with(fine));
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(fine, spoilers[k])) << k;
}

TEST(Validation, InvalidRootNodesTracksAndMapsAreRefused) {
  EXPECT_FALSE(problem_with(RootNodes{"r1", 1, 5, {{Root::goal, {0, 0}, 4}}}));
  EXPECT_TRUE(problem_with(RootNodes{"r1", 1, 5, {{Root::goal, {0, 0}, 5}}}));
  EXPECT_TRUE(problem_with(RootNodes{"r1", 1, 5, {{static_cast<Root>(2), {0, 0}, 1}}}));
  EXPECT_TRUE(problem_with(TrackMessage{"r1", 1, 0, {{2, {0, 0}, {0, 0}}, {1, {0, 0}, {0, 0}}}}));
  EXPECT_TRUE(problem_with(MapMessage{"m", {.width = 2, .height = 2, .blocked = {0, 1}}}));
  EXPECT_TRUE(problem_with(MapMessage{"m", {.width = 1, .height = 1, .blocked = {0}}, {5, -1}}));
  EXPECT_TRUE(problem_with(MapMessage{"m", {.width = -1, .height = 2, .blocked = {}}}));
  // The product is 0 in 32 bits.
  EXPECT_TRUE(problem_with(MapMessage{"m", {.width = 65536, .height = 65536, .blocked = {}}}));
  EXPECT_TRUE(problem_with(MapMessage{"m", {.width = 1, .height = 1, .resolution = 1e-300, .blocked = {0}}}));
}

TEST(Validation, EmptyMessagesAreRefused) {
  EXPECT_TRUE(problem_with(MapMessage{}));
  EXPECT_TRUE(problem_with(Mission{}));
  EXPECT_TRUE(problem_with(RootNodes{}));
  EXPECT_TRUE(problem_with(InactiveTreesMessage{}));
  EXPECT_TRUE(problem_with(RobotState{}));
  EXPECT_TRUE(problem_with(JointPlanMessage{}));
  EXPECT_TRUE(problem_with(PathMessage{}));
  EXPECT_TRUE(problem_with(TrackMessage{}));
  EXPECT_TRUE(problem_with(AgentStatus{}));
  EXPECT_TRUE(problem_with(BrokerStatus{}));
}

TEST(Validation, AReasonIsTextThatAReportCanQuote) {
  const auto with = [](std::string reason) {
    return problem_with(AgentStatus{.robot = "r1", .reason = std::move(reason)});
  };
  for (const char* fine : {"", "no path", "kein Weg: zu breit für Lücken", "道がない", "\xf0\x9f\xa4\x96"})
    EXPECT_FALSE(with(fine)) << fine;
  for (const char* bad : {"\n", "\x7f", "\xff", "\xc3", "\xc0\xaf", "\xe4\xb8", "\xed\xa0\x80", "\xc2\x9b",
                          "\xf4\x90\x80\x80", "\xe0\x80\x80"})
    EXPECT_TRUE(with(bad)) << bad;
  EXPECT_TRUE(with(std::string("\0", 1)));
  EXPECT_TRUE(with(std::string(257, 'x')));
  EXPECT_TRUE(problem_with(AgentStatus{.robot = "r1", .load = {.state_age_p99 = nan}}));
  EXPECT_TRUE(problem_with(BrokerStatus{.broker = 1, .covered_map = "\x1b"}));
  EXPECT_FALSE(problem_with(BrokerStatus{.broker = 1}));
}

TEST(Validation, AnAgentSpeaksForItsOwnRobotUnlessItRelays) {
  const auto sender = [](const Message& m) { return sender_of(m) == nullptr ? "" : *sender_of(m); };
  EXPECT_EQ(sender(state()), "r1");
  RobotState passed_on = state();
  passed_on.passed_on = true;
  EXPECT_EQ(sender(passed_on), "");
  EXPECT_EQ(sender(JointPlanMessage{.round = {1, "r7"}, .members = {{"r1", 1, false}}}), "r7");
  EXPECT_EQ(sender(PathMessage{.robot = "r2", .waypoints = {}}), "r2");
  EXPECT_EQ(sender(TrackMessage{.robot = "r3", .points = {}}), "r3");
  EXPECT_EQ(sender(RootNodes{.robot = "r4", .nodes = {}}), "r4");
  EXPECT_EQ(sender(AgentStatus{.robot = "r5"}), "r5");
  EXPECT_EQ(sender(mission()), "");
  EXPECT_EQ(sender(tree()), "");
}

TEST(Validation, InvalidClaimsAndAssignmentsAreRefused) {
  EXPECT_FALSE(problem_with(Claim{1, 1}));
  EXPECT_TRUE(problem_with(Claim{0, 1}));
  EXPECT_TRUE(problem_with(Claim{1, 1, std::string(65, 'x')}));
  EXPECT_TRUE(problem_with(Claim{1, 1, "\xff"})) << "no UTF-8: no recording could hold it";
  EXPECT_FALSE(problem_with(Assignment{"r1", 1, 1}));
  EXPECT_TRUE(problem_with(Assignment{"", 1, 1}));
  EXPECT_TRUE(problem_with(Assignment{"r1", 0, 1}));
}

}  // namespace
}  // namespace coppice
