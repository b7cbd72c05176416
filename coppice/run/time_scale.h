// How fast fleet time may pass if all processes of a fleet share one machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace coppice {

/// Robots per processor that can drive in real time: a rule of thumb. 200 robots on two processors do arrive
/// with it (docs/performance.md).
inline constexpr double robots_a_core = 25;

/// Fleet seconds per wall second, at most 1. The load of a large fleet grows with the number of agents and
/// with the number of peers that each of them hears, which also grows on one map.
inline double usual_time_scale(std::size_t robots, double cores) {
  const double crew = robots_a_core * cores / static_cast<double>(std::max<std::size_t>(1, robots));
  return std::min(1.0, std::pow(crew, 1.5));
}

}  // namespace coppice
