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

#include "motion/place_graph.h"

namespace coppice {

/// By the place, its number among all: close to those of the places around it. `graph` is not empty.
std::vector<Place> numbers_by_neighbourhood(const PlaceGraph& graph);

class CostToGo {
 public:
  /// `graph`, and the `numbers` of its places (numbers_by_neighbourhood), outlive it. The search goes from
  /// `goal` towards `start`, where the first questions are.
  CostToGo(const PlaceGraph& graph, std::span<const Place> numbers, Place goal, Place start);

  /// The length of the shortest way; infinite where there is none.
  float from(Place place);

 private:
  struct Entry {
    double through;  ///< at least the length of a way from `start` to the goal over this place
    float cost;
    Place place;
  };
  /// What is known of places of one neighbourhood.
  struct Known {
    static constexpr Place places = 16;
    std::array<float, places> cost;  ///< the least so far
    std::bitset<places> settled{};
  };
  void reach(Place place, float cost);
  bool settled(Place place) const {
    const auto& known = known_[numbers_[place] / Known::places];
    return known && known->settled[numbers_[place] % Known::places];
  }

  const PlaceGraph* graph_;
  std::span<const Place> numbers_;
  Point2 towards_;
  std::vector<std::unique_ptr<Known>> known_;  ///< null: nothing
  std::vector<Entry> open_;                    ///< a heap
};

}  // namespace coppice
