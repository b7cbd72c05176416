// Reciprocal velocity obstacles as a linear programme: the velocity nearest to the preferred one that keeps
// clear of the other discs and of obstacles for a given time.
//
// van den Berg, Guy, Lin, Manocha, "Reciprocal n-Body Collision Avoidance", 2011 (ORCA). Obstacles become the
// tangents of a convex free region around the disc, which grows from the nearest obstacle on, as in safe
// flight corridors (Liu et al., "Planning Dynamically Feasible Trajectories for Quadrotors Using Safe Flight
// Corridors in 3-D Complex Environments", 2017).
//
// Metres in the map frame, metres per second, seconds. All inputs must be finite. Velocities are exact to
// within 1e-9 m/s. Only the caller's vector allocates memory; the caller may use it again.
//
// Two discs that meet in perfect symmetry only slow each other down, because the geometry prefers no side.
// The caller breaks the tie: it turns every preferred velocity a little to the same side.
#pragma once

#include <span>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"

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

/// How far `velocity` lies on the forbidden side, m/s; negative within the half plane.
double violation(const HalfPlane& plane, const Point2& velocity);

/// The velocities of `self` with which it does not touch `other` within `horizon` seconds (above 0), if
/// `other` makes the rest of the required change. Discs that overlap already are separated within `time_step`
/// seconds (above 0). `responsibility`, in [0, 1], is the share of the change that `self` makes: 0.5 if the
/// other does the same, 1 if it does nothing. Two discs with the same position and velocity are both moved
/// along x in the same direction, so they stay together until their velocities differ.
HalfPlane orca_half_plane(const MovingDisc& self, const MovingDisc& other, double horizon, double time_step,
                          double responsibility = 0.5);

/// Appends the half planes of the obstacles within `radius` + `reach` (metres) of p: a disc of `radius` at p
/// that moves within them for `horizon` seconds (above 0) overlaps none of these obstacles. With `reach` the
/// horizon times the highest speed, no other obstacle matters. Standing still is always allowed. A disc that
/// overlaps an obstacle may move along it and away from it. If p lies outside of the field's bounds, nothing
/// is appended.
void obstacle_half_planes(const ClearanceField& field, const Point2& p, double radius, double reach,
                          double horizon, std::vector<HalfPlane>& out);

/// The velocity nearest to `preferred` and no faster than `max_speed` (>= 0) that lies within all half
/// planes. If there is none, the hard ones still hold, and the largest violation of a soft one is as small as
/// possible. Standing still must lie within all hard ones, as it does for those of obstacles.
Point2 safe_velocity(const Point2& preferred, double max_speed, std::span<const HalfPlane> hard,
                     std::span<const HalfPlane> soft);

}  // namespace coppice
