// Tests of standby and restarted tree brokers as state machines, message by message.
#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "tests/unit/messages/kept.h"
#include "tests/unit/planner_service/roles.h"
#include "tree_broker/forest_record.h"
#include "tree_broker/tree_broker.h"

namespace coppice {
namespace {

MapMessage rooms() {
  Random random(1);
  return {"rooms", generate_map(MapKind::room, 400, 400, random), {5}};
}

/// Brokers that hear each other at once and are stepped each millisecond.
struct Brokers {
  void run(double seconds) {
    for (const double until = now + seconds; now < until; now += 0.001) {
      for (std::size_t i = 0; i < brokers.size(); ++i) {
        if (!brokers[i] || brokers[i]->next_wake() > now) continue;
        for (const Message& message : brokers[i]->step(now)) hear(message, i);
      }
    }
  }
  void hear(const Message& message, std::size_t from) {
    said[from].push_back(message);
    for (std::size_t i = 0; i < brokers.size(); ++i) {
      if (i != from && brokers[i]) brokers[i]->on(arrival_of(message, now));
    }
  }
  std::set<TreesId> trees_of(std::size_t i) const {
    std::set<TreesId> ids;
    for (const auto& tree : of<InactiveTreesMessage>(said[i])) ids.insert(tree.id);
    return ids;
  }
  double now = 100;
  std::vector<std::optional<TreeBroker>> brokers{};
  std::vector<std::vector<Message>> said = std::vector<std::vector<Message>>(3);
};

TEST(BrokerRestart, TheStandbyBrokerTakesOverWithinTwoSecondsWithAllTrees) {
  Brokers fleet;
  fleet.brokers.emplace_back(TreeBroker(9, 1));
  fleet.brokers[0]->on(arrival_of(rooms(), fleet.now));
  fleet.run(0.1);
  fleet.brokers.emplace_back(TreeBroker(4, 2));
  fleet.brokers[1]->on(arrival_of(rooms(), fleet.now));
  for (const Message& message : fleet.said[0]) fleet.brokers[1]->on(arrival_of(message, fleet.now));
  fleet.run(1);
  EXPECT_TRUE(fleet.brokers[0]->leads());
  EXPECT_FALSE(fleet.brokers[1]->leads());
  const std::set<TreesId> trees = fleet.trees_of(0);
  ASSERT_FALSE(trees.empty());
  EXPECT_TRUE(fleet.trees_of(1).empty());

  fleet.brokers[0].reset();
  fleet.run(2);
  ASSERT_TRUE(fleet.brokers[1]->leads());
  EXPECT_EQ(fleet.trees_of(1), trees);  // they cover the map, so no more trees are needed
  // The second broker continued where the first one was: most of the map was covered.
  EXPECT_LT(2 * of<BrokerStatus>(fleet.said[1]).back().nodes_valid,
            of<BrokerStatus>(fleet.said[0]).back().nodes_valid);
  EXPECT_EQ(of<BrokerStatus>(fleet.said[1]).back().trees_published, fleet.trees_of(1).size());
  EXPECT_EQ(of<BrokerStatus>(fleet.said[1]).back().covered_map, "rooms");
}

TEST(BrokerRestart, OfTwoLeadingBrokersTheOneThatLedFirstGoesOn) {
  Brokers fleet;
  for (const std::uint64_t id : {9u, 4u}) {
    fleet.brokers.emplace_back(TreeBroker(id, id));
    fleet.brokers.back()->on(arrival_of(map_message(), fleet.now));
    fleet.brokers.back()->step(fleet.now);  // the brokers have not heard each other yet
    fleet.now += 0.01;
    EXPECT_TRUE(fleet.brokers.back()->leads());
  }
  fleet.run(1);
  EXPECT_TRUE(fleet.brokers[0]->leads());
  EXPECT_FALSE(fleet.brokers[1]->leads());
}

TEST(BrokerRestart, ARestartedBrokerPublishesTheTreesInItsJournal) {
  Kept<ForestRecord> kept;
  Brokers fleet;
  fleet.brokers.emplace_back(TreeBroker(9, 1));
  fleet.brokers[0]->on(arrival_of(map_message(), fleet.now));
  kept.keeper.heard(map_message());
  fleet.run(1);
  for (const Message& message : fleet.said[0]) kept.keeper.said(message);
  for (const Message& message : fleet.said[0]) kept.keeper.heard(message);  // again, from another broker
  EXPECT_EQ(of<InactiveTreesMessage>(kept.store.messages).size(), fleet.trees_of(0).size());

  fleet.brokers[0].reset();
  fleet.brokers.emplace_back(TreeBroker(10, 3));
  fleet.brokers[1]->recall(kept.store.messages, fleet.now);
  fleet.run(0.9);
  EXPECT_FALSE(fleet.brokers[1]->leads());  // another broker may lead
  fleet.run(0.2);
  EXPECT_TRUE(fleet.brokers[1]->leads());
  EXPECT_EQ(fleet.trees_of(1), fleet.trees_of(0));  // they cover the map, so no more trees are needed

  // Trees of one map are of no use for another map.
  kept.keeper.heard(MapMessage{"other", wall_with_door(), {5}});
  EXPECT_EQ(kept.store.messages.size(), 1u);
}

// A broker that restarts at once without its journal leads before the standby broker misses its predecessor.
TEST(BrokerRestart, TreesThatOnlyTheStandbyBrokerKnowsArePublished) {
  Brokers fleet;
  for (const std::uint64_t id : {9u, 4u}) {
    fleet.brokers.emplace_back(TreeBroker(id, id));
    fleet.brokers.back()->on(arrival_of(rooms(), fleet.now));
    for (const Message& message : fleet.said[0]) fleet.brokers.back()->on(arrival_of(message, fleet.now));
    fleet.run(0.1);
  }
  fleet.run(2);
  const std::set<TreesId> trees = fleet.trees_of(0);
  ASSERT_FALSE(trees.empty());
  ASSERT_TRUE(fleet.trees_of(1).empty());

  fleet.brokers[0].reset();
  fleet.brokers.emplace_back(TreeBroker(11, 3));
  fleet.brokers[2]->on(arrival_of(rooms(), fleet.now));
  fleet.run(6);
  EXPECT_TRUE(fleet.brokers[2]->leads());
  EXPECT_FALSE(fleet.brokers[1]->leads());
  EXPECT_TRUE(std::ranges::includes(fleet.trees_of(1), trees));
}

TEST(BrokerRestart, ATreeThatOnlyAReturningBrokerKnowsIsPublished) {
  Brokers fleet;
  fleet.brokers.emplace_back(TreeBroker(9, 1));
  fleet.brokers[0]->on(arrival_of(rooms(), fleet.now));
  fleet.run(2);
  const std::set<TreesId> trees = fleet.trees_of(0);
  InactiveTreesMessage unheard = of<InactiveTreesMessage>(fleet.said[0]).front();
  unheard.id = {77, 0};
  fleet.brokers.emplace_back(TreeBroker(10, 3));
  fleet.brokers[1]->recall(std::vector<Message>{rooms(), unheard}, fleet.now);
  for (const Message& message : fleet.said[0]) fleet.brokers[1]->on(arrival_of(message, fleet.now));
  fleet.run(4);
  EXPECT_TRUE(fleet.brokers[0]->leads());
  EXPECT_EQ(fleet.trees_of(1), std::set{unheard.id});
  EXPECT_TRUE(fleet.trees_of(0).contains(unheard.id));
  EXPECT_EQ(fleet.trees_of(0).size(), trees.size() + 1);
}

}  // namespace
}  // namespace coppice
