// Decides when a robot may continue along its part of a joint plan (joint_plan.h), so that many robots move
// at once.
//
// Where a robot's way comes near a way of another robot that the plan moves earlier, the plan's order is
// kept: a gate on the robot's way stays closed until the other robot has come far enough along its own way.
// All gates refer to earlier moves, so the robot with the earliest unfinished move can always drive: there is
// no cycle of waits, however late a robot is (the temporal plan graph of Hönig et al., "Multi-Agent Path
// Finding with Kinematic Constraints", 2016, on continuous paths; order instead of times as in Čáp, Gregoire,
// Frazzoli, "Provably Safe and Deadlock-Free Execution of Multi-Robot Plans under Delaying Disturbances",
// 2016).
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "motion/joint_plan.h"

namespace coppice {

/// The way of a robot: its moves one after the other, in legs that end where it turns by a right angle or
/// more. Empty if the robot has no moves.
std::vector<Path> legs_of(std::size_t robot, std::span<const Move> moves);

struct Gate {
  double at = 0;          ///< metres along the own way; the robot must not pass this point
  std::size_t robot = 0;  ///< before this other robot
  double needed = 0;      ///< has come so many metres along its own way
};

/// Radii by which a robot may stray from its way.
inline constexpr double stray_radii = 0.04;

/// Number of pieces into which the ways are cut in order to see where they come near each other.
double pieces_of(std::span<const Move> moves, std::span<const double> radii);

/// The gates on the way of `robot`, first to last. Two ways count as near where discs that stray could touch.
/// If the computation reaches its limits, the robot waits for all earlier moves from there on: 10 million
/// pieces take at most 0.5 s and 80 MB.
std::vector<Gate> gates_of(std::size_t robot, std::span<const Move> moves, std::span<const double> radii);

}  // namespace coppice
