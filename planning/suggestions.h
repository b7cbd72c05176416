// Suggests the step of the trees and the number of trees that grow at a time. The best values depend on the
// width of the free space.
#pragma once

#include <cstddef>

#include "coppice/planning/clearance_field.h"

namespace coppice {

/// Epsilon for robots of `radius`, metres. It is proportional to the mean clearance of the positions where
/// such a robot fits (measured: docs/planning.md).
double suggested_epsilon(const ClearanceField& field, double radius);

/// Number of disjointed trees that grow at a time: proportional to the map's area in squares of epsilon,
/// within bounds.
std::size_t suggested_trees(const ClearanceField& field, double epsilon);

}  // namespace coppice
