// Plans the trajectory of a reservation: around the reservations of all others, or, if there is none, around
// those of as many as possible. The rest give way: they plan anew.
//
// Prioritised planning (Silver, "Cooperative Pathfinding", 2005). That a robot which finds no trajectory goes
// before others follows Andreychuk, Yakovlev, "Two Techniques That Enhance the Performance of Multi-Robot
// Prioritized Path Planning", 2018; there all plan anew, here only those in its way.
//
// A way may be too long for one search, or the map too large for one lattice. Then the reservation is for a
// first part of the way, as long as possible, in which the robot meets nobody on its path. If it meets
// somebody soon, it searches, around a short part. So the effort and the memory of a reservation are bounded
// (docs/coordination.md).
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
#include "motion/lattice/lattice.h"
#include "motion/lattice/packed_roadmap.h"
#include "motion/lattice/safe_interval_search.h"
#include "motion/trajectory/divided_way.h"
#include "motion/trajectory/space_time.h"
#include "robot_agent/agreement/reservations.h"

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
  /// `roadmaps` and `path` must outlive it. For a disc of `radius` that sets off at the beginning of `path`,
  /// at `begin`, and drives to its end. `zones` are closed for ever.
  TrajectoryPlanner(MapRoadmaps& roadmaps, const Path& path, double radius, const Limits& limits,
                    double begin, std::vector<OtherRobot> others, std::vector<Disc> zones);

  /// A trajectory around all others; none: there is none, or the search takes too long. It ends where rest()
  /// begins.
  std::optional<Trajectory> around_all();
  /// The same, but some of those that may give way do so: as few as a greedy choice finds.
  std::optional<Trajectory> around_most();
  /// The reservations around which the last trajectory was planned.
  std::vector<ReservationBasis> basis() const;
  /// The rest of the path, beyond the trajectory's end; empty: nothing.
  const Path& rest() const { return way_.rest; }

 private:
  SpaceTime taken_by_others() const;
  std::optional<Trajectory> search();
  std::optional<Trajectory> past_nobody(SpaceTime& taken) const;
  std::optional<Trajectory> on_the_lattice(SpaceTime& taken);
  std::optional<Trajectory> along_the_path(SpaceTime& taken) const;
  SafeIntervalSearch& searcher();
  double stays() const;
  template <class Fn>
  void let_give_way(Fn&& is_chosen);

  MapRoadmaps& roadmaps_;
  const ClearanceField& field_;
  const Path& path_;
  double radius_;
  DividedWay way_;
  bool is_long_;  ///< the way, or the map is large
  Limits limits_;
  double begin_;
  std::vector<OtherRobot> others_;
  std::vector<Disc> zones_;
  std::vector<bool> gives_way_;         ///< by other robot
  std::optional<Lattice> part_of_map_;  ///< around the first part of a long way
  std::optional<SafeIntervalSearch> search_;
};

}  // namespace coppice
