// What the members of a round are to do, as a joint planner is told.
//
// Metres in the map frame.
#pragma once

#include <span>
#include <vector>

#include "motion/joint_plan.h"
#include "planning/clearance_field.h"
#include "robot_agent/fleet.h"

namespace coppice {

/// Whether a disc there reaches into the map.
bool is_on_map(const ClearanceField& field, const Point2& p, double radius = 0);

/// Each member is to drive to its goal. Where robots at their goals would stand too close to each other, or
/// to an obstacle, it is to stand beside it, where it has arrived as well. Who has arrived stays where it is,
/// unless others have no room then. Who has given up may be sent anywhere. The members' tasks, then the
/// obstacles.
std::vector<JointTask> joint_tasks(std::span<const FleetMember> members, std::span<const JointTask> obstacles,
                                   const ClearanceField& field);

}  // namespace coppice
