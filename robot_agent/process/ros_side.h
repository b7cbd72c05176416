// Converts between one agent and ROS 2 messages, as plain values in the frames of ROS (ros2/conversion.h).
// ros2/dds_ros.h sends and receives them.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "messages/messages.h"
#include "robot_agent/process/robot_agent.h"
#include "ros2/conversion.h"

namespace coppice {

class RosSide {
 public:
  explicit RosSide(RobotName robot) : robot_(std::move(robot)) {}

  /// All messages that the agent hears and says. The map and the path are taken from them.
  void heard(const Message& message);
  void said(const Message& message);

  /// Without the map it is not known where odometry is in the map's frame.
  bool knows_map() const { return y_axis_.has_value(); }
  /// The position of the robot, from odometry that problem_with found valid.
  OdometrySample sighting(const RosOdometry& seen);

  /// Twenty times a second: the robot's odometry, unless the robot is elsewhere, and its command; and the
  /// path when that changes. Nothing before the first mission.
  std::vector<RosMessage> step(RobotAgent& agent, WallTime now);

 private:
  RosOdometry odometry(const Run& run, WallTime now);
  YAxis y_axis() const { return y_axis_.value_or(YAxis::down); }

  RobotName robot_;
  std::optional<YAxis> y_axis_{};  ///< of the map; none: no map has come
  std::optional<Path> path_;       ///< not yet passed on; in the map frame
  Heading heading_;
  WallTime next_ = 0;
};

}  // namespace coppice
