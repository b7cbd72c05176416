// How long a step the trees take, from the map: the best epsilon follows the width of the free space.
#pragma once

#include "planning/clearance_field.h"

namespace coppice {

/// Epsilon for robots of `radius`, metres: in proportion to the width of the room that the places where such
/// a robot fits leave around it. Measured in bench/ (docs/planning.md): four times too large costs ten times
/// the time.
double suggested_epsilon(const ClearanceField& field, double radius);

}  // namespace coppice
