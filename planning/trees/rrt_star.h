// RRT*: one tree from the start, for one robot. It is the baseline for MA-RRdT*: MA-RRT* is one RRT* for each
// robot, with nothing shared.
//
// Karaman, Frazzoli, "Sampling-based Algorithms for Optimal Motion Planning", 2011, Algorithm 6, until the
// first node that sees the goal within a step. It uses the same trees, neighbour grid and collision checks as
// MA-RRdT*. Metres.
#pragma once

#include <algorithm>
#include <vector>

#include "coppice/planning/random.h"
#include "planning/geometry/space.h"
#include "planning/trees/directed_sampler.h"
#include "planning/trees/rewiring.h"
#include "planning/trees/trees.h"

namespace coppice {

template <Space S>
class RrtStar {
 public:
  static constexpr int D = S::dimension;
  using P = Point<D>;

  /// From `start` to `goal`, both free for a ball of `radius`, in steps of at most `epsilon`. `space` must
  /// outlive it.
  RrtStar(const S& space, const P& start, const P& goal, double radius, double epsilon, Random random)
      : space_(space),
        goal_(goal),
        radius_(radius),
        epsilon_(epsilon),
        random_(random),
        trees_(space.bounds(), epsilon),
        tree_(trees_.add_tree(TreeKind::root, radius)) {
    trees_.add_node(tree_, start);
    look_for_goal(0);
  }

  bool solved() const { return last_ != no_node; }

  /// Draws one sample. Returns false once the goal is reached.
  bool step() {
    if (solved()) return false;
    const P sample = random_.uniform() < goal_bias ? goal_ : random_point(space_.bounds(), random_);
    const NodeId nearest = trees_.grid().nearest(sample, [](NodeId) { return true; });
    const P gap = sample - trees_.position(nearest);
    const double distance = gap.norm();
    if (distance == 0) return true;
    const P p = distance <= epsilon_ ? sample : P(trees_.position(nearest) + gap * (epsilon_ / distance));
    if (!space_.segment_free(trees_.position(nearest), p, radius_)) {
      ++invalid_;
      return true;
    }
    ++valid_;
    look_for_goal(join(nearest, p));
    return true;
  }

  std::vector<P> path() const {
    std::vector<P> points;
    if (!solved()) return points;
    points.push_back(goal_);
    for (NodeId n = last_; n != no_node; n = trees_.parent(n)) points.push_back(trees_.position(n));
    std::ranges::reverse(points);
    return points;
  }

  std::uint32_t valid() const { return valid_; }
  std::uint32_t invalid() const { return invalid_; }

 private:
  static constexpr double goal_bias = 0.05;

  NodeId join(NodeId nearest, const P& p) {
    trees_.grid().collect_near(p, epsilon_, near_);
    std::vector<NodeId> seen{nearest};
    for (const NodeId n : near_) {
      if (n != nearest && space_.segment_free(trees_.position(n), p, radius_)) seen.push_back(n);
    }
    const NodeId q = trees_.add_node(tree_, p);
    choose_parent_and_rewire<D>(trees_, q, seen);
    return q;
  }

  void look_for_goal(NodeId n) {
    const P& p = trees_.position(n);
    if ((p - goal_).norm() <= epsilon_ && space_.segment_free(p, goal_, radius_)) last_ = n;
  }

  const S& space_;
  P goal_;
  double radius_;
  double epsilon_;
  Random random_;
  Trees<D> trees_;
  TreeIndex tree_;
  std::vector<NodeId> near_;
  NodeId last_ = no_node;  ///< the node that sees the goal
  std::uint32_t valid_ = 0;
  std::uint32_t invalid_ = 0;
};

}  // namespace coppice
