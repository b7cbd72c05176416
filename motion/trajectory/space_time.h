// The space and time that the trajectories of other robots take. It tells when a disc may stand at a point,
// and when it may set off along a straight line.
//
// A disc that moves on a line and a disc that stands or moves on another one: the times of departure at which
// the two come too close are an interval (docs/coordination.md). Room in time widens it: a robot that is a
// little early or late then meets nobody.
//
// Metres in the map frame, seconds of fleet time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "coppice/motion/kinematics.h"
#include "coppice/motion/trajectory.h"
#include "coppice/planning/geometry.h"
#include "motion/trajectory/segments.h"

namespace coppice {

/// Radii by which a robot may stray from the way of its trajectory. With more, robots of 0.45 cells could not
/// stand side by side in the cells of a grid (kept_apart()).
inline constexpr double reserved_stray_radii = 0.06;
/// Seconds by which a trajectory keeps clear of where others are earlier and later.
inline constexpr double room_in_time = 0.125;
/// Metres between the centres of two robots that trajectories keep: they may stray, and the gates that follow
/// from the trajectories (reserved_order.h) close a little before the two could touch.
inline double kept_apart(double radius, double other_radius) {
  return (1 + reserved_stray_radii) * (radius + other_radius) +
         comfort_radii * std::max(radius, other_radius);
}

struct Interval {
  double begin = 0;
  double end = 0;
};

/// Sorts the intervals and joins those that overlap.
void unite(std::vector<Interval>& intervals);

class SpaceTime {
 public:
  using Number = std::uint32_t;  ///< of a robot
  static constexpr Number nobody = ~Number{0};

  /// For a disc of `radius`. `apart`: tells how many metres the centres of two discs keep, by their radii.
  SpaceTime(const Box<2>& bounds, double radius, std::function<double(double, double)> apart = kept_apart);

  /// Adds a robot that carries out a trajectory and then stands.
  void add(const Trajectory& trajectory, double radius, Number robot = nobody) {
    add(trajectory, apart_(radius_, radius), forever, robot);
  }
  /// A robot that was added, and stands at the end, drives on from there.
  void go_on(Number robot, const Trajectory& rest, double radius);
  /// Adds a robot that stands until a time.
  void add_standing(const Point2& p, double radius, double until);
  /// Adds a disc that stands for ever, and of which this one need keep no gap.
  void add_obstacle(const Disc& disc);
  /// The disc starts at p at a time. It may leave from there although others are closer than kept_apart(), as
  /// long as it comes no closer.
  void start_at(const Point2& p, double time);

  /// Appends times at which the disc may not be at p, not sorted. `own`: the disc is this robot.
  void blocked_at(const Point2& p, std::vector<Interval>& out, Number own = nobody) const;
  /// The intervals of time in which the disc may be at p, in order. The first may begin at minus infinity,
  /// the last may have no end.
  std::vector<Interval> safe_at(const Point2& p) const;
  /// The first time from `from` on at which it may depart from a in order to be at b `duration` seconds
  /// later; infinite: never.
  double first_departure(const Point2& a, const Point2& b, double duration, double from, Number own = nobody);

  /// The same for a robot that is at a at full speed at `ready`. If it has to wait, it needs time to speed
  /// up.
  double first_departure(const Point2& a, const Point2& b, double ready, double from, const Limits& limits);

  static constexpr double forever = std::numeric_limits<double>::infinity();

 private:
  /// A part of a trajectory along which a robot drives straight at constant speed, or stands.
  struct Piece {
    Point2 from;
    Point2 velocity;
    double begin;
    double end;
    double near;       ///< metres between the centres at which the two are too close
    double reach = 0;  ///< metres beyond which room in time makes no difference
    Number robot = nobody;
  };
  /// What may come too close to a disc in a square of the map.
  struct Cell {
    std::vector<Piece> standing{};
    std::vector<Piece> moving{};  ///< by begin, once they are sorted
    bool is_sorted = true;
  };

  void add(const Trajectory& trajectory, double near, double until, Number robot);
  void add_parts(const Trajectory& trajectory, double near, double until, Number robot);
  void add_piece(const Piece& piece);
  std::size_t column(double x) const;
  std::size_t row(double y) const;
  std::uint32_t& square(std::size_t i, std::size_t j) { return squares_[j * columns_ + i]; }
  static bool is_own(const Piece& piece, Number own) { return own != nobody && piece.robot == own; }
  template <class Fn>
  void for_each_cell_near(const Point2& a, const Point2& b, double distance, Fn&& fn);
  template <class Fn>
  void for_each_cell_along(const Point2& a, const Point2& b, Fn&& fn);
  static std::optional<Interval> blocked_departures(const Piece& piece, const Point2& a, const Point2& w,
                                                    const Interval& on_way);
  static bool may_block(const Piece& piece, const Point2& a, const Point2& w, const Interval& on_way,
                        double departure);
  double end_of_block(const Cell& cell, const Point2& a, const Point2& velocity, const Interval& on_way,
                      double departure, Number own) const;

  double radius_;
  std::function<double(double, double)> apart_;
  double cell_;
  Point2 lower_;
  std::size_t columns_;
  std::size_t rows_;
  std::vector<std::uint32_t> squares_;  ///< of the map: numbers of their cells
  std::vector<Cell> cells_;             ///< the first one stays empty: nobody comes near most squares
  double longest_ = 0;                  ///< seconds that a moving piece lasts
};

/// Whether a disc that carries out a trajectory keeps apart from another one, also from where that is a room
/// in time earlier and later.
bool keep_room(const Trajectory& own, double radius, const Trajectory& other, double other_radius);

}  // namespace coppice
