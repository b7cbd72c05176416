// Tests of the tree broker as a state machine, message by message.
#include "tree_broker/tree_broker.h"

#include <map>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "robot_agent/process/robot_agent.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

TEST(TreeBroker, EachTreeThatARootTreeComesNearIsPublished) {
  PlannerService service(two_robots(), {}, 0);
  TreeBroker broker(7, 1);
  for (Message& message : map_and_missions(service)) {
    if (auto* map = std::get_if<MapMessage>(&message)) map->radii.clear();  // nothing is grown ahead
    broker.on(arrival_of(message, 0));
  }
  RootNodes roots{.robot = "a", .mission = 1, .nodes = {}};
  for (int k = 0; k < 16; ++k)  // on the start's side of the wall
    roots.nodes.push_back({Root::start, {6.0 + 2.7 * k, k % 2 == 0 ? 20.0 : 10.0}, k - 1});
  broker.on(arrival_of(roots, 0));
  std::map<TreesId, int> seen;
  for (double now = 0; now < 0.2; now += 0.001) {
    for (const auto& tree : of<InactiveTreesMessage>(broker.step(now))) ++seen[tree.id];
  }
  EXPECT_GT(seen.size(), 0u);
  for (const auto& [tree, times] : seen) {
    EXPECT_EQ(tree.broker, 7u);
    EXPECT_EQ(times, 1);
  }
}

TEST(TreeBroker, TreesGrowAheadUntilTheyCoverTheMap) {
  Scenario scenario = two_robots();
  scenario.robots[1].radius = 3;
  PlannerService service(scenario, {}, 0);
  TreeBroker broker(7, 1);
  for (const Message& message : service.step(0)) broker.on(arrival_of(message, 0));
  std::vector<InactiveTreesMessage> trees;
  std::string covered;
  double now = 0;
  for (; covered.empty() && now < 10; now += 0.001) {
    const auto said = broker.step(now);
    for (const auto& tree : of<InactiveTreesMessage>(said)) trees.push_back(tree);
    for (const auto& status : of<BrokerStatus>(said)) covered = status.covered_map;
    service.on(arrival_of(BrokerStatus{.broker = 7, .covered_map = covered}, now));
    for (const char* robot : {"a", "b"}) service.on(arrival_of(AgentStatus{.robot = robot}, now));
  }
  EXPECT_TRUE(of<InactiveTreesMessage>(broker.step(now)).empty());
  EXPECT_GT(broker.next_wake(), now);  // it rests until a mission comes
  ASSERT_FALSE(trees.empty());

  // An agent that gets the trees first finds its path in the step in which it gets its mission. It publishes
  // the path in the next step, when it knows how long the search took.
  RobotAgent agent("a");
  agent.on(arrival_of(MapMessage{covered, scenario.map, {}}, now));
  for (const InactiveTreesMessage& tree : trees) agent.on(arrival_of(tree, now));
  for (const Message& message : service.step(now)) agent.on(arrival_of(message, now));
  agent.step(now);
  EXPECT_EQ(agent.next_wake(), now);
  const auto said = messages(agent.step(now + 0.003));
  ASSERT_EQ(of<PathMessage>(said).size(), 1u);
  EXPECT_GT(of<AgentStatus>(said).back().trees_grafted, 0u);
  EXPECT_NEAR(of<AgentStatus>(said).back().plan_seconds, 0.003, 1e-9);
}

TEST(TreeBroker, GrowingTreesAreShown) {
  PlannerService service(two_robots(), {}, 0);
  TreeBroker broker(7, 1);
  for (const Message& message : service.step(0)) broker.on(arrival_of(message, 0));
  const ClearanceField field(two_robots().map);
  std::size_t most = 0;
  std::optional<ActiveTreesMessage> last;
  double last_at = -1;
  for (double now = 0; now < 10; now += 0.001) {
    for (ActiveTreesMessage& shown : of<ActiveTreesMessage>(broker.step(now))) {
      EXPECT_EQ(shown.broker, 7u);
      EXPECT_GE(now, last_at + 0.099);  // not at every step
      for (const ActiveTreesMessage::Edge& edge : shown.edges)
        EXPECT_TRUE(field.segment_free(edge.from, edge.to, two_robots().robots[0].radius - 1e-6));
      most = std::max(most, shown.edges.size());
      last_at = now;
      last = std::move(shown);
    }
  }
  EXPECT_GT(most, 2u);
  ASSERT_TRUE(last.has_value());
  EXPECT_TRUE(last->edges.empty());  // the trees that cover the map are inactive
  EXPECT_LT(last_at, 9);             // then it has nothing more to show
}

