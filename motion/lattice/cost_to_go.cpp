#include "motion/lattice/cost_to_go.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace coppice {

namespace {

constexpr float unknown = std::numeric_limits<float>::infinity();

/// Interleaves the bits of x and y (Morton order): consecutive numbers lie near each other on the map.
std::uint32_t interleaved(std::uint32_t x, std::uint32_t y) {
  std::uint32_t bits = 0;
  for (std::uint32_t k = 0; k < 16; ++k) bits |= (x >> k & 1) << 2 * k | (y >> k & 1) << (2 * k + 1);
  return bits;
}

}  // namespace

std::vector<Vertex> numbers_by_neighbourhood(const AnnotatedRoadmap& graph) {
  Box<2> box{graph.at(0), graph.at(0)};
  for (Vertex k = 0; k < graph.size(); ++k)
    box = {box.lower.cwiseMin(graph.at(k)), box.upper.cwiseMax(graph.at(k))};
  const double per_metre = 65535 / std::max(1.0, (box.upper - box.lower).maxCoeff());
  std::vector<std::pair<std::uint32_t, Vertex>> order;
  for (Vertex k = 0; k < graph.size(); ++k) {
    const Point2 p = per_metre * (graph.at(k) - box.lower);
    order.emplace_back(interleaved(static_cast<std::uint32_t>(p.x()), static_cast<std::uint32_t>(p.y())), k);
  }
  std::ranges::sort(order);
  std::vector<Vertex> numbers(graph.size());
  for (Vertex n = 0; n < order.size(); ++n) numbers[order[n].second] = n;
  return numbers;
}

CostToGo::CostToGo(const AnnotatedRoadmap& graph, std::span<const Vertex> numbers, Vertex goal, Vertex start)
    : graph_(&graph),
      numbers_(numbers),
      towards_(graph.at(start)),
      known_((graph.size() + Known::places - 1) / Known::places) {
  reach(goal, 0);
}

void CostToGo::reach(Vertex place, float cost) {
  const Vertex number = numbers_[place];
  std::unique_ptr<Known>& known = known_[number / Known::places];
  if (!known) {
    known = std::make_unique<Known>();
    known->cost.fill(unknown);
  }
  float& least = known->cost[number % Known::places];
  if (known->settled[number % Known::places] || cost >= least) return;
  least = cost;
  open_.push_back({cost + (graph_->at(place) - towards_).norm(), cost, place});
  std::ranges::push_heap(open_, std::greater{}, &Entry::through);
}

float CostToGo::from(Vertex place) {
  while (!settled(place) && !open_.empty()) {
    const Entry next = open_.front();
    std::ranges::pop_heap(open_, std::greater{}, &Entry::through);
    open_.pop_back();
    if (settled(next.place)) continue;
    const Vertex number = numbers_[next.place];
    known_[number / Known::places]->settled.set(number % Known::places);
    for (const AnnotatedRoadmap::Edge& edge : graph_->edges(next.place))
      reach(edge.to, next.cost + static_cast<float>(edge.length * edge.cost_back));
  }
  const auto& known = known_[numbers_[place] / Known::places];
  return known ? known->cost[numbers_[place] % Known::places] : unknown;
}

}  // namespace coppice
