// A fleet as lines of text, for `coppice top`.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "monitor/view/fleet_view.h"

namespace coppice {

/// The order of the robots in the table. The most interesting robots come first.
enum class RobotOrder : unsigned char {
  name,     ///< r2 before r10
  phase,    ///< first without a path, then waiting, planning, driving, arrived
  to_goal,  ///< the longest way to go first
  age,      ///< the oldest state first
  missed,   ///< the largest share of missed control periods first
};
inline constexpr std::array<std::string_view, 5> robot_orders{"name", "phase", "to-goal", "age", "missed"};

std::optional<RobotOrder> robot_order(std::string_view name);

struct FleetTable {
  std::vector<std::string> summary;  ///< lines above the table
  std::string header;
  std::vector<std::string> rows;  ///< one per robot
};

/// Times are in fleet seconds, positions and lengths in metres, speeds in m/s. Ages are as of `now`.
FleetTable fleet_table(const FleetView& view, RobotOrder order, WallTime now);

std::string_view name_of(Phase phase);

/// The order by name: r2 before r10.
bool sorts_before(const RobotName& a, const RobotName& b);

}  // namespace coppice
