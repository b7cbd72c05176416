// Straighter ways for the same joint plan: a robot's consecutive moves are laid onto one straight line where
// everybody stays clear of everybody, at every point of the plan's order, which stays as it is.
//
// Metres in the map frame.
#pragma once

#include <span>
#include <vector>

#include "motion/joint_plan.h"
#include "planning/clearance_field.h"

namespace coppice {

/// The same robots make as many moves in the same order, or fewer: those that lead nowhere are left out. They
/// end where they did.
std::vector<Move> straightened(const ClearanceField& field, std::span<const JointTask> tasks,
                               std::span<const Move> moves);

}  // namespace coppice
