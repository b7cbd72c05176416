// Records which inactive trees are connected. All groups share this knowledge by reference.
//
// Two inactive trees that see each other are linked. Linked trees form a *component*. A group that grafted
// one tree of a component has all of it, so a graft is one entry in a list. When two components are united,
// their lists tell the groups whose root trees meet by that (union-find, the shorter list is appended to the
// longer).
//
// A link is free for robots up to some radius, so there is a *layer* of components for each radius of a
// group. Components of a layer only grow.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "planning/trees/trees.h"

namespace coppice {

class Forest {
 public:
  using Layer = std::size_t;
  static constexpr Layer no_layer = std::numeric_limits<Layer>::max();

  struct Graft {
    GroupIndex group;
    Root side;
  };

  /// The layer of robots of `radius`, metres. A new layer is made from the links so far.
  Layer layer(double radius) {
    for (Layer l = 0; l < layers_.size(); ++l) {
      if (layers_[l].radius == radius) return l;
    }
    layers_.push_back({.radius = radius, .above = {}, .trees = {}, .grafts = {}});
    for (const Link& link : links_) {
      if (link.radius >= radius) unite(layers_.back(), link.a, link.b, [](const Graft&) {});
    }
    return layers_.size() - 1;
  }

  /// The layer of the largest robots that may use trees or links of `radius`; no_layer if there is none.
  Layer layer_within(double radius) const {
    Layer best = no_layer;
    for (Layer l = 0; l < layers_.size(); ++l) {
      if (layers_[l].radius <= radius && (best == no_layer || layers_[l].radius > layers_[best].radius))
        best = l;
    }
    return best;
  }

  /// The component of a tree, named by one of its trees.
  TreeIndex component(Layer l, TreeIndex t) const { return find(layers_[l], t); }
  std::uint32_t trees_in(Layer l, TreeIndex component) const { return layers_[l].trees[component]; }

  void graft(Layer l, TreeIndex t, const Graft& graft) {
    layers_[l].grafts[find(layers_[l], t)].push_back(graft);
  }

  /// Links two trees that see each other for robots up to `radius`. Before a component becomes part of
  /// another, calls met(layer, graft) for each of its grafts.
  template <class Met>
  void link(TreeIndex a, TreeIndex b, double radius, Met&& met) {
    links_.push_back({a, b, radius});
    for (Layer l = 0; l < layers_.size(); ++l) {
      if (layers_[l].radius <= radius) unite(layers_[l], a, b, [&](const Graft& g) { met(l, g); });
    }
  }

 private:
  struct Link {
    TreeIndex a;
    TreeIndex b;
    double radius;
  };
  struct Components {
    double radius = 0;
    mutable std::vector<TreeIndex> above;  ///< path halving: a look-up shortens the chain for the next one
    mutable std::vector<std::uint32_t> trees;
    mutable std::vector<std::vector<Graft>> grafts;
  };

  static TreeIndex find(const Components& c, TreeIndex t) {
    if (t >= c.above.size()) {
      const std::size_t before = c.above.size();
      c.above.resize(2 * t + 64);
      std::iota(c.above.begin() + static_cast<std::ptrdiff_t>(before), c.above.end(),
                static_cast<TreeIndex>(before));
      c.trees.resize(c.above.size(), 1);
      c.grafts.resize(c.above.size());
    }
    while (c.above[t] != t) t = c.above[t] = c.above[c.above[t]];
    return t;
  }

  template <class Met>
  static void unite(Components& c, TreeIndex a, TreeIndex b, Met&& met) {
    a = find(c, a);
    b = find(c, b);
    if (a == b) return;
    if (c.trees[a] + c.grafts[a].size() < c.trees[b] + c.grafts[b].size()) std::swap(a, b);
    for (const Graft& graft : c.grafts[b]) met(graft);
    c.above[b] = a;
    c.trees[a] += c.trees[b];
    c.grafts[a].insert(c.grafts[a].end(), c.grafts[b].begin(), c.grafts[b].end());
    c.grafts[b] = {};
  }

  std::vector<Components> layers_;
  std::vector<Link> links_;
};

}  // namespace coppice
