// The planners that a user can choose, and when their shared trees grow.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace coppice {

enum class PlannerKind : std::uint8_t {
  ma_rrdt_star,  ///< Algorithm 2: disjointed trees are shared by all robots
  rrdt_star,     ///< Algorithm 1: each robot plans alone, with disjointed trees of its own
  rrt_star,      ///< the baseline: each robot grows its own RRT*
};

inline constexpr std::array<std::string_view, 3> planner_names{"ma-rrdt", "rrdt", "rrt-star"};

inline std::optional<PlannerKind> planner_kind(std::string_view name) {
  for (std::size_t k = 0; k < planner_names.size(); ++k) {
    if (planner_names[k] == name) return static_cast<PlannerKind>(k);
  }
  return std::nullopt;
}

/// When the disjointed trees that all robots share begin to grow.
enum class ForestStart : std::uint8_t {
  ahead,     ///< they cover the map before missions go out
  together,  ///< with the root trees, as in the paper: the missions go out at once
};

inline constexpr std::array<std::string_view, 2> forest_names{"ahead", "together"};

}  // namespace coppice
