// Straightens the ways of a joint plan: consecutive moves of a robot are laid onto one straight line where
// all robots stay clear of each other at each point of the plan's order, which does not change.
//
// Metres in the map frame.
#pragma once

#include <span>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "motion/joint/joint_plan.h"

namespace coppice {

/// The same robots make the same number of moves in the same order, or fewer: moves of length 0 are left out.
/// The robots end at the same positions.
std::vector<Move> straightened(const ClearanceField& field, std::span<const JointTask> tasks,
                               std::span<const Move> moves);

}  // namespace coppice
