// Where robots begin, whoever says so: the scenario, a file of poses, or what a fleet has saved.
//
// Nobody knows better than to its tolerance where a robot stands. So a robot may stand too near to an
// obstacle by less than that. It drives straight out to where it has room (planning/geometry/way_out.h), and
// plans from there.
//
// Metres in the map frame.
#pragma once

#include <optional>
#include <string>

#include "coppice/files/scenario.h"
#include "coppice/planning/clearance_field.h"

namespace coppice {

/// Where a robot that stands at `place` has room: there, or where it drives out to. None: it is too near to
/// an obstacle by start_tolerance() or more, or no way leads out. A robot that follows may also be off its
/// reference, and a robot may stand within the margin, by which `field` is inflated. `beyond`: metres of room
/// that it is to have in addition.
std::optional<Point2> room_near(const RobotTask& robot, const Point2& place, const ClearanceField& field,
                                double beyond = 0);

/// Makes the robot begin where it stands, with the start that has room. A goal that is the start goes along.
/// If there is no room near, the start is that place all the same: check_place() refuses it. `place` may be
/// the start itself.
void begin_at(RobotTask& robot, Point2 place, const ClearanceField& field, double beyond = 0);

/// Throws InputError, which begins with `name`, if a disc has no room at a place.
void check_place(const Point2& place, const ClearanceField& field, double radius, const std::string& name);

/// Metres between two robots at their starts, and on the ways to them.
double distance_at_starts(const RobotTask& one, const RobotTask& other);

/// "r1 starts 0.01 m too near to an obstacle, at (1, 2): it drives out first"; empty: it has room.
std::string warning_of_start(const RobotTask& robot, const ClearanceField& field);

}  // namespace coppice
