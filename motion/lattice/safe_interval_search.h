// Plans the trajectory of a disc in space and time, past the trajectories of others.
//
// Safe interval path planning (Phillips, Likhachev, "SIPP: Safe Interval Path Planning for Dynamic
// Environments", 2011): a state is a vertex and an interval of time in which nobody comes there, and the
// earliest arrival in it counts. Any-angle (Yakovlev, Andreychuk, "Any-Angle Pathfinding for Multiple Agents
// Based on SIPP Algorithm", 2017): a state may also be reached straight from the parent of the state that it
// is reached from.
//
// The search is lazy (Cohen, Phillips, Likhachev, "Planning Single-Arm Manipulations with N-Arm Robots",
// 2014): a move is offered as if nobody came across it. When it is the best offer of all, the search looks
// when the robot may depart.
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

#include "coppice/motion/kinematics.h"
#include "coppice/motion/trajectory.h"
#include "coppice/planning/clearance_field.h"
#include "motion/lattice/lattice.h"
#include "motion/trajectory/space_time.h"

namespace coppice {

class SafeIntervalSearch {
 public:
  /// All must outlive it. `lattice`: of the disc's radius. `path`: from the start to the goal.
  SafeIntervalSearch(const ClearanceField& field, Lattice& lattice, double radius, const Path& path);

  /// The trajectory with the earliest arrival that the vertices allow. It begins where the path begins, at
  /// `begin`, and is at rest or at full speed. It stands where it slows down for a corner, for as long as it
  /// loses there, and so after each wait. At the goal it can stay for `stays` seconds. Nothing if there is
  /// none that arrives before `before`, or if this search or all together take too long.
  std::optional<Trajectory> search(SpaceTime& others, double begin, const Limits& limits,
                                   double before = SpaceTime::forever, double stays = SpaceTime::forever);

 private:
  using Vertex = std::uint32_t;
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  struct State {  ///< a vertex in one of its safe intervals
    Vertex vertex;
    Point2 place;
    Interval safe;
    Point2 heading = Point2::Zero();   ///< in which the robot arrives, of length 1; zero at the start
    double time = SpaceTime::forever;  ///< of arrival, at the latest
    std::uint32_t parent = none;
    bool closed = false;
  };
  struct Known {          ///< of a vertex
    std::uint32_t first;  ///< of its states, which follow each other
    std::uint32_t end;
    std::vector<std::uint32_t> from{};  ///< states from which a move to it was offered
  };
  struct Reached {
    float through;   ///< metres of a way from the start to the goal through the vertex, about
    float distance;  ///< from there to the goal, metres
    Vertex vertex;
  };
  /// A move straight from one state to another.
  struct Move {
    double cost;  ///< the arrival at the goal, if nothing comes between
    std::uint32_t from;
    std::uint32_t to;
    double departure;
    bool is_certain;  ///< nobody comes across: the search has looked
  };
  struct Link {
    Vertex to;
    double length;
  };

  Point2 at(Vertex v) const { return v < lattice_.size() ? lattice_.at(v) : points_[v - lattice_.size()]; }
  Vertex add_point(const Point2& p);
  template <class Fn>
  void for_each_link(Vertex v, Fn&& fn);
  void add_path(Path path);
  void begin_distances();
  float distance(Vertex v);
  Known& known(Vertex v, SpaceTime& others);
  double time_lost(const State& s, Vertex to, const Limits& limits) const;
  void offer_moves(std::uint32_t from, Vertex to, double length, SpaceTime& others, const Limits& limits);
  void push(const Move& move);
  std::optional<Move> next_move();
  bool look_at(Move& move, SpaceTime& others, const Limits& limits);
  void carry_out(const Move& move, const Limits& limits);
  void begin_at(double time, SpaceTime& others, const Limits& limits);
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
  std::vector<float> distance_;        ///< by vertex: metres to the goal, so far
  std::vector<char> settled_;          ///< by vertex: the distance is known
  std::vector<Reached> unsettled_;     ///< a heap, the least `through` first
  double most_ = 0;                    ///< metres of a way through a vertex that matters
  std::vector<std::uint32_t> number_;  ///< by vertex: in known_
  std::vector<Known> known_;
  std::vector<State> states_;
  std::size_t expanded_in_all_ = 0;
  std::vector<Move> open_;  ///< a heap, the earliest arrival at the goal first
};

}  // namespace coppice
