// What one agent says in ROS 2, and hears from there: plain values to and from the frames of ROS
// (ros2/conversion.h). Pure; ros2/dds_ros.h carries them.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "messages/messages.h"
#include "robot_agent/robot_agent.h"
#include "ros2/conversion.h"

namespace coppice {

class RosSide {
 public:
  explicit RosSide(RobotName robot) : robot_(std::move(robot)) {}

  /// All that the agent hears, and says itself: of these it takes the map, and its path.
  void heard(const Message& message);
  void said(const Message& message);

  /// Where the robot was seen, of odometry that problem_with found fine.
  OdometrySample sighting(const RosOdometry& seen);

  /// Twenty times a second: where the robot is, if that is for the agent to say, and how it is to move; and
  /// its path when that is another one. Nothing before its first mission.
  std::vector<RosMessage> step(const RobotAgent& agent, WallTime now);

 private:
  RosOdometry odometry(const Run& run, WallTime now);

  RobotName robot_;
  YAxis y_axis_ = YAxis::down;
  std::optional<Path> path_;  ///< not yet passed on; in the map frame
  Heading heading_;
  double yaw_ = 0;  ///< of the robot, if it says so itself
  WallTime next_ = 0;
};

}  // namespace coppice
