// Tasks and moves of the robots of a cluster on a roadmap.
#pragma once

#include <cstdint>
#include <optional>

#include "motion/lattice/annotated_roadmap.h"

namespace coppice {

struct VertexTask {
  Vertex start = 0;
  std::optional<Vertex> goal{};  ///< none: any vertex will do
};

/// A robot drives along one of the edges that lead from a vertex.
struct VertexMove {
  std::uint32_t robot;
  Vertex from;
  std::uint32_t edge;
};

}  // namespace coppice
