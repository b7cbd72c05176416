// Moves points and paths away from obstacles.
//
// The shortest path of a disc touches obstacles at its corners. A robot that rounds a corner needs room
// there.
//
// Metres in the map frame.
#pragma once

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"

namespace coppice {

/// The direction in which the clearance grows most around p, of length 1; zero: in none. `near`: metres
/// between p and the points at which the clearance is compared.
Point2 uphill(const ClearanceField& field, const Point2& p, double near);

/// A path that keeps `radius` from obstacles, with each corner so far away from them that it keeps `roomy`,
/// or where it was, if there is no room for that. Both ends stay.
Path off_walls(const Path& path, const ClearanceField& field, double radius, double roomy);

}  // namespace coppice
