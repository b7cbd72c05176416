// The robot of most tests.
#pragma once

#include "coppice/motion/kinematics.h"

namespace coppice::test {

inline constexpr double radius = 5;      ///< metres
inline constexpr Limits limits{20, 40};  ///< m/s and m/s2

}  // namespace coppice::test
