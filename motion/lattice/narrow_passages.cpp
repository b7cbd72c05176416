#include "motion/lattice/narrow_passages.h"

#include <algorithm>
#include <bitset>
#include <functional>
#include <queue>
#include <utility>

namespace coppice {

template <class Fn>
void NarrowPassages::for_each_neighbour(Vertex v, Fn&& fn) {
  lattice_.for_each_neighbour(
      v, [](Vertex) { return true; }, std::forward<Fn>(fn));
}

bool NarrowPassages::is_narrow(Vertex v) {
  const auto [known, fresh] = narrow_.try_emplace(v, true);
  if (!fresh) return known->second;
  bool narrow = true;
  const Point2 p = lattice_.at(v);
  lattice_.for_each_near(p, p, wide_,
                         [&](Vertex w) { narrow = narrow && field_.lower_bound(lattice_.at(w)) < wide_; });
  return narrow_[v] = narrow;
}

std::vector<NarrowPassages::Vertex> NarrowPassages::ends(const Point2& centre, double reach) {
  std::vector<Vertex> ends;
  lattice_.for_each_near(centre, centre, reach, [&](Vertex v) {
    if (!lattice_.vertex_free(v) || !seen_.insert(v).second) return;
    std::bitset<8> directions;
    for_each_neighbour(v, [&](Vertex w, double) { directions.set(lattice_.direction(v, w)); });
    if ((directions & directions >> 4).none() && is_narrow(v)) ends.push_back(v);
  });
  return ends;
}

std::vector<Point2> NarrowPassages::stack_from(Vertex end, double apart, double reach) {
  using Entry = std::pair<double, Vertex>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::unordered_map<Vertex, double> distance{{end, 0}};
  open.emplace(0, end);
  std::vector<Point2> stack;
  while (!open.empty()) {
    const double here = open.top().first;
    const Vertex v = open.top().second;
    open.pop();
    if (here > distance.at(v) || !is_narrow(v)) continue;
    const Point2 p = lattice_.at(v);
    if (std::ranges::all_of(stack, [&](const Point2& q) { return (p - q).norm() >= apart; }))
      stack.push_back(p);
    for_each_neighbour(v, [&](Vertex w, double metres) {
      const auto [known, fresh] = distance.try_emplace(w, here + metres);
      if (here + metres > reach || (!fresh && known->second <= here + metres)) return;
      known->second = here + metres;
      open.emplace(here + metres, w);
    });
  }
  return stack;
}

}  // namespace coppice
