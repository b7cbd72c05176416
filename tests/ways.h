// Checks a path against the map.
#pragma once

#include <cstddef>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "coppice/planning/plan_paths.h"

namespace coppice::test {

/// Whether the path leads from start to goal and is free for a disc of the problem's radius.
inline bool is_way(const Path& path, const PlanningProblem& p, const ClearanceField& field) {
  if (path.size() < 2 || path.front() != p.start || path.back() != p.goal) return false;
  for (std::size_t k = 1; k < path.size(); ++k) {
    if (!field.segment_free(path[k - 1], path[k], p.radius)) return false;
  }
  return true;
}

}  // namespace coppice::test
