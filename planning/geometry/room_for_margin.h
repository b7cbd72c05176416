// Whether discs can be larger by a margin and still go wherever they go without it.
//
// Larger discs have less room. The margin is harmless if only a rim of the free space is lost: no passage
// closes, no way around an obstacle, and no bay in which a robot lets another one pass. The free spaces of
// both discs are compared on a lattice: they have equally many parts, the same Euler characteristic (parts
// minus holes; Serra, "Image Analysis and Mathematical Morphology", 1982), and no lost point is far from the
// space that is left.
//
// Metres.
#pragma once

#include <span>

#include "coppice/planning/clearance_field.h"

namespace coppice {

/// Compares the parts of the map that hold `places`. The time is linear in the number of cells.
bool leaves_all_passages(const ClearanceField& field, double radius, double margin,
                         std::span<const Point2> places);

}  // namespace coppice
