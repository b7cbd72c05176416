// What the robots of a crowd want on a graph of places, and what they do there.
#pragma once

#include <cstdint>
#include <optional>

#include "motion/annotated_roadmap.h"

namespace coppice {

struct VertexTask {
  Vertex start = 0;
  std::optional<Vertex> goal{};  ///< none: anywhere
};

/// A robot takes one of the edges that lead from a place.
struct VertexMove {
  std::uint32_t robot;
  Vertex from;
  std::uint32_t edge;
};

}  // namespace coppice
