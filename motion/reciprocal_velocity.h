// Reciprocal velocity obstacles as a linear programme: the velocity nearest to the preferred one that keeps
// clear of the other discs and of obstacles for a while.
//
// van den Berg, Guy, Lin, Manocha, "Reciprocal n-Body Collision Avoidance", 2011 (ORCA). Obstacles become the
// tangents of a convex free region around the disc, grown nearest first, as in safe flight corridors (Liu et
// al., "Planning Dynamically Feasible Trajectories for Quadrotors Using Safe Flight Corridors in 3-D Complex
// Environments", 2017).
//
// Metres in the map frame, metres per second, seconds; every input is finite. Velocities are decided to
// within 1e-9 m/s. Nothing here allocates, but for the vector that the caller gives and may use again.
//
// Two discs that meet in perfect symmetry only slow each other down: nothing in the geometry says who goes
// left. The caller breaks the tie, by turning every preferred velocity a little to the same side.
#pragma once

#include <span>
#include <vector>

#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

/// The velocities on the line through `point` along the unit vector `direction`, and all to the left of it.
struct HalfPlane {
  Point2 point;      ///< m/s
  Point2 direction;  ///< unit length
};

struct MovingDisc {
  Point2 position;    ///< m
  Point2 velocity;    ///< m/s
  double radius = 0;  ///< m, >= 0
};

/// How far `velocity` is on the forbidden side, m/s; negative within the half plane.
double violation(const HalfPlane& plane, const Point2& velocity);

/// The velocities of `self` with which it does not touch `other` within `horizon` seconds (above 0), if
/// `other` takes on the rest of the change that is needed. Discs that overlap already are parted within
/// `time_step` seconds (above 0). `responsibility`, in [0, 1], is the share of the change that `self` takes
/// on: a half where the other does the same, 1 where it does nothing. Two discs that agree in place and in
/// velocity are parted along x, both the same way: they stay together until their velocities differ.
HalfPlane orca_half_plane(const MovingDisc& self, const MovingDisc& other, double horizon, double time_step,
                          double responsibility = 0.5);

/// Appends the half planes of the obstacles within `radius` + `reach` of p: a disc of `radius` at p that
/// moves within them for `horizon` seconds (above 0) overlaps nothing that lies there. With `reach` the
/// horizon times the highest speed, this is everything that matters. Standing still is always within; a disc
/// that overlaps an obstacle may move along it and away from it. p lies within the field's bounds, or nothing
/// is appended.
void obstacle_half_planes(const ClearanceField& field, const Point2& p, double radius, double reach,
                          double horizon, std::vector<HalfPlane>& out);

/// The velocity nearest to `preferred` and no faster than `max_speed` (>= 0) that lies within all half
/// planes. Where there is none, the hard ones still hold, and the largest violation of a soft one is as small
/// as it can be. Standing still must lie within all hard ones, as it does for those of obstacles.
Point2 safe_velocity(const Point2& preferred, double max_speed, std::span<const HalfPlane> hard,
                     std::span<const HalfPlane> soft);

}  // namespace coppice
