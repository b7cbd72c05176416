// A fast robot comes along a corridor to a hall in which slow robots drive.
#pragma once

#include <utility>

#include "coppice/files/scenario.h"
#include "tests/unit/motion/plans.h"

namespace coppice::test {

/// A corridor 5 m wide, with a hall of 70 x 26 m at 800 m.
inline Scenario corridor_with_hall() {
  OccupancyMap map = open_map(1190, 26);
  for (const int side : {0, 15}) {
    const int end = side == 0 ? 10 : 26;
    block(map, 0, side, 800, end);
    block(map, 870, side, 1190, end);
  }
  constexpr double acceleration = 11.715759000754009;
  constexpr double slow = 17.672250211505325;
  return {.map_name = "corridor with hall",
          .map = std::move(map),
          .seed = 9110103,
          .robots = {{"z", {10, 12.5}, {1182, 12.5}, 2, 100, acceleration, 1},
                     {"a0", {806, 4}, {864, 4}, 3, slow, acceleration, 1},
                     {"a1", {864, 22}, {806, 22}, 3, slow, acceleration, 1},
                     {"a2", {835, 4}, {835, 22}, 3, slow, acceleration, 1}}};
}

}  // namespace coppice::test
