// Tests of joint plans of a few robots on small grids, against an exhaustive search of single moves between
// cells.
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"
#include "motion/joint/joint_planner.h"
#include "tests/arrangements.h"
#include "tests/support.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

/// Whether a joint plan is found for robots with these radii in cells of the arrangement. Each of those is
/// scale x scale cells of the map.
bool is_solved(const test::Arrangement& a, int scale, const std::vector<double>& radii) {
  const OccupancyMap map = a.map(scale);
  std::vector<JointTask> tasks;
  for (std::size_t k = 0; k < a.starts.size(); ++k)
    tasks.push_back({a.centre(a.starts[k], scale), a.centre(a.goals[k], scale), radii[k] * scale});
  const ClearanceField field(map);
  MapRoadmaps roadmaps(field);
  const JointPlan plan = joint_plan(roadmaps, tasks, Random(1));
  const std::vector<Point2> ends = test::driven(map, tasks, plan);
  bool all_there = true;
  for (std::size_t k = 0; k < tasks.size(); ++k) all_there = all_there && ends[k] == *tasks[k].goal;
  EXPECT_EQ(all_there, plan.stranded.empty());
  return all_there;
}

bool is_solved(const test::Arrangement& a, int scale, double radius) {
  return is_solved(a, scale, std::vector<double>(a.starts.size(), radius));
}

unsigned seeds(unsigned usual) {
  return test::wants_long_tests() ? 20 * usual : usual;
}

TEST(SmallArrangements, KnownArrangementsAreSolvedInEveryOrientation) {
  for (const test::Arrangement& known : test::known_arrangements()) {
    ASSERT_TRUE(test::has_solution(known)) << test::drawing(known);
    for (const test::Arrangement& a : test::all_symmetries(known)) {
      for (const int scale : {1, 5}) {
        for (const double radius : {0.3, 0.4, 0.49})
          EXPECT_TRUE(is_solved(a, scale, radius)) << scale << ", " << radius << '\n' << test::drawing(a);
      }
    }
  }
}

TEST(SmallArrangements, ArrangementsThatAnExhaustiveSearchSolvesAreSolved) {
  for (const double radius : {0.3, 0.35, 0.4, 0.45, 0.49}) {
    for (unsigned seed = 1; seed <= seeds(50); ++seed) {
      Random random(seed);
      const test::Arrangement a = test::drawn_arrangement(random);
      EXPECT_TRUE(is_solved(a, 1, radius)) << "radius " << radius << ", seed " << seed << '\n'
                                           << test::drawing(a);
    }
  }
}

TEST(SmallArrangements, RobotsMayDifferInSize) {
  for (unsigned seed = 1; seed <= seeds(50); ++seed) {
    Random random(seed);
    const test::Arrangement a = test::drawn_arrangement(random);
    std::vector<double> radii;
    for (std::size_t k = 0; k < a.starts.size(); ++k) radii.push_back(random.uniform(0.3, 0.49));
    EXPECT_TRUE(is_solved(a, 1, radii)) << "seed " << seed << '\n' << test::drawing(a);
  }
}

// If the cells of the map are much smaller than a robot, vertices can be anywhere. Four robots that turn
// around in a narrow ring then have too many configurations.
TEST(SmallArrangements, NearlyAllAreSolvedForAnyAlignmentWithTheLattice) {
  unsigned not_solved = 0;
  unsigned all = 0;
  for (const int scale : {2, 5, 9, 20}) {
    for (const double radius : {0.35, 0.49}) {
      for (unsigned seed = 1; seed <= seeds(25); ++seed, ++all) {
        Random random(seed);
        not_solved += !is_solved(test::drawn_arrangement(random), scale, radius);
      }
    }
  }
  RecordProperty("not_solved", static_cast<int>(not_solved));
  EXPECT_LE(not_solved, all / 40);
}

}  // namespace
}  // namespace coppice
