// Whether a way from start to goal can exist at all: the proof that a sampling planner cannot give.
#pragma once

#include "planning/clearance_field.h"

namespace coppice {

/// True only if no path of a disc of `radius` leads from `start` to `goal`: a flood fill of all square
/// patches in which the disc might fit somewhere, from the start's, does not come to the goal's. Patches are
/// a quarter of a cell wide, so that a passage is seen to be closed where it is narrower than 2 radius by
/// more than about a third of a cell. Time linear in the patches that are reached.
bool provably_unreachable(const ClearanceField& field, const Point2& start, const Point2& goal,
                          double radius);

}  // namespace coppice
