// Rounds the corners of a path, or leaves them out, where that saves time.
//
// A robot slows down at a corner, so that it stays close to its path (corner_speed.h). Where there is room
// beside the path, several slight turns along an arc take less time, although the way is longer. Corners that
// follow closely on each other leave little room for arcs, so fewer of them may be better.
//
// Metres in the map frame, radians, seconds.
#pragma once

#include "coppice/motion/kinematics.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"

namespace coppice {

/// The path with wide corners, from the same start to the same end. `clearance`: metres that new edges keep
/// from obstacles. `stray`: metres by which the robot may stray from its path.
Path with_wide_corners(const Path& path, const ClearanceField& field, double clearance, double stray,
                       const Limits& limits);

}  // namespace coppice
