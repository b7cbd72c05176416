// Tells a joint planner where the members of a round are to go.
//
// Metres in the map frame.
#pragma once

#include <span>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "motion/joint/joint_plan.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

/// Whether a disc at p reaches into the map.
bool is_on_map(const ClearanceField& field, const Point2& p, double radius = 0);

/// The tasks of the members, then the obstacles. Each member is to drive to its goal. Where robots at their
/// goals would stand too close to each other, or to an obstacle, the member is to stand beside its goal,
/// where it has arrived as well. A robot that has arrived stays where it is, unless others have no room then.
/// A robot that has given up may be sent anywhere.
std::vector<JointTask> joint_tasks(std::span<const FleetMember> members, std::span<const JointTask> obstacles,
                                   const ClearanceField& field);
/// The same, but robots that have arrived go to their very goals: off these they may close a passage.
std::vector<JointTask> joint_tasks_at_goals(std::span<const FleetMember> members,
                                            std::span<const JointTask> obstacles,
                                            const ClearanceField& field);

}  // namespace coppice
