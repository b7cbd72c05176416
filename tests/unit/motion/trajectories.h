// Where a robot that carries out a trajectory is.
#pragma once

#include <cstddef>

#include "coppice/motion/trajectory.h"

namespace coppice::test {

inline Point2 position_at(const Trajectory& trajectory, double time) {
  if (time <= trajectory.front().time) return trajectory.front().position;
  for (std::size_t k = 1; k < trajectory.size(); ++k) {
    const TimedPoint& a = trajectory[k - 1];
    const TimedPoint& b = trajectory[k];
    if (time < b.time) return a.position + (b.position - a.position) * ((time - a.time) / (b.time - a.time));
  }
  return trajectory.back().position;
}

}  // namespace coppice::test
