#include "robot_agent/agreement/trajectory_planner.h"

#include <algorithm>
#include <utility>

#include "motion/lattice/off_walls.h"
#include "motion/trajectory/earliest_along.h"
#include "motion/trajectory/segments.h"
#include "motion/trajectory/wide_corners.h"

namespace coppice {

namespace {

// Radii of way for which one reservation is made, at most. A search passes 40,000 vertices, which lie half a
// radius apart or more, and also looks beside the way.
constexpr double longest_part = 16'000;
// Corners of it. Each may become several points of the trajectory, of which a message has a limit.
constexpr std::size_t corners_of_part = 4'000;
// Radii of a longer way that are searched, if somebody is met there. The lattice is that of a box around.
constexpr double searched_part = 1'000;
constexpr double corner_room =
    0.5;                       // radii between a robot at a corner of its path and the wall, if possible
constexpr double beside = 40;  // radii from the way to the border of that box
// Seconds for which nobody comes to the end of a part: until the robot has had its turn to reserve the next
// one.
constexpr double time_to_reserve = 60;
constexpr double same_arrival = 1e-6;  // seconds: rounding

Box<2> around(const Path& way, double metres) {
  Box<2> box{way.front(), way.front()};
  for (const Point2& p : way) box = extended(box, p);
  return {box.lower.array() - metres, box.upper.array() + metres};
}

}  // namespace

TrajectoryPlanner::TrajectoryPlanner(MapRoadmaps& roadmaps, const Path& path, double radius,
                                     const Limits& limits, double begin, std::vector<OtherRobot> others,
                                     std::vector<Disc> zones)
    : roadmaps_(roadmaps),
      field_(roadmaps.field()),
      path_(path),
      radius_(radius),
      way_(divided(path, longest_part * radius, corners_of_part)),
      is_long_(!way_.rest.empty() || !roadmaps.has_lattice(radius)),
      limits_(limits),
      begin_(begin),
      others_(std::move(others)),
      zones_(std::move(zones)),
      gives_way_(others_.size()) {}

/// Seconds for which the robot is to stay at the end of the trajectory.
double TrajectoryPlanner::stays() const {
  return way_.rest.empty() ? SpaceTime::forever : time_to_reserve;
}

SafeIntervalSearch& TrajectoryPlanner::searcher() {
  if (search_) return *search_;
  Lattice& lattice =
      is_long_ ? part_of_map_.emplace(roadmaps_.lattice_of(around(way_.first, beside * radius_), radius_))
               : roadmaps_.lattice(radius_);
  return search_.emplace(field_, lattice, radius_, way_.first);
}

SpaceTime TrajectoryPlanner::taken_by_others() const {
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
  return taken;
}

std::optional<Trajectory> TrajectoryPlanner::search() {
  SpaceTime taken = taken_by_others();
  if (is_long_) {
    if (auto along = past_nobody(taken)) return along;
  }
  auto found = on_the_lattice(taken);
  return found ? found : along_the_path(taken);
}

/// Along the path, if nobody is met there.
std::optional<Trajectory> TrajectoryPlanner::past_nobody(SpaceTime& taken) const {
  SpaceTime nobody(field_.bounds(), radius_);
  const auto alone = along_the_path(nobody);
  auto along = along_the_path(taken);
  return along && along->back().time <= alone->back().time + same_arrival ? along : std::nullopt;
}

/// The path of the robot, with as few waits as possible. At its corners the robot may stray to the walls.
std::optional<Trajectory> TrajectoryPlanner::along_the_path(SpaceTime& taken) const {
  Path path = way_.first;
  path.erase(std::unique(path.begin(), path.end()), path.end());
  if (path.size() < 2) return std::nullopt;
  const double stray = reserved_stray_radii * radius_;
  const double roomy = radius_ + 2 * stray;  // a robot that has strayed must be able to turn
  const Path off = off_walls(path, field_, radius_, (1 + corner_room) * radius_);
  const Path wide = with_wide_corners(off, field_, roomy, stray, limits_);
  return earliest_along(wide, taken, begin_, stray, limits_, stays());
}

std::optional<Trajectory> TrajectoryPlanner::on_the_lattice(SpaceTime& taken) {
  auto found = searcher().search(taken, begin_, limits_, SpaceTime::forever, stays());
  if (!found || path_of(*found).size() < 2) return std::nullopt;
  const double stray = reserved_stray_radii * radius_;
  const Path wide = with_wide_corners(path_of(*found), field_, radius_, stray, limits_);
  const auto rounded = earliest_along(wide, taken, begin_, stray, limits_, stays());
  const bool is_better = rounded && path_of(*rounded).size() > 1 && rounded->back().time < found->back().time;
  return is_better ? rounded : found;
}

/// Of a long way, as much as leads past nobody. If that is little, so much that a search around others is
/// quick.
std::optional<Trajectory> TrajectoryPlanner::around_all() {
  gives_way_.assign(others_.size(), false);
  if (!is_long_) return search();
  SpaceTime taken = taken_by_others();
  for (double longest = longest_part; longest > searched_part; longest /= 2) {
    way_ = divided(path_, longest * radius_, corners_of_part);
    if (auto along = past_nobody(taken)) return along;
  }
  way_ = divided(path_, searched_part * radius_, corners_of_part);
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
