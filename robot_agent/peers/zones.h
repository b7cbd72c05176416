// Where a failed robot may stand.
//
// A failed robot stands where it braked to after its last decision. The last decisions may have reached
// nobody. So it stands at one of several points along its heading: its zone. Metres.
#pragma once

#include <functional>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"

namespace coppice {

struct Zone {
  /// Positions of the robot's centre, along its heading. The robot may stand at each one, and between two.
  /// The first one follows from the last decision that was heard. None: the robot is not failed.
  std::vector<Point2> rests{};
  /// Fleet time from which on the robot is sure to stand at one of them.
  double at_rest_from = 0;
};

/// Metres between a point and the nearest edge of a robot that is alive.
using RoomAt = std::function<double(const Point2&)>;

/// The zone after a robot's last state, which was heard at `heard_at`. `unheard`: so many later states may
/// have reached nobody. The zone ends where an obstacle is.
Zone zone_after(const RobotState& last, double heard_at, int unheard, const ClearanceField& field);

/// Removes the positions at which a robot that is alive has come to stand meanwhile. `radius`: of the failed
/// robot. The first position stays.
void prune(Zone& zone, double radius, const RoomAt& room_at);

/// Discs of this radius around all `rests` cover the failed robot, wherever it stands, for a robot with
/// `own_radius` that stays out of them.
double covering_radius(const Zone& zone, double radius, double own_radius);

}  // namespace coppice
