// Tests of the way back to where a robot last saw its path.
#include "motion/trajectory/trail.h"

#include <gtest/gtest.h>

#include "robot_agent/control/path_finder.h"

namespace coppice {
namespace {

/// A hall 40 m high from which a passage leads upwards. The passage is exactly as wide as a robot of radius 5
/// m, so that no sample lies in it.
OccupancyMap hall_with_a_nook() {
  OccupancyMap map{.width = 100, .height = 100, .blocked = std::vector<std::uint8_t>(10000, 0)};
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const bool passage = x >= 45 && x < 55 && y >= 40 && y < 90;
      map.blocked[static_cast<std::size_t>(y * 100 + x)] = y >= 40 && !passage;
    }
  }
  return map;
}

TEST(Trail, TheTrailLeadsBackAlongFreeStraightLines) {
  const ClearanceField field(hall_with_a_nook());
  Trail trail;
  trail.begin({20, 20});
  for (double x = 20; x <= 50; x += 0.5) trail.go_on({x, 20}, field, 5);
  for (double y = 20; y <= 80; y += 0.5) trail.go_on({50, y}, field, 5);
  trail.go_on({50, 80}, field, 5);
  const Path back = trail.back();
  EXPECT_EQ(back.front(), Point2(50, 80));
  EXPECT_EQ(back.back(), Point2(20, 20));
  EXPECT_LE(back.size(), 4u);
  for (std::size_t k = 1; k < back.size(); ++k) EXPECT_TRUE(way_free(field, back[k - 1], back[k], 5));
}

TEST(PathFinder, AKnownPathIsTakenIfTheSearchDoesNotEnd) {
  const ClearanceField field(hall_with_a_nook());
  PathImprover<ClearanceField> improver(field, 10, Random(1));
  const Mission mission{.robot = "a",
                        .start = {50, 80},
                        .goal = {20, 20},
                        .radius = 5,
                        .max_speed = 20,
                        .max_acceleration = 40,
                        .planner = PlannerKind::rrdt_star,
                        .clock = {}};
  const Path known{{50, 80}, {50, 30}, {80, 20}, {20, 20}};
  PathFinder finder(field, improver, mission, mission.start, known);
  std::optional<PathFinder::Result> result;
  for (int step = 0; step < 1000 && !result; ++step) result = finder.step();
  ASSERT_TRUE(result);
  ASSERT_TRUE(std::holds_alternative<Path>(*result));
  EXPECT_EQ(std::get<Path>(*result), known);
  const Path& taut = finder.pull_taut();
  EXPECT_LT(length_of(taut), length_of(known) - 20);
  for (std::size_t k = 1; k < taut.size(); ++k) EXPECT_TRUE(field.segment_free(taut[k - 1], taut[k], 5));
}

}  // namespace
}  // namespace coppice
