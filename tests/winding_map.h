// A map with one long way: corridors that lie side by side, joined at their ends by turns.
#pragma once

#include <cstdint>

#include "coppice/planning/geometry.h"
#include "coppice/planning/occupancy_map.h"

namespace coppice::test {

/// `side` cells a side, of 1 m. The corridors are 7 m wide, and the walls between them 1 m.
inline OccupancyMap winding_map(int side) {
  constexpr int corridor = 7;
  OccupancyMap map{.width = side, .height = side, .blocked = {}};
  for (int y = 0; y < side; ++y) {
    const bool is_wall = y % (corridor + 1) == corridor;
    const bool opens_on_the_right = y / (corridor + 1) % 2 == 0;
    for (int x = 0; x < side; ++x) {
      const bool is_turn = opens_on_the_right ? x >= side - corridor : x < corridor;
      map.blocked.push_back(static_cast<std::uint8_t>(is_wall && !is_turn));
    }
  }
  return map;
}

/// In the middle of a corridor, which are counted from 0, so many metres from the left.
inline Point2 in_corridor(int corridor, double x) {
  return {x, 8 * corridor + 3.5};
}

/// Through the middle of all corridors from the first one on, as far as there are whole ones.
inline Path way_through(int corridors, int side) {
  Path way;
  for (int k = 0; k < corridors; ++k) {
    const double left = 3.5;
    const double right = side - 3.5;
    way.push_back(in_corridor(k, k % 2 == 0 ? left : right));
    way.push_back(in_corridor(k, k % 2 == 0 ? right : left));
  }
  return way;
}

}  // namespace coppice::test
