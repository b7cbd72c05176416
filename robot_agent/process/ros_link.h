// Connects one agent (ros_side.h) to the topics of ROS 2.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "robot_agent/process/robot_agent.h"
#include "robot_agent/process/ros_side.h"
#include "ros2/dds_ros.h"
#include "runtime/process_clock.h"

namespace coppice {

class RosLink {
 public:
  /// The bus outlives it.
  RosLink(DdsBus& bus, const RobotName& robot, const RosRobotSettings& settings)
      : side_(robot), map_frame_(settings.names.map_frame), topics_(bus, robot, settings) {}
  /// The robot stands from now on.
  ~RosLink() { topics_.publish(RosCommand{}); }
  RosLink(const RosLink&) = delete;
  RosLink& operator=(const RosLink&) = delete;

  void heard(const Message& message) { side_.heard(message); }
  void said(const Message& message) { side_.said(message); }

  /// After each step of the agent.
  void turn(RobotAgent& agent, ProcessClock& clock);

 private:
  void refuse(const std::string& problem);
  void tell(const Tracking& tracking, WallTime now);

  RosSide side_;
  std::string map_frame_;
  DdsRosRobot topics_;
  std::size_t refused_ = 0;
  std::optional<bool> in_reach_{};  ///< as it was told last
  WallTime told_at_ = 0;
};

}  // namespace coppice
