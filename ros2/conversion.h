// Converts between Coppice's map frame and ROS 2, as plain values.
//
// ROS is right-handed: x to the right, y up, yaw counterclockwise from x (REP 103). Maps whose y grows
// downwards (Moving AI) are mirrored at their line y = 0: a point (x, y) becomes (x, -y) in ROS, so that RViz
// shows the map as its file does, with the robots in place.
//
// Metres, radians. Times in ROS are of the wall clock, and speeds are metres per wall second.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "coppice/planning/geometry.h"
#include "coppice/planning/occupancy_map.h"
#include "messages/fleet_clock.h"
#include "messages/messages.h"

namespace coppice {

struct RosPose {
  Point2 position = Point2::Zero();  ///< in the map frame of ROS
  double yaw = 0;
};

/// In the robot's own frame: x forward, y to the left.
struct RosTwist {
  Point2 linear = Point2::Zero();
  double angular = 0;
};

/// /NAME/odom: position and motion of a robot.
struct RosOdometry {
  WallTime stamp = 0;   ///< when it arrived, for a message that was read
  std::string frame{};  ///< frame of the pose, for a message that was read
  RosPose pose{};
  RosTwist twist{};
};

/// /NAME/cmd_vel: the commanded motion.
struct RosCommand {
  WallTime stamp = 0;
  RosTwist twist{};
};

/// /NAME/plan: the robot's path, in the map frame of ROS.
struct RosPlan {
  WallTime stamp = 0;
  Path way{};
};

/// /NAME/goal_pose: a goal that somebody sets for the robot. Not checked yet (problem_with).
struct RosGoal {
  RobotName robot;
  std::string frame{};
  Point2 position = Point2::Zero();
  std::optional<double> yaw{};  ///< none: the orientation says nothing, as one that is all zeros
};

/// The messages that an agent sends.
using RosMessage = std::variant<RosOdometry, RosCommand, RosPlan>;

/// Converts in both directions: the frames differ only in the direction of y.
inline Point2 turned(const Point2& p, YAxis y_axis) {
  return y_axis == YAxis::up ? p : Point2(p.x(), -p.y());
}

/// The same map with y up, as ROS has it: the cell at p is at turned(p).
OccupancyMap with_y_up(const OccupancyMap& map);

/// Turns a vector into the frame of a robot with this yaw, and back.
Point2 into_robot(const Point2& v, double yaw);
Point2 out_of_robot(const Point2& v, double yaw);

/// The yaw of a quaternion: the direction of its x axis, seen from above.
double yaw_of(double x, double y, double z, double w);

/// Describes what is invalid in a received message, or returns nothing. Call it before using the message.
/// `map_frame`: the name of the map's frame.
std::optional<std::string> problem_with(const RosOdometry& seen, const std::string& map_frame);
std::optional<std::string> problem_with(const RosGoal& goal, const std::string& map_frame);

/// The direction in which a disc faces: that of its motion, and the last one while it stands.
class Heading {
 public:
  /// `velocity`: in the map frame of ROS, m/s.
  double facing(const Point2& velocity);
  double yaw() const { return yaw_; }

 private:
  double yaw_ = 0;
};

}  // namespace coppice
