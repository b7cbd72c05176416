// The robots of a cluster on a packed roadmap (packed_roadmap.h): their starts and goals as vertices, and
// their moves as paths.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "motion/joint_plan.h"
#include "motion/packed_roadmap.h"
#include "motion/vertex_task.h"

namespace coppice {

struct ClusterRoadmap {
  /// `packed` must outlive it. `more` are further vertices. Robots that are not movable are obstacles.
  ClusterRoadmap(PackedRoadmap& packed, std::span<const JointTask> tasks, std::span<const Point2> more);

  /// The moves on the map.
  std::vector<Move> paths_of(std::span<const VertexMove> moves) const;

  std::vector<std::size_t> robots{};      ///< indices of the movable ones; ascending
  std::vector<VertexTask> their_tasks{};  ///< of the movable ones
  AnnotatedRoadmap graph{};
};

}  // namespace coppice
