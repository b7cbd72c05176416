// Improves the paths of a whole fleet a little at a time, for as long as there is time.
//
// First each path is pulled taut within its homotopy class (path_shortening.h). Then all positions that the
// trees have found are linked to a roadmap, which all robots of one radius share, and the roadmap is searched
// for shorter ways. Then evenly spread vertices make the roadmap denser, until that gains almost nothing.
// Each robot's best path so far is available at any time.
//
// Metres. No clock: `step` is a bounded amount of work, some tens to hundreds of microseconds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "coppice/planning/random.h"
#include "planning/geometry/even_points.h"
#include "planning/geometry/path_shortening.h"
#include "planning/geometry/roadmap.h"
#include "planning/geometry/space.h"
#include "planning/trees/directed_sampler.h"
#include "planning/trees/trees.h"

namespace coppice {

template <Space S>
class PathImprover {
 public:
  static constexpr int D = S::dimension;
  using P = Point<D>;

  /// `space` must outlive it. `epsilon`: the step of the trees, which is the distance between their nodes,
  /// metres. `most_places`: largest number of roadmap vertices; in open space each takes 1 to 2 kB, nearly
  /// all of it for links.
  PathImprover(const S& space, double epsilon, Random random, std::size_t most_places = 40'000)
      : space_(space),
        reach_(reach_steps * epsilon),
        most_places_(most_places),
        random_(random),
        even_points_(space.bounds(), random_) {}

  /// Adds a roadmap vertex. A ball of `radius` must be free there.
  void add_place(const P& p, double radius) { places_.push_back({p, radius}); }
  /// Adds all nodes of the trees.
  void add_places(const Trees<D>& trees) {
    for (NodeId n = 0; n < trees.node_count(); ++n)
      add_place(trees.position(n), trees.tree(trees.tree_of(n)).radius);
  }
  std::size_t places() const { return places_.size(); }
  /// Adds a robot with its first path and returns its number. Allowed before the first step; after
  /// forget_robots() only with radii of earlier robots.
  std::size_t add_robot(std::vector<P> path, double radius) {
    robots_.push_back({std::move(path), radius, 0, 0});
    return robots_.size() - 1;
  }

  /// Starts again with other robots on the present roadmaps. If these are already as dense as is worth while,
  /// they are searched once.
  void forget_robots() {
    robots_.clear();
    stage_ = Stage::pull_taut;
    next_ = 0;
    round_ = 0;
    vain_ = 0;
  }

  const std::vector<P>& path(std::size_t robot) const { return robots_[robot].path; }

  /// Whether each path has been pulled taut.
  bool all_taut() const { return stage_ != Stage::pull_taut; }

  /// Does a bounded amount of work. Returns false once no shorter path turns up.
  bool step() {
    switch (stage_) {
      case Stage::pull_taut:
        return pull_taut();
      case Stage::link:
        return link_places();
      case Stage::search:
        return search();
      case Stage::done:
        return false;
    }
    return false;
  }

 private:
  enum class Stage : std::uint8_t { pull_taut, link, search, done };
  struct Place {
    P p;
    double radius;
  };
  struct Robot {
    std::vector<P> path;
    double radius;
    std::uint32_t start;  ///< vertex of the robot's roadmap
    std::uint32_t goal;
  };

  static constexpr double reach_steps = 1.5;  // in units of epsilon: as far as the next node but one
  static constexpr std::size_t places_a_step = 64;
  static constexpr std::size_t least_batch =
      400;  // new places of a round; later rounds add half as many again
  static constexpr int rounds_in_vain = 4;
  static constexpr int steps_to_edge = 8;  // each as long as the radius
  static constexpr double straight = 1 + 1e-9;

  static bool is_straight(const Robot& robot) {
    return robot.path.size() < 2 ||
           length_of(robot.path) <= straight * (robot.path.back() - robot.path.front()).norm();
  }
  double total() const {
    double sum = 0;
    for (const Robot& robot : robots_) sum += length_of(robot.path);
    return sum;
  }

  bool pull_taut() {
    if (next_ < robots_.size()) {
      robots_[next_].path = shorten(space_, std::move(robots_[next_].path), robots_[next_].radius);
      ++next_;
      return true;
    }
    if (std::ranges::all_of(robots_, is_straight)) {
      stage_ = Stage::done;
      return false;
    }
    for (Robot& robot : robots_) {
      if (is_straight(robot)) continue;
      auto& map = roadmaps_.try_emplace(robot.radius, space_, robot.radius, reach_).first->second;
      robot.start = map.add(robot.path.front());
      robot.goal = map.add(robot.path.back());
    }
    stage_ = Stage::link;
    return true;
  }

  /// Links a few vertices to each roadmap that they serve.
  bool link_places() {
    const std::size_t end = std::min(places_.size(), linked_ + places_a_step);
    for (; linked_ < end; ++linked_) {
      for (auto& [radius, map] : roadmaps_) {
        if (places_[linked_].radius >= radius) map.add(places_[linked_].p);
      }
    }
    if (linked_ < places_.size()) return true;
    next_ = 0;
    before_ = total();
    stage_ = Stage::search;
    return true;
  }

  /// Searches for one robot. After the last robot, begins another round or ends.
  bool search() {
    while (next_ < robots_.size() && is_straight(robots_[next_])) ++next_;
    if (next_ < robots_.size()) {
      Robot& robot = robots_[next_++];
      const double known = length_of(robot.path);
      std::vector<P> path = roadmaps_.at(robot.radius).path(robot.start, robot.goal, promising * known);
      if (path.empty()) return true;
      path = shorten(space_, std::move(path), robot.radius);
      if (length_of(path) < known) robot.path = std::move(path);
      return true;
    }
    vain_ = before_ - total() < shortening::least_gain * before_ && round_ > 0 ? vain_ + 1 : 0;
    ++round_;
    dense_ = dense_ || vain_ == rounds_in_vain || !draw_places();
    if (dense_) stage_ = Stage::done;
    return !dense_;
  }

  /// Draws evenly spread vertices for the next round. Returns false if the roadmaps are as dense as they may
  /// get.
  bool draw_places() {
    const std::size_t batch = std::max(least_batch, places_.size() / 2);
    if (places_.size() + batch > most_places_) return false;
    const double least_radius = roadmaps_.begin()->first;
    for (std::size_t k = 0; k < batch; ++k) {
      P p = even_points_.next();
      if (!space_.is_free(p, least_radius) && !move_to_edge(p, least_radius)) continue;
      double radius = least_radius;
      for (const auto& [larger, map] : roadmaps_) {
        if (larger > radius && space_.is_free(p, larger)) radius = larger;
      }
      places_.push_back({p, radius});
    }
    stage_ = Stage::link;
    return true;
  }

  /// Moves a point in an obstacle to the obstacle's edge in a random direction (OBPRM: Amato, Bayazit, Dale,
  /// Jones, Vallejo, 1998). Shortest paths run there, and many of these points lie in narrow gaps. Returns
  /// false if there is no edge near.
  bool move_to_edge(P& p, double radius) {
    const P direction = random_direction<D>(random_);
    for (int k = 1; k <= steps_to_edge; ++k) {
      const P there = p + k * radius * direction;
      if (!space_.is_free(there, radius)) continue;
      P inside = there - radius * direction;
      p = there;
      for (int halving = 0; halving < 4; ++halving) {
        const P middle = 0.5 * (inside + p);
        (space_.is_free(middle, radius) ? p : inside) = middle;
      }
      return true;
    }
    return false;
  }

  // A path on the roadmap is not taut: if it is a little longer than the best, it may still become shorter.
  static constexpr double promising = 1.1;

  const S& space_;
  double reach_;
  std::size_t most_places_;
  Random random_;
  EvenPoints<D> even_points_;
  std::vector<Place> places_;
  std::vector<Robot> robots_;
  std::map<double, Roadmap<S>> roadmaps_;  ///< by radius
  Stage stage_ = Stage::pull_taut;
  std::size_t next_ = 0;    ///< index of the next robot
  std::size_t linked_ = 0;  ///< number of vertices that are linked
  bool dense_ = false;
  double before_ = 0;
  int round_ = 0;
  int vain_ = 0;
};

}  // namespace coppice
