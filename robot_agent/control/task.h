// The task of a robot in its mission: one alternative at a time, with all data that belong to it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "messages/messages.h"
#include "motion/body/path_follower.h"
#include "robot_agent/control/path_finder.h"

namespace coppice {

/// The path that a robot follows.
struct Route {
  PathFollower follower;
  std::unique_ptr<PathFinder> improvement{};  ///< looks for a shorter path; null: no more
  WallTime found_at = 0;                      ///< wall clock, of the first path
};

struct Planning {
  std::unique_ptr<PathFinder> finder;
  std::optional<PathFinder::Result> found{};  ///< by the last step; the next step takes it
};
struct Driving {
  Route route;
};
struct Arrived {
  Route route;  ///< back to the goal, where others push the robot away
};
/// The robot began a little too near to an obstacle, and drives straight to a place where it has room.
struct DrivingOut {
  Point2 to = Point2::Zero();
};
/// It is proved that no path exists.
struct Impossible {};
/// The robot stands, and tries again when something has changed.
struct GaveUp {
  Route route;
  Point2 place = Point2::Zero();  ///< where the robot stood then
  double at = 0;                  ///< fleet time
  std::uint32_t new_goals = 0;    ///< that other robots had been given by then
};
/// The run has ended, or the process is to end: the robot brakes and stands.
struct Stopped {
  double at = 0;  ///< fleet time
  bool has_said_that_it_stands = false;
};

/// An operator told the robot to stand. It takes part in nothing until it may go on with its work.
struct Halted {
  std::variant<Planning, Driving, DrivingOut, Arrived, Impossible, GaveUp> work;
  Halt halt = Halt::none;  ///< that its status tells
};

using Task = std::variant<Planning, Driving, DrivingOut, Arrived, Impossible, GaveUp, Stopped, Halted>;

inline Phase phase_of(const Task& task) {
  struct ToPhase {
    Phase operator()(const Planning&) const { return Phase::planning; }
    Phase operator()(const Driving&) const { return Phase::driving; }
    Phase operator()(const DrivingOut&) const { return Phase::planning; }
    Phase operator()(const Arrived&) const { return Phase::arrived; }
    Phase operator()(const Impossible&) const { return Phase::no_path; }
    Phase operator()(const GaveUp&) const { return Phase::gave_up; }
    Phase operator()(const Stopped&) const { return Phase::stopped; }
    Phase operator()(const Halted&) const { return Phase::halted; }
  };
  return std::visit(ToPhase{}, task);
}

/// Null: the robot has none.
inline const Route* route_of(const Task& task) {
  if (const auto* driving = std::get_if<Driving>(&task)) return &driving->route;
  if (const auto* arrived = std::get_if<Arrived>(&task)) return &arrived->route;
  if (const auto* gave_up = std::get_if<GaveUp>(&task)) return &gave_up->route;
  return nullptr;
}
inline Route* route_of(Task& task) {
  return const_cast<Route*>(route_of(std::as_const(task)));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

}  // namespace coppice
