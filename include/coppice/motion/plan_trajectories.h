// Plans trajectories for a fleet at once, so that no two robots touch: centralised multi-robot planning.
//
// A joint search gives moves (Okumura, "Improving LaCAM for Scalable Eventually Optimal Multi-Agent
// Pathfinding", 2023, on a roadmap of discs; for up to four robots weighted A*). Each move gets the earliest
// time that others leave. Then one robot after the other plans again around all others (large neighbourhood
// search: Li, Chen, Harabor, Stuckey, Koenig, "Anytime Multi-Agent Path Finding via Large Neighborhood
// Search", 2021), until a pass over all robots brings nothing.
//
// Metres in the map frame, seconds, metres per second, metres per second squared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "coppice/motion/kinematics.h"
#include "coppice/motion/trajectory.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"

namespace coppice {

/// A disc that is to drive from its start to its goal.
struct DrivingTask {
  Point2 start = Point2::Zero();
  Point2 goal = Point2::Zero();
  double radius = 0;
  Limits limits{};
};

struct FleetTrajectories {
  /// For each robot, from time 0 on. One point: the robot does not move.
  std::vector<Trajectory> trajectories{};
  /// Robots that do not reach their goals; their trajectories end elsewhere.
  std::vector<std::size_t> stranded{};
};

/// Robots drive at `max_speed`, and stand at corners and after a wait for as long as they lose there by
/// `max_acceleration`. `stop` is asked again and again once all have a trajectory; true ends the improvement.
/// Throws std::invalid_argument if a task has a bad radius or limit, or if a robot would touch an obstacle or
/// another robot at its start or goal.
FleetTrajectories plan_trajectories(const ClearanceField& field, std::span<const DrivingTask> tasks,
                                    std::uint64_t seed = 1, const std::function<bool()>& stop = {});

}  // namespace coppice
