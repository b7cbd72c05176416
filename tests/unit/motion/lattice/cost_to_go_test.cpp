// Costs that are computed on demand, compared with the Bellman-Ford algorithm over all edges.
#include "motion/lattice/cost_to_go.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"

namespace coppice {
namespace {

/// Random points. Each is linked to nearby points by paths that are up to twice as long as the straight line.
AnnotatedRoadmap strewn(int count, Random& random) {
  AnnotatedRoadmap graph;
  for (int k = 0; k < count; ++k) graph.add(100 * Point2(random.uniform(), random.uniform()));
  for (Vertex a = 0; a < graph.size(); ++a) {
    for (Vertex b = 0; b < a; ++b) {
      const double straight = (graph.at(a) - graph.at(b)).norm();
      if (straight > 14) continue;
      const double length = straight * (1 + random.uniform());
      graph.own_edges(a).push_back({b, length, {}, {b}, 1 + random.uniform()});
      graph.own_edges(b).push_back({a, length, {}, {a}, 1 + random.uniform()});
    }
  }
  return graph;
}

std::vector<double> costs(const AnnotatedRoadmap& graph, Vertex goal) {
  std::vector<double> cost(graph.size(), std::numeric_limits<double>::infinity());
  cost[goal] = 0;
  for (std::size_t round = 0; round < graph.size(); ++round) {
    for (Vertex k = 0; k < graph.size(); ++k) {
      for (const AnnotatedRoadmap::Edge& edge : graph.edges(k))
        cost[edge.to] = std::min(cost[edge.to], cost[k] + edge.length * edge.cost_back);
    }
  }
  return cost;
}

TEST(CostToGo, TheCostIsThatOfTheCheapestWayInAnyOrderOfQueries) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const AnnotatedRoadmap graph = strewn(200, random);
    const auto goal = static_cast<Vertex>(random.index(graph.size()));
    const auto start = static_cast<Vertex>(random.index(graph.size()));
    const std::vector<double> right = costs(graph, goal);
    const std::vector<Vertex> numbers = numbers_by_neighbourhood(graph);
    CostToGo cost(graph, numbers, goal, start);
    for (int question = 0; question < 400; ++question) {
      const Vertex place = question == 0 ? start : static_cast<Vertex>(random.index(graph.size()));
      if (right[place] == std::numeric_limits<double>::infinity()) {
        EXPECT_EQ(cost.from(place), std::numeric_limits<float>::infinity());
      } else {
        EXPECT_NEAR(cost.from(place), right[place], 1e-3);
      }
    }
  }
}

}  // namespace
}  // namespace coppice
