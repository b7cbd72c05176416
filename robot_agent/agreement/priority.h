// The order in which robots plan their reservations.
//
// Robots that plan first drive nearly freely, and the rest go around them. The sum of the arrival times is
// least if robots with short ways plan first, as with the shortest job first. Two kinds of robots must not be
// treated so. In a maze, robots with long ways have no way around those that have arrived early. And a robot
// that closes a passage at its goal must be the last one there.
//
// Metres in the map frame.
#pragma once

#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"

namespace coppice {

/// The priority of a disc that is to drive along `way`, without regard to others. The way has two points or
/// more.
Priority priority_of(const Path& way, double radius, const ClearanceField& field);

/// Whether nobody of the same size gets past a disc that stands at p: free places around it are not
/// connected.
bool closes_a_passage(const Point2& p, double radius, const ClearanceField& field);

/// Whether the first of two robots plans before the second.
bool plans_first(Priority priority, double way, const RobotName& robot, Priority other_priority,
                 double other_way, const RobotName& other);

}  // namespace coppice
