// Plans the trajectory of a reservation: around the reservations of all others, or, if there is none, around
// those of as many as possible. The rest give way: they plan anew.
//
// Prioritised planning (Silver, "Cooperative Pathfinding", 2005). That a robot which finds no trajectory goes
// before others follows Andreychuk, Yakovlev, "Two Techniques That Enhance the Performance of Multi-Robot
// Prioritized Path Planning", 2018; there all plan anew, here only those in its way.
//
// Metres in the map frame, seconds of fleet time.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "coppice/motion/kinematics.h"
#include "coppice/motion/trajectory.h"
#include "messages/messages.h"
#include "motion/packed_roadmap.h"
#include "motion/safe_interval_search.h"
#include "motion/space_time.h"
#include "robot_agent/reservations.h"

namespace coppice {

/// Another robot, as a new trajectory reckons with it.
struct OtherRobot {
  Point2 position = Point2::Zero();
  double radius = 0;
  std::optional<KnownReservation> reservation{};
  bool may_give_way = false;  ///< it plans anew if its reservation is overridden
  double stands_until = 0;    ///< at its position, if it has no reservation or gives way
};

class TrajectoryPlanner {
 public:
  /// `places` and `path` must outlive it. For a disc of `radius` that sets off at the beginning of `path`, at
  /// `begin`, and drives to its end. `zones` are closed for ever.
  TrajectoryPlanner(MapRoadmaps& places, const Path& path, double radius, const Limits& limits, double begin,
                    std::vector<OtherRobot> others, std::vector<Disc> zones);

  /// A trajectory around all others; none: there is none, or the search takes too long.
  std::optional<Trajectory> around_all();
  /// The same, but some of those that may give way do so: as few as a greedy choice finds.
  std::optional<Trajectory> around_most();
  /// The reservations around which the last trajectory was planned.
  std::vector<ReservationBasis> basis() const;

 private:
  std::optional<Trajectory> search();
  template <class Fn>
  void let_give_way(Fn&& is_chosen);

  const ClearanceField& field_;
  const Path& path_;
  double radius_;
  Limits limits_;
  double begin_;
  std::vector<OtherRobot> others_;
  std::vector<Disc> zones_;
  std::vector<bool> gives_way_;  ///< by other robot
  SafeIntervalSearch search_;
};

}  // namespace coppice
