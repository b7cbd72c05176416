#include "motion/cost_to_go.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace coppice {

CostToGo::CostToGo(const PlaceGraph& graph, Place goal, Place start)
    : graph_(&graph),
      goal_(goal),
      towards_(graph.at(start)),
      cost_(graph.size(), std::numeric_limits<float>::infinity()),
      settled_(graph.size(), false) {
  reach(goal, 0);
}

void CostToGo::reach(Place place, float cost) {
  if (settled_[place] || cost >= cost_[place]) return;
  cost_[place] = cost;
  open_.push_back({cost + (graph_->at(place) - towards_).norm(), cost, place});
  std::ranges::push_heap(open_, std::greater{}, &Entry::through);
}

float CostToGo::from(Place place) {
  while (!settled_[place] && !open_.empty()) {
    const Entry next = open_.front();
    std::ranges::pop_heap(open_, std::greater{}, &Entry::through);
    open_.pop_back();
    if (settled_[next.place]) continue;
    settled_[next.place] = true;
    for (const PlaceGraph::Edge& edge : graph_->edges(next.place))
      reach(edge.to, next.cost + static_cast<float>(edge.length));
  }
  return cost_[place];
}

}  // namespace coppice
