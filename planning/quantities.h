// Bounds on lengths, speeds, times and the number of robots. Within them the arithmetic of planning and
// driving is sound, and loops over cells, periods or pieces of a way end. Files and messages are checked
// against them.
//
// Metres, seconds, metres per second.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

namespace coppice {

/// Largest coordinate, radius, speed and time. Larger values make no sense on any site.
inline constexpr double largest_quantity = 1e9;
/// Smallest radius, cell of a map, speed, acceleration and time scale.
inline constexpr double least_quantity = 1e-4;
/// Longest time to brake from full speed to standstill, seconds. A robot that takes longer would look too far
/// ahead in each step.
inline constexpr double longest_braking = 100;
/// Fleet seconds per wall second. No process can decide more often.
inline constexpr double largest_time_scale = 1000;
/// Seconds since the Unix epoch; a time in the year 2286.
inline constexpr double latest_run = 1e10;
/// Robots of a fleet: as many as a joint plan may have members (idl/fleet.idl).
inline constexpr std::size_t most_robots = 4096;
/// Corners of a robot's footprint (idl/fleet.idl).
inline constexpr std::size_t most_corners = 64;

/// Radians: two turns from one end to the other. A file with a larger yaw means degrees.
inline constexpr double largest_yaw = 2 * std::numbers::pi;
/// What is_yaw() allows, as text for messages.
inline constexpr const char* yaw_rule = "radians from -6.283 to 6.283 (90 degrees are 1.571)";

/// Whether the value is within the bounds. False for NaN.
inline bool is_sane(double x) {
  return std::abs(x) <= largest_quantity;
}
inline bool is_sane_size(double x) {
  return x >= least_quantity && x <= largest_quantity;
}
/// Whether a yaw is one that somebody writes in radians. False for NaN.
inline bool is_yaw(double x) {
  return std::abs(x) <= largest_yaw;
}
/// Whether a robot with these limits comes to a standstill in time.
inline bool can_brake(double max_speed, double max_acceleration) {
  return max_speed <= max_acceleration * longest_braking;
}

}  // namespace coppice
