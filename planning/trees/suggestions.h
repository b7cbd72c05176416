// Suggests the step of the trees and the number of trees that grow at a time. The best values depend on the
// width of the free space.
#pragma once

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/tree_parameters.h"

namespace coppice {

/// Epsilon for robots of `radius`, metres. It is proportional to the mean clearance of the positions where
/// such a robot fits (measured: docs/planning.md).
double suggested_epsilon(const ClearanceField& field, double radius);

/// The parameters with what follows from the map. The number of disjointed trees that grow at a time is
/// proportional to the map's area in squares of epsilon, within bounds.
TreeParameters completed(TreeParameters parameters, const ClearanceField& field, double radius);

}  // namespace coppice
