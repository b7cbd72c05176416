// When a robot may go on along its part of a plan of moves (joint_plan.h), so that many move at once.
//
// Wherever a robot's way comes near a way of another robot that the plan moves earlier, the plan's order is
// kept: a gate on its way stays closed until the other has come far enough along its own. All gates point to
// earlier moves, so the robot with the earliest unfinished move can always go: no cycle of waits exists,
// however late anybody runs (the temporal plan graph of Hönig et al., "Multi-Agent Path Finding with
// Kinematic Constraints", 2016, on continuous paths; order instead of times as in Čáp, Gregoire, Frazzoli,
// "Provably Safe and Deadlock-Free Execution of Multi-Robot Plans under Delaying Disturbances", 2016).
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "motion/joint_plan.h"

namespace coppice {

/// A robot's moves, one after the other: its way, in legs that end where it turns by a
/// right angle or more. Empty if it has none.
std::vector<Path> legs_of(std::size_t robot, std::span<const Move> moves);

struct Gate {
  double at = 0;          ///< metres along the own way: not to be passed before
  std::size_t robot = 0;  ///< this one has come
  double needed = 0;      ///< so many metres along its own way
};

/// Nobody strays further from its way than this, in radii.
inline constexpr double stray_radii = 0.04;

/// How many pieces ways are cut into, to see where they come near each other.
double pieces_of(std::span<const Move> moves, std::span<const double> radii);

/// The gates on the way of `robot`, first to last. Ways count as near where discs that stray might touch.
/// If that takes too long to find out, it waits for all earlier moves from there on: of 10 million pieces at
/// most half a second and 80 MB.
std::vector<Gate> gates_of(std::size_t robot, std::span<const Move> moves, std::span<const double> radii);

}  // namespace coppice
