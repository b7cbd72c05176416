// Agents take inactive trees and their links in any order, and again from a broker that took over.
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/control/path_finder.h"
#include "robot_agent/control/tree_store.h"

namespace coppice {
namespace {

/// Two rooms: the wall is at x = 200 to 220, its door at y = 60 to 80.
OccupancyMap two_rooms() {
  OccupancyMap map{.width = 400, .height = 120, .blocked = {}};
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) map.blocked.push_back(x >= 200 && x < 220 && (y < 60 || y >= 80));
  }
  return map;
}

InactiveTreesMessage tree_at(std::uint32_t number, const Point2& p) {
  return {.id = {7, number}, .map_id = "m", .radius = 8, .nodes = {{p, -1, 8}}, .links = {}};
}

/// A tree of one node on each side of the door. The start sees the left one, the goal the right one.
struct Trees {
  InactiveTreesMessage left = tree_at(1, {160, 70});
  InactiveTreesMessage right = tree_at(2, {260, 70});
  InactiveTreesMessage linked() const {
    InactiveTreesMessage message = right;
    message.links = {{0, left.id, 0}};
    return message;
  }
};

/// Whether the agent has a path at once, without growing its root trees.
bool has_path(const std::vector<InactiveTreesMessage>& messages) {
  const ClearanceField field(two_rooms());
  PathImprover<ClearanceField> improver(field, 100, Random(1));
  Mission mission{.robot = "a", .number = 1, .map_id = "m", .start = {120, 100}, .goal = {300, 100}};
  mission.radius = 8;
  mission.trees.epsilon = 100;
  PathFinder finder(field, improver, mission, mission.start);
  for (const InactiveTreesMessage& message : messages) finder.take(message);
  const auto result = finder.step();
  return result && std::holds_alternative<Path>(*result) && finder.counts().valid == 0;
}

TEST(ReceivedTrees, ALinkCountsOnceBothTreesAreThere) {
  const Trees trees;
  EXPECT_FALSE(has_path({trees.left, trees.right}));
  EXPECT_FALSE(has_path({trees.linked()}));
  EXPECT_TRUE(has_path({trees.left, trees.linked()}));
  EXPECT_TRUE(has_path({trees.linked(), trees.left}));
}

TEST(ReceivedTrees, ALinkMayComeWithASecondCopyOfTheTree) {
  const Trees trees;
  EXPECT_TRUE(has_path({trees.left, trees.right, trees.linked()}));
  EXPECT_TRUE(has_path({trees.right, trees.linked(), trees.left}));
}

TEST(ReceivedTrees, ALinkOfANodeThatIsNotThereIsIgnored) {
  const Trees trees;
  InactiveTreesMessage wrong = trees.right;
  wrong.links = {{0, trees.left.id, 5}};
  EXPECT_FALSE(has_path({trees.left, wrong}));
}

TEST(ReceivedTrees, ASecondCopyIsNewsOnlyIfItHasANewLink) {
  const Trees trees;
  TreeStore store;
  EXPECT_EQ(store.take(trees.right, nullptr), TreeStore::Verdict::kept);
  EXPECT_EQ(store.take(trees.right, nullptr), TreeStore::Verdict::known);
  EXPECT_EQ(store.take(trees.linked(), nullptr), TreeStore::Verdict::kept);
  EXPECT_EQ(store.take(trees.linked(), nullptr), TreeStore::Verdict::known);
  EXPECT_EQ(store.take(trees.right, nullptr), TreeStore::Verdict::known);
  EXPECT_EQ(store.size(), 1u);
  EXPECT_EQ(store.messages().at(trees.right.id).links, trees.linked().links);
}

}  // namespace
}  // namespace coppice
