// Tests of shorter paths for the same plan, checked move by move.
#include "motion/joint/straightening.h"

#include <gtest/gtest.h>

#include "motion/trajectory/segments.h"

namespace coppice {
namespace {

OccupancyMap open_map() {
  return {.width = 200, .height = 100, .blocked = std::vector<std::uint8_t>(200 * 100, 0)};
}

double driven(const std::vector<Move>& moves, std::size_t robot) {
  double sum = 0;
  for (const Move& move : moves) {
    if (move.robot == robot) sum += length_of(move.path);
  }
  return sum;
}

TEST(Straightening, ANeedlessDetourIsRemoved) {
  const ClearanceField field(open_map());
  const std::vector<JointTask> tasks{{{10, 10}, Point2(90, 10), 5}};
  const std::vector<Move> moves{
      {0, {{10, 10}, {30, 30}}}, {0, {{30, 30}, {60, 5}}}, {0, {{60, 5}, {90, 10}}}};
  const std::vector<Move> straight = straightened(field, tasks, moves);
  EXPECT_DOUBLE_EQ(driven(straight, 0), 80);
  EXPECT_EQ(straight.back().path.back(), Point2(90, 10));
}

TEST(Straightening, ANeedlessRoundTripIsRemoved) {
  const ClearanceField field(open_map());
  const std::vector<JointTask> tasks{{{10, 10}, Point2(10, 10), 5}};
  const std::vector<Move> moves{{0, {{10, 10}, {30, 30}}}, {0, {{30, 30}, {10, 10}}}};
  EXPECT_TRUE(straightened(field, tasks, moves).empty());
}

// The first robot makes room for the second: it must not stay.
TEST(Straightening, ARefugeIsKeptWhileItIsNeeded) {
  const ClearanceField field(open_map());
  const std::vector<JointTask> tasks{{{50, 50}, Point2(50, 50), 5}, {{10, 50}, Point2(190, 50), 5}};
  const std::vector<Move> moves{
      {0, {{50, 50}, {50, 70}}}, {1, {{10, 50}, {190, 50}}}, {0, {{50, 70}, {50, 50}}}};
  const std::vector<Move> same = straightened(field, tasks, moves);
  ASSERT_EQ(same.size(), 3u);
  EXPECT_EQ(same[0].path.back(), Point2(50, 70));
}

TEST(Straightening, NoMoveLeadsThroughARobot) {
  const ClearanceField field(open_map());
  const std::vector<JointTask> tasks{{{10, 50}, Point2(190, 50), 5}, {{100, 50}, Point2(100, 50), 5}};
  const std::vector<Move> moves{
      {0, {{10, 50}, {100, 80}}}, {0, {{100, 80}, {130, 70}}}, {0, {{130, 70}, {190, 50}}}};
  for (const Move& move : straightened(field, tasks, moves))
    EXPECT_GE(point_path_distance({100, 50}, move.path), 10 + standing_gap);
}

TEST(Straightening, MovesKeepClearOfObstacles) {
  OccupancyMap map = open_map();
  for (int j = 0; j < 60; ++j) map.blocked[static_cast<std::size_t>(j * 200 + 100)] = 1;
  const ClearanceField field(map);
  const std::vector<JointTask> tasks{{{50, 20}, Point2(150, 20), 5}};
  const std::vector<Move> moves{
      {0, {{50, 20}, {70, 80}}}, {0, {{70, 80}, {130, 80}}}, {0, {{130, 80}, {150, 20}}}};
  for (const Move& move : straightened(field, tasks, moves)) {
    for (std::size_t k = 1; k < move.path.size(); ++k)
      EXPECT_TRUE(field.segment_free(move.path[k - 1], move.path[k], 5));
  }
}

}  // namespace
}  // namespace coppice
