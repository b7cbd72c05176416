// A fleet as lines of text: what `coppice top` shows.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "monitor/fleet_view.h"

namespace coppice {

/// What the robots are sorted by; each begins with those that one looks for.
enum class RobotOrder : unsigned char {
  name,     ///< r2 before r10
  phase,    ///< who has no path, plans, drives, has arrived
  to_goal,  ///< the farthest first
  age,      ///< whose state is the oldest first
  missed,   ///< who misses most of its control periods first
};
inline constexpr std::array<std::string_view, 5> robot_orders{"name", "phase", "to-goal", "age", "missed"};

std::optional<RobotOrder> robot_order(std::string_view name);

struct FleetTable {
  std::vector<std::string> summary;  ///< lines above the table
  std::string header;
  std::vector<std::string> rows;  ///< a robot each
};

/// Times in fleet seconds, places and lengths in metres, speeds in m/s; ages as of `now`.
FleetTable fleet_table(const FleetView& view, RobotOrder order, WallTime now);

std::string_view name_of(Phase phase);

}  // namespace coppice
