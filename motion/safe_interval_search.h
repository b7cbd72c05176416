// Plans the trajectory of a disc in space and time, past the trajectories of others.
//
// Safe interval path planning (Phillips, Likhachev, "SIPP: Safe Interval Path Planning for Dynamic
// Environments", 2011): a state is a vertex and an interval of time in which nobody comes there, and the
// earliest arrival in it counts. Any-angle (Yakovlev, Andreychuk, "Any-Angle Pathfinding for Multiple Agents
// Based on SIPP Algorithm", 2017): a state may also be reached straight from the parent of the state that it
// is reached from.
//
// The vertices are those of a lattice (lattice.h) and the points of a path that exists anyway. So passages
// that the lattice misses are found.
//
// Metres in the map frame, seconds of fleet time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "motion/kinematics.h"
#include "motion/lattice.h"
#include "motion/space_time.h"
#include "motion/trajectory.h"
#include "planning/clearance_field.h"

namespace coppice {

class SafeIntervalSearch {
 public:
  /// All must outlive it. `lattice`: of the disc's radius. `path`: from the start to the goal.
  SafeIntervalSearch(const ClearanceField& field, Lattice& lattice, double radius, const Path& path);

  /// The trajectory with the earliest arrival that the vertices allow. It begins where the path begins, at
  /// `begin`, and is at rest or at full speed. It stands where it slows down for a corner, for as long as it
  /// loses there, and so after each wait. Nothing if there is none that arrives before `before`, or if this
  /// search or all together take too long.
  std::optional<Trajectory> search(SpaceTime& others, double begin, const Limits& limits,
                                   double before = SpaceTime::forever);

 private:
  using Vertex = std::uint32_t;
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  struct State {
    Vertex vertex;
    double safe_until;
    double time;  ///< of arrival
    std::uint32_t parent;
    bool closed = false;
  };
  struct Known {  ///< of a vertex
    std::vector<Interval> safe{};
    std::vector<std::uint32_t> states{};  ///< by safe interval
    std::vector<std::uint32_t> from{};    ///< states from which it was reached, or not, before
  };
  struct Link {
    Vertex to;
    double length;
  };

  Point2 at(Vertex v) const { return v < lattice_.size() ? lattice_.at(v) : points_[v - lattice_.size()]; }
  Vertex add_point(const Point2& p);
  template <class Fn>
  void for_each_link(Vertex v, Fn&& fn);
  void add_path(const Path& path);
  void measure_distances();
  Known& known(Vertex v, SpaceTime& others);
  double time_lost(const State& s, Vertex to, const Limits& limits) const;
  void reach(std::uint32_t from, Vertex to, double length, SpaceTime& others, const Limits& limits);
  Trajectory trajectory_to(std::uint32_t state, double begin, double speed) const;

  const ClearanceField& field_;
  Lattice& lattice_;
  double radius_;
  double roomy_;                ///< metres that robots keep from obstacles where they can: they may stray
  std::vector<Point2> points_;  ///< off the lattice: the start, the goal, and between
  std::vector<std::vector<Link>> links_;                     ///< of these points
  std::unordered_map<Vertex, std::vector<Link>> links_off_;  ///< from lattice vertices to these points
  Vertex start_;
  Vertex goal_;
  std::vector<float> distance_;  ///< by vertex: metres to the goal; infinite: too far
  std::unordered_map<Vertex, Known> known_;
  std::vector<State> states_;
  std::size_t expanded_in_all_ = 0;
  std::vector<std::pair<double, std::uint32_t>> open_;  ///< a heap, the earliest arrival at the goal first
};

}  // namespace coppice
