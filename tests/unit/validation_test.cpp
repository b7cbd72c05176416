// What a hostile or broken sender may put on the bus is told and dropped.
#include "bus/validation.h"

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
          .stamp = 1,
          .position = {1, 2},
          .velocity = {1, 0},
          .radius = 1,
          .max_speed = 2,
          .max_acceleration = 4,
          .phase = Phase::driving,
          .promise = {1.05, {1, 0}, 1.1},
          .knot = {}};
}
InactiveTreeMessage tree() {
  return {.tree = {1, 2}, .map_id = "m", .radius = 1, .nodes = {{{0, 0}, -1, 2}, {{1, 0}, 0, 1}}};
}
JointPlanMessage plan() {
  return {.knot = {1, "r1"}, .members = {{"r1", 1, false}}, .moves = {{0, {{0, 0}, {1, 1}}}}};
}

template <class M>
std::optional<std::string> problem(M message, const std::function<void(M&)>& spoil) {
  spoil(message);
  return problem_with(message);
}

TEST(Validation, SoundMessagesPass) {
  EXPECT_FALSE(problem_with(mission()));
  EXPECT_FALSE(problem_with(state()));
  EXPECT_FALSE(problem_with(tree()));
  EXPECT_FALSE(problem_with(plan()));
  EXPECT_FALSE(problem_with(MapMessage{"m", {.width = 1, .height = 2, .blocked = {0, 1}}}));
}

TEST(Validation, Missions) {
  using M = Mission;
  const std::vector<std::function<void(M&)>> spoilers{
      [](M& m) { m.robot.clear(); },      [](M& m) { m.robot = std::string(65, 'x'); },
      [](M& m) { m.start.x() = nan; },    [](M& m) { m.goal.y() = infinity; },
      [](M& m) { m.radius = 0; },         [](M& m) { m.radius = -1; },
      [](M& m) { m.max_speed = nan; },    [](M& m) { m.max_acceleration = 0; },
      [](M& m) { m.goal_tolerance = 0; }, [](M& m) { m.fleet_size = 0; },
      [](M& m) { m.clock.scale = 0; },    [](M& m) { m.clock.epoch = nan; }};
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(mission(), spoilers[k])) << k;
}

TEST(Validation, States) {
  using M = RobotState;
  const std::vector<std::function<void(M&)>> spoilers{[](M& m) { m.position.x() = nan; },
                                                      [](M& m) {
                                                        m.velocity = {3, 0};
                                                      },
                                                      [](M& m) {
                                                        m.promise.velocity = {0, 3};
                                                      },
                                                      [](M& m) { m.promise.expiry = 1.0; },
                                                      [](M& m) { m.promise.turn = nan; },
                                                      [](M& m) { m.phase = static_cast<Phase>(9); },
                                                      [](M& m) { m.stage = static_cast<Stage>(3); },
                                                      [](M& m) { m.knot.epoch = 1; },
                                                      [](M& m) { m.progress = -1; },
                                                      [](M& m) { m.radius = 2e9; }};
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(state(), spoilers[k])) << k;
}

TEST(Validation, Trees) {
  using M = InactiveTreeMessage;
  const std::vector<std::function<void(M&)>> spoilers{[](M& m) { m.nodes.clear(); },
                                                      [](M& m) { m.nodes[0].parent = 0; },
                                                      [](M& m) { m.nodes[1].parent = 1; },
                                                      [](M& m) { m.nodes[1].parent = -1; },
                                                      [](M& m) { m.nodes[1].parent = 7; },
                                                      [](M& m) { m.nodes[1].position.x() = nan; },
                                                      [](M& m) { m.nodes[1].edge_clearance = -1; },
                                                      [](M& m) { m.radius = 0; }};
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(tree(), spoilers[k])) << k;
}

TEST(Validation, JointPlans) {
  using M = JointPlanMessage;
  const std::vector<std::function<void(M&)>> spoilers{
      [](M& m) { m.knot.epoch = 0; },        [](M& m) { m.knot.leader.clear(); },
      [](M& m) { m.members[0].radius = 0; }, [](M& m) { m.moves[0].member = 1; },
      [](M& m) { m.moves[0].path.clear(); }, [](M& m) { m.moves[0].path[1].y() = infinity; }};
  for (std::size_t k = 0; k < spoilers.size(); ++k) EXPECT_TRUE(problem<M>(plan(), spoilers[k])) << k;
}

TEST(Validation, RootNodesTracksAndMaps) {
  EXPECT_FALSE(problem_with(RootNodes{"r1", 1, 5, {{Side::goal, {0, 0}, 4}}}));
  EXPECT_TRUE(problem_with(RootNodes{"r1", 1, 5, {{Side::goal, {0, 0}, 5}}}));
  EXPECT_TRUE(problem_with(RootNodes{"r1", 1, 5, {{static_cast<Side>(2), {0, 0}, 1}}}));
  EXPECT_TRUE(problem_with(TrackMessage{"r1", 1, 0, {{2, {0, 0}, {0, 0}}, {1, {0, 0}, {0, 0}}}}));
  EXPECT_TRUE(problem_with(MapMessage{"m", {.width = 2, .height = 2, .blocked = {0, 1}}}));
  EXPECT_TRUE(problem_with(MapMessage{"m", {.width = 1, .height = 1, .blocked = {0}}, {5, -1}}));
  EXPECT_TRUE(problem_with(MapMessage{"m", {.width = -1, .height = 2, .blocked = {}}}));
}

TEST(Validation, ClaimsAndAssignments) {
  EXPECT_FALSE(problem_with(Claim{1, 1}));
  EXPECT_TRUE(problem_with(Claim{0, 1}));
  EXPECT_TRUE(problem_with(Claim{1, 1, std::string(65, 'x')}));
  EXPECT_FALSE(problem_with(Assignment{"r1", 1, 1}));
  EXPECT_TRUE(problem_with(Assignment{"", 1, 1}));
  EXPECT_TRUE(problem_with(Assignment{"r1", 0, 1}));
}

}  // namespace
}  // namespace coppice
