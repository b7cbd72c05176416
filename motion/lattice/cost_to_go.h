// The cost of the cheapest way from a vertex to a goal, computed on demand: reverse resumable A* (Silver,
// "Cooperative Pathfinding", 2005). The cost of a way is its length, but more along left lanes.
//
// A robot of a cluster asks for the vertices around it and along its way, while its goal may be at the other
// end of the map. Visiting all vertices for each robot would cost most of the time and memory of a joint
// plan.
//
// Metres.
#pragma once

#include <array>
#include <bitset>
#include <memory>
#include <span>
#include <vector>

#include "motion/lattice/annotated_roadmap.h"

namespace coppice {

/// Numbers the vertices so that vertices that are near each other have close numbers. The result is indexed
/// by vertex. `graph` must not be empty.
std::vector<Vertex> numbers_by_neighbourhood(const AnnotatedRoadmap& graph);

class CostToGo {
 public:
  /// `graph` and `numbers` (numbers_by_neighbourhood) must outlive it. The search goes from `goal` towards
  /// `start`, where the first queries are.
  CostToGo(const AnnotatedRoadmap& graph, std::span<const Vertex> numbers, Vertex goal, Vertex start);

  /// The cost of the cheapest way from `place` to the goal; infinite if there is none.
  float from(Vertex place);

 private:
  struct Entry {
    double through;  ///< lower bound of the length of a way from `start` to the goal through this vertex
    float cost;
    Vertex place;
  };
  /// Costs of vertices with neighbouring numbers.
  struct Known {
    static constexpr Vertex places = 16;
    std::array<float, places> cost;  ///< the least cost so far
    std::bitset<places> settled{};
  };
  void reach(Vertex place, float cost);
  bool settled(Vertex place) const {
    const auto& known = known_[numbers_[place] / Known::places];
    return known && known->settled[numbers_[place] % Known::places];
  }

  const AnnotatedRoadmap* graph_;
  std::span<const Vertex> numbers_;
  Point2 towards_;
  std::vector<std::unique_ptr<Known>> known_;  ///< null: no vertex of the block has been reached
  std::vector<Entry> open_;                    ///< a heap
};

}  // namespace coppice
