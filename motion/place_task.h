// What the robots of a crowd want on a graph of places, and what they do there.
#pragma once

#include <cstdint>
#include <optional>

#include "motion/place_graph.h"

namespace coppice {

struct PlaceTask {
  Place start = 0;
  std::optional<Place> goal{};  ///< none: anywhere
};

/// A robot takes one of the edges that lead from a place.
struct PlaceMove {
  std::uint32_t robot;
  Place from;
  std::uint32_t edge;
};

}  // namespace coppice
