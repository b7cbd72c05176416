// How far it is from any place to a goal, found out as far as it is asked for: reverse resumable A* (Silver,
// "Cooperative Pathfinding", 2005).
//
// A robot of a crowd asks for the places around it and for those along its way, and its goal may be at the
// other end of the map: looking at all places for each robot would cost most of a joint plan, and most of its
// memory to remember that it has not.
//
// Metres.
#pragma once

#include <array>
#include <bitset>
#include <memory>
#include <span>
#include <vector>

#include "motion/annotated_roadmap.h"

namespace coppice {

/// By the place, its number among all: close to those of the places around it. `graph` is not empty.
std::vector<Vertex> numbers_by_neighbourhood(const AnnotatedRoadmap& graph);

class CostToGo {
 public:
  /// `graph`, and the `numbers` of its places (numbers_by_neighbourhood), outlive it. The search goes from
  /// `goal` towards `start`, where the first questions are.
  CostToGo(const AnnotatedRoadmap& graph, std::span<const Vertex> numbers, Vertex goal, Vertex start);

  /// The length of the shortest way; infinite where there is none.
  float from(Vertex place);

 private:
  struct Entry {
    double through;  ///< at least the length of a way from `start` to the goal over this place
    float cost;
    Vertex place;
  };
  /// What is known of places of one neighbourhood.
  struct Known {
    static constexpr Vertex places = 16;
    std::array<float, places> cost;  ///< the least so far
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
  std::vector<std::unique_ptr<Known>> known_;  ///< null: nothing
  std::vector<Entry> open_;                    ///< a heap
};

}  // namespace coppice
