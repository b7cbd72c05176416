// Tests of clusters on a graph of vertices. Each move is checked against the graph's own lists.
#include "motion/joint/lacam.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

/// Vertices in a grid that are linked to their neighbours. Robots at different vertices never touch.
AnnotatedRoadmap grid(int columns, int rows) {
  AnnotatedRoadmap graph;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) graph.add(Point2(i, j));
  }
  for (Vertex a = 0; a < graph.size(); ++a) {
    for (Vertex b = 0; b < graph.size(); ++b) {
      if ((graph.at(a) - graph.at(b)).norm() == 1)
        graph.own_edges(a).push_back({b, 1, {graph.at(a), graph.at(b)}, {b}});
    }
  }
  return graph;
}

/// Makes the moves and checks that each finds its edge clear. Returns the final vertex of each robot.
std::vector<Vertex> made(const AnnotatedRoadmap& graph, const std::vector<VertexTask>& tasks,
                         const std::vector<VertexMove>& moves) {
  std::vector<Vertex> at;
  for (const VertexTask& task : tasks) at.push_back(task.start);
  for (const VertexMove& move : moves) {
    EXPECT_EQ(at[move.robot], move.from);
    const AnnotatedRoadmap::Edge& edge = graph.edges(move.from)[move.edge];
    for (std::uint32_t i = 0; i < at.size(); ++i) {
      const bool in_the_way = std::ranges::find(edge.near, at[i]) != edge.near.end();
      EXPECT_FALSE(i != move.robot && in_the_way);
    }
    at[move.robot] = edge.to;
  }
  return at;
}

void expect_solved(const AnnotatedRoadmap& graph, const std::vector<VertexTask>& tasks) {
  Cluster cluster(graph, tasks);
  Lacam lacam(cluster, Random(1));
  ASSERT_EQ(lacam.search(100'000), SearchState::solved);
  const std::vector<Vertex> at = made(graph, tasks, lacam.moves());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    EXPECT_EQ(at[i], tasks[i].goal.value_or(at[i]));
  }
}

TEST(Lacam, TwoRobotsChangeVertices) {
  expect_solved(grid(2, 2), {{0, 3}, {3, 0}});
}

TEST(Lacam, AGridWithOneFreeVertexIsSolvedLikeASlidingPuzzle) {
  // Eight robots on nine vertices, with one row reversed. Only one robot can move at a time.
  expect_solved(grid(3, 3), {{0, 1}, {1, 2}, {2, 5}, {3, 0}, {4, 4}, {5, 8}, {6, 3}, {7, 6}});
}

TEST(Lacam, ARobotWithoutAGoalGivesWay) {
  expect_solved(grid(5, 2), {{0, 4}, {2, std::nullopt}, {7, std::nullopt}});
}

TEST(Lacam, AProblemWithoutASolutionIsProved) {
  const AnnotatedRoadmap graph = grid(6, 1);
  Cluster cluster(graph, {{0, 5}, {5, 0}});
  Lacam lacam(cluster, Random(1));
  EXPECT_EQ(lacam.search(100'000), SearchState::gave_up);
}

TEST(Lacam, ARobotThatCannotReachItsGoalGivesWay) {
  AnnotatedRoadmap graph = grid(5, 2);
  const Vertex cell = graph.add(Point2(9, 9));
  Cluster cluster(graph, {{0, 4}, {2, cell}, {7, 6}});
  EXPECT_EQ(cluster.shut_in(), std::vector<std::uint32_t>{1});
  Lacam lacam(cluster, Random(1));
  ASSERT_EQ(lacam.search(100'000), SearchState::solved);
  const std::vector<Vertex> at = made(graph, {{0, 4}, {2, cell}, {7, 6}}, lacam.moves());
  EXPECT_EQ(at[0], 4u);
  EXPECT_EQ(at[2], 6u);
}

TEST(Lacam, TheSearchStopsAtItsLimit) {
  const AnnotatedRoadmap graph = grid(6, 1);
  Cluster cluster(graph, {{0, 5}, {5, 0}});
  Lacam lacam(cluster, Random(1));
  EXPECT_EQ(lacam.search(3), SearchState::searching);
  EXPECT_EQ(lacam.under_way(), (std::vector<std::uint32_t>{0, 1}));
}

// Each vertex touches its neighbours: two robots never stand next to each other nor pass a third.
TEST(Lacam, VerticesThatTouchAreNotOccupiedTogether) {
  AnnotatedRoadmap graph = grid(9, 3);
  for (Vertex a = 0; a < graph.size(); ++a) {
    for (AnnotatedRoadmap::Edge& edge : graph.own_edges(a)) {
      edge.near.clear();
      for (Vertex k = 0; k < graph.size(); ++k) {
        if (k != a && (graph.at(k) - graph.at(edge.to)).norm() < 1.1) edge.near.push_back(k);
      }
    }
  }
  expect_solved(graph, {{0, 8}, {8, 0}, {18, 26}, {26, 18}});
}

TEST(Lacam, TheSameSeedMakesTheSameMoves) {
  const AnnotatedRoadmap graph = grid(8, 8);
  std::vector<VertexTask> tasks;
  for (Vertex k = 0; k < 20; ++k) tasks.push_back({k, 63 - k});
  Cluster cluster(graph, tasks);
  Lacam a(cluster, Random(3));
  Lacam b(cluster, Random(3));
  ASSERT_EQ(a.search(10'000), SearchState::solved);
  ASSERT_EQ(b.search(10'000), SearchState::solved);
  ASSERT_EQ(a.moves().size(), b.moves().size());
  for (std::size_t k = 0; k < a.moves().size(); ++k) EXPECT_EQ(a.moves()[k].edge, b.moves()[k].edge);
}

}  // namespace
}  // namespace coppice
