// What the paper leaves open in MA-RRdT*, as numbers. docs/planning.md says how each was chosen.
//
// Zhang, Wang, Meng, "Multi-robot Path Planning with Rapidly-exploring Random Disjointed-Trees", 2023,
// Algorithms 1 and 2.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace coppice {

/// Where a failing disjointed tree starts again.
enum class Restarts : std::uint8_t {
  even,    ///< at the next one of points that cover the map evenly
  random,  ///< at a random point, as in the paper
};

inline constexpr std::array<std::string_view, 2> restarts_names{"even", "random"};

struct TreeParameters {
  /// Metres: the longest step, and the largest distance over which trees meet. 0: it follows from the map.
  double epsilon = 0;
  /// Number of disjointed trees that grow at a time. 0: it follows from the map and epsilon.
  std::uint32_t disjointed_trees = 0;
  /// Concentration of the von Mises-Fisher density around the last success, from 0 to 100; 0: uniform.
  double kappa = 2;
  /// A failed sample multiplies the weight of its tree, 10 at first, by this factor; above 0, below 1.
  double failure_factor = 0.7;
  /// A tree of a smaller weight restarts; above 0, at most 10.
  double restart_weight = 0.1;
  /// In units of epsilon, from 0 to 1. A node this close to others of its kind teaches little. 0: each
  /// counts.
  double spacing = 0.25;
  Restarts restarts = Restarts::even;
  bool operator==(const TreeParameters&) const = default;
};

inline constexpr double largest_kappa = 100;
inline constexpr double full_weight = 10;  ///< of a tree that has not failed
inline constexpr double least_failure_factor = 0.01;
inline constexpr double largest_failure_factor = 0.99;
inline constexpr double least_restart_weight = 1e-6;
inline constexpr double largest_spacing = 1;
inline constexpr std::uint32_t most_disjointed_trees = 100'000;

/// The member that makes no sense, and what was expected; nothing if all do.
inline std::optional<std::string_view> fault_of(const TreeParameters& trees) {
  const auto within = [](double x, double least, double most) { return x >= least && x <= most; };
  if (trees.epsilon != 0 && !within(trees.epsilon, 1e-4, 1e9))
    return "epsilon: expected 0, or a number from 1e-4 to 1e9";
  if (trees.disjointed_trees > most_disjointed_trees) return "disjointed_trees: expected at most 100000";
  if (!within(trees.kappa, 0, largest_kappa)) return "kappa: expected a number from 0 to 100";
  if (!within(trees.failure_factor, least_failure_factor, largest_failure_factor))
    return "failure_factor: expected a number from 0.01 to 0.99";
  if (!within(trees.restart_weight, least_restart_weight, full_weight))
    return "restart_weight: expected a number from 1e-6 to 10";
  if (!within(trees.spacing, 0, largest_spacing)) return "spacing: expected a number from 0 to 1";
  if (trees.restarts > Restarts::random) return "restarts: expected even or random";
  return std::nullopt;
}

/// MA-RRdT* without the density rule and the evenly spread points of docs/planning.md: trees restart at
/// random points, each of which counts. 16 disjointed trees, or two for each robot if that is more.
inline TreeParameters plain_parameters(std::uint32_t robots) {
  return {.disjointed_trees = std::max(16U, 2 * robots), .spacing = 0, .restarts = Restarts::random};
}

}  // namespace coppice
