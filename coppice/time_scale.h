// How fast fleet time may go by where all processes of a fleet share one machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace coppice {

/// So many robots a processor are taken to drive in real time: a rule of thumb, by which 200 on two
/// processors do arrive (docs/performance.md).
inline constexpr double robots_a_core = 25;

/// Fleet seconds a second of the wall's clock, at most 1. What the agents of a large fleet cost together
/// grows with their number and with how many each of them hears, which grows, too, on one map.
inline double usual_time_scale(std::size_t robots, double cores) {
  const double crew = robots_a_core * cores / static_cast<double>(std::max<std::size_t>(1, robots));
  return std::min(1.0, std::pow(crew, 1.5));
}

}  // namespace coppice