TEST(TreeBroker, TheBrokerRestsOnceAllIsSolvedAndCovered) {
  PlannerService service(two_robots(), {}, 0);
  TreeBroker broker(7, 1);
  for (const Message& message : map_and_missions(service)) broker.on(arrival_of(message, 0));
  EXPECT_EQ(broker.next_wake(), 0);  // there is something to grow
  for (const char* robot : {"a", "b"}) {
    AgentStatus status;
    status.robot = robot;
    status.mission = 1;
    status.phase = Phase::driving;
    broker.on(arrival_of(status, 0.1));
  }
  for (int k = 0; k < 1000; ++k) broker.step(0.1);
  EXPECT_GT(broker.next_wake(), 0.1);
}

TEST(TreeBroker, RootNodesOfUnknownRobotsAndRepetitionsChangeNothing) {
  PlannerService service(two_robots(), {}, 0);
  TreeBroker broker(7, 1);
  broker.on(arrival_of(RootNodes{"a", 1, 0, {{Root::start, {20, 60}, -1}}}, 0));  // before map and mission
  for (const Message& m : map_and_missions(service)) broker.on(arrival_of(m, 0));
  broker.on(arrival_of(RootNodes{"z", 1, 0, {{Root::start, {20, 60}, -1}}}, 0));
  broker.on(arrival_of(RootNodes{"a", 1, 0, {{Root::start, {-1e9, 1e9}, -1}, {Root::goal, {60, 60}, 0}}}, 0));
  broker.on(
      arrival_of(RootNodes{"a", 1, ~0u, {{Root::start, {1e9, 1e9}, -1}, {Root::goal, {60, 60}, 0}}}, 0));
  for (int k = 0; k < 3; ++k) broker.step(0.1 * k);
}

// DDS delivers the last messages of the previous run to late joiners. The broker must not take them for the
// end of this run.
TEST(TreeBroker, TheBrokerGrowsForMissionsOfTheCurrentRunOnly) {
  OccupancyMap walled{.width = 120, .height = 80, .blocked = std::vector<std::uint8_t>(9600, 0)};
  for (int j = 0; j < 80; ++j) walled.blocked[static_cast<std::size_t>(j * 120 + 60)] = 1;
  TreeBroker broker(7, 1);
  broker.on(arrival_of(MapMessage{"walled", walled, {}}, 0));
  const auto begins = [&](WallTime run) {
    broker.on(arrival_of(Mission{.robot = "a",
                                 .number = 1,
                                 .map_id = "walled",
                                 .start = {20, 60},
                                 .goal = {100, 60},
                                 .radius = 5,
                                 .clock = {run, 1}},
                         run));
  };
  const auto has_a_path = [&](WallTime run, WallTime now) {
    AgentStatus status{.robot = "a", .mission = 1, .phase = Phase::driving};
    status.run = {run};
    broker.on(arrival_of(status, now));
  };
  const auto grows = [&](WallTime now) {
    broker.step(now);
    return broker.next_wake() == now;
  };
  begins(1);
  EXPECT_TRUE(grows(1));
  has_a_path(1, 2);
  EXPECT_FALSE(grows(2));
  begins(3);
  has_a_path(1, 3);
  EXPECT_TRUE(grows(3));
  has_a_path(3, 4);
  EXPECT_FALSE(grows(4));
}

// Each start of a broker has another identity, and a process may live for months.
TEST(TreeBroker, TheBrokerRemembersABoundedNumberOfOtherBrokers) {
  TreeBroker broker(7, 1);
  for (std::uint64_t other = 100; other < 1200; ++other)
    broker.on(arrival_of(BrokerStatus{.broker = other, .leads = false}, 0));
  EXPECT_EQ(of<BrokerStatus>(broker.step(0)).back().rejected, 100u);
  for (int k = 1; k < 50; ++k) {  // 2 s later, the previous ones are gone
    broker.step(2 * k);
    for (std::uint64_t other = 0; other < 100; ++other)
      broker.on(arrival_of(BrokerStatus{.broker = 10'000ull + 100 * k + other, .leads = false}, 2 * k));
  }
  EXPECT_EQ(of<BrokerStatus>(broker.step(100)).back().rejected, 100u);
}

}  // namespace
}  // namespace coppice
