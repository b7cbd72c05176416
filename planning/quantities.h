// What lengths, speeds and times may be, and how many robots there may be: bounds within which the arithmetic
// of planning and driving is sound, and no loop over cells, periods or pieces of a way is without end. Files
// and messages are checked against them.
//
// Metres, seconds, metres per second.
#pragma once

#include <cmath>
#include <cstddef>

namespace coppice {

/// Coordinates, radii, speeds and times beyond this are nonsense on any site.
inline constexpr double largest_quantity = 1e9;
/// Radii, cells of a map, speeds, accelerations and scales of time below this are, too.
inline constexpr double least_quantity = 1e-4;
/// From full speed to a stand, seconds: a robot that takes longer looks too far ahead at every step.
inline constexpr double longest_braking = 100;
/// Fleet seconds a wall second: no process decides that often.
inline constexpr double largest_time_scale = 1000;
/// Seconds since the Unix epoch: in 2286.
inline constexpr double latest_run = 1e10;
/// Robots of a fleet: as many as a joint plan may have members (idl/fleet.idl).
inline constexpr std::size_t most_robots = 4096;

/// False for NaN.
inline bool is_sane(double x) {
  return std::abs(x) <= largest_quantity;
}
inline bool is_sane_size(double x) {
  return x >= least_quantity && x <= largest_quantity;
}
/// Whether one with these limits comes to a stand in time.
inline bool can_brake(double max_speed, double max_acceleration) {
  return max_speed <= max_acceleration * longest_braking;
}

}  // namespace coppice
