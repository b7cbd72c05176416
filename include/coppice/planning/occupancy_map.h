// A map: a grid of square cells, each blocked or free.
//
// Frame: cell (i, j) covers origin + [i, i+1] x [j, j+1] times the resolution. In Moving AI maps the
// resolution is 1 m, the origin is (0, 0) and y grows downwards, so j is the line of the file. In ROS maps y
// grows upwards, so row 0 is the image's last line. Blocked cells are closed squares. All that lies outside
// of the grid is blocked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/planning/geometry.h"

namespace coppice {

/// The direction in which y grows in a picture of the map. It does not affect planning.
enum class YAxis : std::uint8_t { down, up };

/// The positions of a grid's cells.
struct GridFrame {
  int width = 0;                   ///< cells along x
  int height = 0;                  ///< cells along y
  double resolution = 1.0;         ///< metres a cell
  Point2 origin = Point2::Zero();  ///< lower corner of cell (0, 0), metres

  std::size_t cells() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  /// The rectangle that the cells cover, metres.
  Box<2> bounds() const { return {origin, origin + resolution * Point2(width, height)}; }
};

struct OccupancyMap {
  int width = 0;                   ///< cells along x, at least 1
  int height = 0;                  ///< cells along y, at least 1
  double resolution = 1.0;         ///< metres a cell, above 0
  Point2 origin = Point2::Zero();  ///< lower corner of cell (0, 0), metres
  YAxis y_axis = YAxis::down;
  std::vector<std::uint8_t> blocked;  ///< row by row, width * height entries, 1 = blocked

  bool is_blocked(int i, int j) const {
    return i < 0 || j < 0 || i >= width || j >= height ||
           blocked[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(i)] != 0;
  }
  GridFrame frame() const { return {width, height, resolution, origin}; }
  Box<2> bounds() const { return frame().bounds(); }

  bool operator==(const OccupancyMap&) const = default;
};

}  // namespace coppice
