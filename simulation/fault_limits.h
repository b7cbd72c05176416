// The largest faults that a simulation can be asked for.
#pragma once

#include "messages/clock_offset.h"

namespace coppice {

/// Share of lost samples. With more, reliable samples take too long.
inline constexpr double largest_loss = 0.95;
/// Of a sample, seconds.
inline constexpr double longest_delay = 60;
/// Kills or pauses of an agent per hour. The schedule of more takes very long to draw.
inline constexpr double most_an_hour = 3600;
/// Durations of faults, seconds.
inline constexpr double shortest_fault = 1e-3;
inline constexpr double longest_fault = 1e5;
/// Between two clocks. Agents count on no more (docs/safety.md, A3).
inline constexpr double largest_drift = clock_drift;

/// Of odometry, metres: robots that see no more than that cannot keep to a way. simulation/drive_limits.h
/// says how much of this and the next ones a robot bears.
inline constexpr double most_noise = 1;
/// Of a drive, seconds. With three times that a robot that corrects its course begins to swing.
inline constexpr double longest_lag = 0.3;
/// Share of a wheel's speed.
inline constexpr double most_slip = 0.5;

}  // namespace coppice
