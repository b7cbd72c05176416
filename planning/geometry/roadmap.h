// A roadmap over the positions that the trees have found, and the short paths through it.
//
// A tree has one way between two of its nodes, so a path along it may pass obstacles on the wrong side. Here
// all vertices that see each other within a reach are linked (a probabilistic roadmap: Kavraki, Svestka,
// Latombe, Overmars, 1996, on positions that MA-RRdT* has already checked). The search is Lazy Theta* (Nash,
// Koenig, Tovey, 2010): A* in which a node's parent may be any earlier node that it sees. So lengths are
// nearly those of taut paths, and the right homotopy class wins.
//
// Metres.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include "planning/geometry/neighbour_grid.h"
#include "planning/geometry/space.h"

namespace coppice {

template <Space S>
class Roadmap {
 public:
  static constexpr int D = S::dimension;
  using P = Point<D>;

  /// A roadmap for balls of `radius`. Vertices are linked within `reach` (above 0), and within less as their
  /// number grows.
  Roadmap(const S& space, double radius, double reach)
      : space_(space),
        radius_(radius),
        reach_(reach),
        dense_reach_(reach_of_prm_star(space.bounds())),
        grid_(space.bounds(), reach) {}

  double radius() const { return radius_; }
  std::size_t size() const { return places_.size(); }

  /// Adds a vertex at which a ball of the radius is free, and links it to all earlier vertices that it sees
  /// within the reach. Returns its number.
  std::uint32_t add(const P& p) {
    const auto q = static_cast<std::uint32_t>(places_.size());
    places_.push_back(p);
    first_link_.push_back(none);
    const auto count = static_cast<double>(std::max<std::size_t>(places_.size(), 3));
    const double reach = std::min(reach_, dense_reach_ * std::pow(std::log(count) / count, 1.0 / D));
    grid_.for_each_near(p, [&](NodeId n, const P& place) {
      const double squared = (place - p).squaredNorm();
      if (squared > reach * reach || !space_.segment_free(place, p, radius_)) return;
      link(n, q);
      link(q, n);
    });
    grid_.insert(p);
    return q;
  }

  /// A path from one vertex to another that is free for the radius and about as short as the roadmap allows.
  /// Empty if the roadmap does not connect them within `shorter_than` metres.
  std::vector<P> path(std::uint32_t from, std::uint32_t to,
                      double shorter_than = std::numeric_limits<double>::infinity()) {
    begin_search();
    const auto estimate = [&](std::uint32_t n) { return (places_[n] - places_[to]).norm(); };
    label(from) = {search_, false, from, 0};
    open_.emplace(estimate(from), from);
    while (!open_.empty()) {
      const std::uint32_t n = open_.top().second;
      open_.pop();
      if (label(n).closed) continue;
      label(n).closed = true;
      see_parent(n);
      if (n == to) break;
      const std::uint32_t parent = label(n).parent;
      for (std::uint32_t e = first_link_[n]; e != none; e = links_[e].next) {
        const std::uint32_t m = links_[e].to;
        Label& there = label(m);
        if (there.closed) continue;
        const double cost = label(parent).cost + (places_[parent] - places_[m]).norm();
        const double through = cost + estimate(m);
        if (cost >= there.cost || through >= shorter_than) continue;
        there.cost = cost;
        there.parent = parent;
        open_.emplace(through, m);
      }
    }
    std::vector<P> points;
    if (!label(to).closed) return points;
    for (std::uint32_t n = to; n != from; n = label(n).parent) points.push_back(places_[n]);
    points.push_back(places_[from]);
    std::reverse(points.begin(), points.end());
    return points;
  }

 private:
  /// If vertices are linked within this times (log n / n)^(1/D), each of n vertices has about log n links,
  /// and the paths still converge to the shortest ones (PRM*: Karaman, Frazzoli, "Sampling-based Algorithms
  /// for Optimal Motion Planning", 2011). The factor 1.4 increases the reach, so that fewer vertices are
  /// needed.
  static double reach_of_prm_star(const Box<D>& box) {
    const double ball = std::pow(std::numbers::pi, D / 2.0) / std::tgamma(D / 2.0 + 1);
    return 1.4 * 2 * std::pow((1 + 1.0 / D) * (box.upper - box.lower).prod() / ball, 1.0 / D);
  }

  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Link {
    std::uint32_t to;
    std::uint32_t next;
  };
  struct Label {
    std::uint32_t search = 0;
    bool closed = false;
    std::uint32_t parent = 0;
    double cost = std::numeric_limits<double>::infinity();
  };

  void link(std::uint32_t from, std::uint32_t to) {
    links_.push_back({to, first_link_[from]});
    first_link_[from] = static_cast<std::uint32_t>(links_.size() - 1);
  }

  void begin_search() {
    ++search_;
    labels_.resize(places_.size());
    open_ = {};
  }
  Label& label(std::uint32_t n) {
    Label& l = labels_[n];
    if (l.search != search_) l = {search_, false, n, std::numeric_limits<double>::infinity()};
    return l;
  }

  /// The node was given its parent without a check of visibility. If it does not see the parent, it takes the
  /// best neighbour instead.
  void see_parent(std::uint32_t n) {
    Label& here = label(n);
    if (space_.segment_free(places_[here.parent], places_[n], radius_)) return;
    here.cost = std::numeric_limits<double>::infinity();
    for (std::uint32_t e = first_link_[n]; e != none; e = links_[e].next) {
      const Label& there = label(links_[e].to);
      if (!there.closed || links_[e].to == n) continue;
      const double cost = there.cost + (places_[links_[e].to] - places_[n]).norm();
      if (cost >= here.cost) continue;
      here.cost = cost;
      here.parent = links_[e].to;
    }
  }

  const S& space_;
  double radius_;
  double reach_;
  double dense_reach_;
  NeighbourGrid<D> grid_;
  std::vector<P> places_;
  std::vector<std::uint32_t> first_link_;
  std::vector<Link> links_;
  std::vector<Label> labels_;
  std::uint32_t search_ = 0;
  std::priority_queue<std::pair<double, std::uint32_t>, std::vector<std::pair<double, std::uint32_t>>,
                      std::greater<>>
      open_;
};

}  // namespace coppice
