// The way of a disc that overlaps an obstacle a little: straight to where it is free, with a clearance that
// only grows. Nobody knows better than to some centimetres where a robot stands, so its disc may overlap a
// wall by so much.
//
// Metres.
#pragma once

#include <optional>

#include "coppice/planning/clearance_field.h"

namespace coppice {

/// Whether the clearance only grows from a to b, until it is `radius` at least.
bool leads_out(const ClearanceField& field, const Point2& a, const Point2& b, double radius);

/// The nearest place straight ahead of p, about, at which a disc of `radius` is free, if the clearance only
/// grows on the way there. p itself if it is free there. None: it overlaps obstacles by `most_overlap` or
/// more, or no straight way leads out.
std::optional<Point2> way_out(const ClearanceField& field, const Point2& p, double radius,
                              double most_overlap);

}  // namespace coppice
