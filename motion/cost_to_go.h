// How far it is from any place to a goal, found out as far as it is asked for: reverse resumable A* (Silver,
// "Cooperative Pathfinding", 2005).
//
// A robot of a crowd asks for the places around it and for those along its way, and its goal may be at the
// other end of the map: looking at all places for each robot would cost most of a joint plan.
//
// Metres.
#pragma once

#include <vector>

#include "motion/place_graph.h"

namespace coppice {

class CostToGo {
 public:
  /// `graph` outlives it. The search goes from `goal` towards `start`, where the first questions are.
  CostToGo(const PlaceGraph& graph, Place goal, Place start);

  Place goal() const { return goal_; }
  /// The length of the shortest way; infinite where there is none.
  float from(Place place);

 private:
  struct Entry {
    double through;  ///< at least the length of a way from `start` to the goal over this place
    float cost;
    Place place;
  };
  void reach(Place place, float cost);

  const PlaceGraph* graph_;
  Place goal_;
  Point2 towards_;
  std::vector<float> cost_;  ///< by place; the least so far
  std::vector<bool> settled_;
  std::vector<Entry> open_;  ///< a heap
};

}  // namespace coppice
