// The largest faults that a simulation can be asked for.
#pragma once

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

}  // namespace coppice
