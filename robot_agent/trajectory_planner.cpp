#include "robot_agent/trajectory_planner.h"

#include <algorithm>
#include <utility>

#include "motion/earliest_along.h"
#include "motion/segments.h"
#include "motion/wide_corners.h"

namespace coppice {

TrajectoryPlanner::TrajectoryPlanner(MapRoadmaps& places, const Path& path, double radius,
                                     const Limits& limits, double begin, std::vector<OtherRobot> others,
                                     std::vector<Disc> zones)
    : field_(places.field()),
      path_(path),
      radius_(radius),
      limits_(limits),
      begin_(begin),
      others_(std::move(others)),
      zones_(std::move(zones)),
      gives_way_(others_.size()),
      search_(places.field(), places.lattice(radius), radius, path) {}

std::optional<Trajectory> TrajectoryPlanner::search() {
  SpaceTime taken(field_.bounds(), radius_);
  for (std::size_t k = 0; k < others_.size(); ++k) {
    const OtherRobot& other = others_[k];
    if (other.reservation && !gives_way_[k]) {
      taken.add(other.reservation->trajectory, other.reservation->radius);
    } else {
      taken.add_standing(other.position, other.radius, other.stands_until);
    }
  }
  for (const Disc& zone : zones_) taken.add_obstacle(zone);
  taken.start_at(path_.front(), begin_);
  auto found = search_.search(taken, begin_, limits_);
  if (!found || path_of(*found).size() < 2) return std::nullopt;
  const double stray = reserved_stray_radii * radius_;
  const Path wide = with_wide_corners(path_of(*found), field_, radius_, stray, limits_);
  const auto rounded = earliest_along(wide, taken, begin_, stray, limits_);
  const bool is_better = rounded && path_of(*rounded).size() > 1 && rounded->back().time < found->back().time;
  return is_better ? rounded : found;
}

std::optional<Trajectory> TrajectoryPlanner::around_all() {
  gives_way_.assign(others_.size(), false);
  return search();
}

/// Lets those give way that may, and for which `is_chosen` holds.
template <class Fn>
void TrajectoryPlanner::let_give_way(Fn&& is_chosen) {
  for (std::size_t k = 0; k < others_.size(); ++k)
    gives_way_[k] = others_[k].reservation && others_[k].may_give_way && is_chosen(others_[k]);
}

/// Mostly some robots are to pass where this one stands. If it is not enough that these give way, all do that
/// may. Then they are tried one by one: a robot that need not give way does not.
std::optional<Trajectory> TrajectoryPlanner::around_most() {
  const auto passes_here = [&](const OtherRobot& other) {
    const double near = kept_apart(radius_, other.reservation->radius);
    return come_too_close({{begin_, path_.front()}}, other.reservation->trajectory, near, begin_);
  };
  let_give_way(passes_here);
  auto found = search();
  if (!found) {
    let_give_way([](const OtherRobot&) { return true; });
    found = search();
  }
  for (std::size_t k = 0; found && k < others_.size(); ++k) {
    if (!gives_way_[k]) continue;
    gives_way_[k] = false;
    const KnownReservation& other = *others_[k].reservation;
    if (!come_too_close(*found, other.trajectory, kept_apart(radius_, other.radius), begin_)) continue;
    auto around_it = search();
    gives_way_[k] = !around_it;
    if (around_it) found = std::move(around_it);
  }
  return found;
}

std::vector<ReservationBasis> TrajectoryPlanner::basis() const {
  std::vector<ReservationBasis> basis;
  for (std::size_t k = 0; k < others_.size(); ++k) {
    if (others_[k].reservation && !gives_way_[k]) basis.push_back(others_[k].reservation->basis);
  }
  return basis;
}

}  // namespace coppice
