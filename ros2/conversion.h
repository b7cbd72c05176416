// Between Coppice's map frame and what ROS 2 speaks of, as plain values.
//
// ROS is right-handed: x to the right, y up, yaw counterclockwise from x (REP 103). Maps whose y grows down
// the picture (Moving AI) are turned over about their line y = 0: a point (x, y) is (x, -y) in ROS, so that
// RViz shows the picture as the file has it, and robots where they are on it.
//
// Metres, radians; times in ROS are those of the wall's clock, and speeds are metres per second of that.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "messages/fleet_clock.h"
#include "messages/messages.h"
#include "planning/geometry.h"
#include "planning/occupancy_map.h"

namespace coppice {

struct RosPose {
  Point2 position = Point2::Zero();  ///< in the map frame of ROS
  double yaw = 0;
};

/// In the robot's own frame: x ahead, y to its left.
struct RosTwist {
  Point2 linear = Point2::Zero();
  double angular = 0;
};

/// /NAME/odom: where a robot is, and how it moves.
struct RosOdometry {
  WallTime stamp = 0;   ///< of what is read: when it arrived
  std::string frame{};  ///< of what is read: in which the pose is
  RosPose pose{};
  RosTwist twist{};
};

/// /NAME/cmd_vel: how it is to move.
struct RosCommand {
  RosTwist twist{};
};

/// /NAME/plan: its way; in the map frame of ROS.
struct RosPlan {
  WallTime stamp = 0;
  Path way{};
};

/// /NAME/goal_pose: where somebody wants the robot to go. As it was read: anything may stand in it.
struct RosGoal {
  RobotName robot;
  std::string frame{};
  Point2 position = Point2::Zero();
};

/// What an agent says.
using RosMessage = std::variant<RosOdometry, RosCommand, RosPlan>;

/// There and back: the frame of ROS differs from the map's in y's direction alone.
inline Point2 turned(const Point2& p, YAxis y_axis) {
  return y_axis == YAxis::up ? p : Point2(p.x(), -p.y());
}

/// The same map with y up, as ROS has it: what lies at p lies at turned(p).
OccupancyMap with_y_up(const OccupancyMap& map);

/// -pi to pi.
double wrapped(double angle);

/// A vector in the frame of a robot with that yaw, and back.
Point2 into_robot(const Point2& v, double yaw);
Point2 out_of_robot(const Point2& v, double yaw);

/// Of a quaternion: which way its x axis points, seen from above.
double yaw_of(double x, double y, double z, double w);

/// What came in and cannot be right, or nothing. Nothing of it is to be used before.
std::optional<std::string> problem_with(const RosOdometry& seen);
std::optional<std::string> problem_with(const RosGoal& goal);

/// Which way a disc faces: where it drives, and while it stands as before.
class Heading {
 public:
  /// `velocity`: in the map frame of ROS, m/s.
  double facing(const Point2& velocity);
  double yaw() const { return yaw_; }

 private:
  double yaw_ = 0;
};

}  // namespace coppice
