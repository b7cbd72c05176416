// Tests of the roadmap of a cluster: robots of several sizes on one roadmap.
#include "motion/joint/cluster_roadmap.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

using test::block;
using test::open_map;

/// A hall with a wall that has a door 8 m wide.
OccupancyMap hall_with_a_door() {
  OccupancyMap map = open_map(60, 40);
  block(map, 29, 0, 31, 16);
  block(map, 29, 24, 31, 40);
  return map;
}

// A robot that drives along an edge touches those that stand at the vertices near it, and no others.
TEST(ClusterRoadmap, EdgesKnowWhomTheyTouchWhateverTheirSizes) {
  const ClearanceField field(hall_with_a_door());
  MapRoadmaps roadmaps(field);
  const std::vector<JointTask> tasks{{{10, 10}, Point2(50, 10), 5}, {{20, 30}, Point2(50, 30), 2}};
  ClusterRoadmap roadmap(roadmaps, tasks, {}, {});
  const AnnotatedRoadmap& graph = roadmap.cluster().graph();
  std::size_t of_other_sizes = 0;
  for (Vertex from = 0; from < graph.size(); ++from) {
    for (const AnnotatedRoadmap::Edge& edge : graph.edges(from)) {
      EXPECT_EQ(graph.radius(edge.to), graph.radius(from));
      for (Vertex other = 0; other < graph.size(); ++other) {
        if (graph.radius(other) == graph.radius(from) || graph.touch(other, from)) continue;
        const bool touches = point_path_distance(graph.at(other), edge.path) <
                             graph.radius(other) + graph.radius(from) + standing_gap - 1e-6;
        of_other_sizes += touches;
        EXPECT_EQ(std::ranges::binary_search(edge.near, other), touches);
      }
    }
  }
  EXPECT_GT(of_other_sizes, 0u);
}

// The small robot counts as large as the other one only where there is room for that.
TEST(ClusterRoadmap, ARobotCountsAsLargerWhereItHasRoom) {
  const ClearanceField field(hall_with_a_door());
  MapRoadmaps roadmaps(field);
  const auto sizes = [&](const Point2& start, double most_growth) {
    const std::vector<JointTask> tasks{{{10, 10}, Point2(20, 10), 5}, {start, Point2(20, 30), 3}};
    ClusterRoadmap roadmap(roadmaps, tasks, {}, {.most_growth = most_growth});
    const Cluster& cluster = roadmap.cluster();
    return cluster.graph().radius(cluster.tasks()[1].start);
  };
  EXPECT_EQ(sizes({10, 30}, 2), 5);
  EXPECT_EQ(sizes({10, 30}, 1.2), 3);
  EXPECT_EQ(sizes({3.5, 30}, 2), 3);  // at a wall
  EXPECT_EQ(sizes({45, 30}, 2), 3);   // behind a door that is too narrow for the large one
}

TEST(ClusterRoadmap, RobotsThatDoNotEndAtTheirGoalsAreStranded) {
  const ClearanceField field(hall_with_a_door());
  MapRoadmaps roadmaps(field);
  const std::vector<JointTask> tasks{
      {{10, 10}, Point2(10, 10), 2}, {{10, 30}, Point2(50, 30), 2}, {{20, 20}, std::nullopt, 2}};
  ClusterRoadmap roadmap(roadmaps, tasks, {}, {});
  EXPECT_EQ(roadmap.plan_of({}).stranded, std::vector<std::size_t>{1});
}

}  // namespace
}  // namespace coppice
