// How long a step the trees take and how many grow at a time, from the map: the best values follow the width
// of the free space.
#pragma once

#include <cstddef>

#include "planning/clearance_field.h"

namespace coppice {

/// Epsilon for robots of `radius`, metres: in proportion to the width of the room that the places where such
/// a robot fits leave around it (measured: docs/planning.md).
double suggested_epsilon(const ClearanceField& field, double radius);

/// Disjointed trees that grow at a time: in proportion to the map's size in steps, within bounds.
std::size_t suggested_trees(const ClearanceField& field, double epsilon);

}  // namespace coppice
