// Tests of joint plans for clusters in random trees of corridors and halls.
#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"
#include "motion/joint/joint_planner.h"
#include "tests/support.h"
#include "tests/unit/motion/plans.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

constexpr int side = 300;  // cells
using test::radius;

int between(int least, int count, Random& random) {
  return least + static_cast<int>(random.index(static_cast<std::size_t>(count)));
}

OccupancyMap corridors_and_halls(Random& random) {
  OccupancyMap map = test::open_map(side, side);
  test::block(map, 0, 0, side, side);
  const auto carve = [&](int x0, int y0, int x1, int y1) {
    test::block(map, std::max(0, x0), std::max(0, y0), std::min(side, x1), std::min(side, y1), false);
  };
  const int width = std::array{12, 14, 18, 24}[random.index(4)];
  struct Node {
    int x;
    int y;
  };
  std::vector<Node> nodes{{side / 2, side / 2}};
  for (int branches = between(3, 8, random); branches > 0; --branches) {
    const Node from = nodes[random.index(nodes.size())];
    const int length = between(30, 120, random);
    Node to = from;
    (random.index(2) == 0 ? to.x : to.y) += random.index(2) == 0 ? length : -length;
    to = {std::clamp(to.x, width, side - width - 1), std::clamp(to.y, width, side - width - 1)};
    carve(std::min(from.x, to.x) - width / 2, std::min(from.y, to.y) - width / 2,
          std::max(from.x, to.x) - width / 2 + width, std::max(from.y, to.y) - width / 2 + width);
    nodes.push_back(to);
  }
  for (int halls = between(0, 3, random); halls > 0; --halls) {
    const Node centre = nodes[random.index(nodes.size())];
    const int half = between(20, 40, random);
    carve(centre.x - half, centre.y - half, centre.x + half, centre.y + half);
  }
  return map;
}

/// As many tasks as requested, if there is room.
std::vector<JointTask> strewn(const OccupancyMap& map, int robots, Random& random) {
  constexpr int most_draws = 4000;
  const ClearanceField field(map);
  const auto draw = [&] { return Point2(random.uniform(0, side), random.uniform(0, side)); };
  std::vector<JointTask> tasks;
  for (int k = 0; k < most_draws && std::cmp_less(tasks.size(), robots); ++k) {
    const Point2 start = draw();
    const Point2 goal = draw();
    const bool crowded = std::ranges::any_of(tasks, [&](const JointTask& o) {
      return (o.position - start).norm() < 2 * radius + 0.01 || (*o.goal - goal).norm() < 2 * radius + 0.01;
    });
    if (!crowded && field.is_free(start, radius) && field.is_free(goal, radius))
      tasks.push_back({start, goal, radius});
  }
  return tasks;
}

// Some clusters have no solution: two robots that want to pass each other in a single corridor.
TEST(JointPlans, ClustersInCorridorsAreSolved) {
  const std::uint32_t crowds = test::wants_long_tests() ? 4000 : 200;
  std::uint32_t not_sorted_out = 0;
  for (std::uint32_t seed = 1; seed <= crowds; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const OccupancyMap map = corridors_and_halls(random);
    const std::vector<JointTask> tasks = strewn(map, between(2, 11, random), random);
    const ClearanceField field(map);
    MapRoadmaps roadmaps(field);
    const JointPlan plan = joint_plan(roadmaps, tasks, Random(1));
    const std::vector<Point2> ends = test::driven(map, tasks, plan);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const bool stranded = std::ranges::find(plan.stranded, i) != plan.stranded.end();
      EXPECT_EQ(stranded, ends[i] != *tasks[i].goal) << i;
    }
    not_sorted_out += !plan.stranded.empty();
  }
  RecordProperty("not_sorted_out", static_cast<int>(not_sorted_out));
  EXPECT_LE(not_sorted_out, crowds / 50);
}

}  // namespace
}  // namespace coppice
