// Robots that meet keep to the right: a small turn of the preferred velocity. Reciprocal velocity obstacles
// alone do not resolve a symmetric encounter, such as many robots in the middle of a circle. All turn to the
// same side: to the right where y points up.
//
// Metres in the map frame, metres per second.
#pragma once

#include <span>

#include "coppice/planning/geometry.h"
#include "motion/body/braking_line.h"

namespace coppice {

/// The preferred velocity of a robot at `position`: turned to the right, if another robot comes towards it
/// from ahead.
Point2 keeping_right(const Point2& preferred, const Point2& position, std::span<const Neighbour> neighbours);

}  // namespace coppice
