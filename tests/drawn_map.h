// Maps that are drawn with one character for each cell.
#pragma once

#include <string>
#include <vector>

#include "coppice/planning/occupancy_map.h"

namespace coppice::test {

/// One string for each row: '.' is free, everything else is blocked. The first string is row 0.
inline OccupancyMap drawn(const std::vector<std::string>& rows) {
  OccupancyMap map{
      .width = static_cast<int>(rows[0].size()), .height = static_cast<int>(rows.size()), .blocked = {}};
  for (const std::string& row : rows) {
    for (const char cell : row) map.blocked.push_back(cell != '.');
  }
  return map;
}

}  // namespace coppice::test
