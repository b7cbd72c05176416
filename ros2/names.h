// The names of Coppice's robots, topics and frames in ROS 2, and which of them a robot uses.
//
// Sources: ROS 2 design, "Topic and Service name mapping to DDS" (a topic /NAME is the DDS topic rt/NAME) and
// its rules for names (letters, digits and underscores, no digit first); REP 105 for frames.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "messages/messages.h"

namespace coppice {

/// The names that robots have in ROS. In each, {} stands for the robot's name as ros_name() writes it.
struct RosNames {
  std::string robot_namespace{"{}"};  ///< of its topics, without a slash at either end
  std::string base_frame{"{}/base_link"};
  std::string odom_frame{"{}/odom"};
  std::string map_frame{"map"};  ///< of the fleet: with y up (ros2/conversion.h)
  std::string tf{"tf"};          ///< topic of the robot's transforms; that of static ones is NAME_static
};

/// Where the pose of a robot comes from that is outside of Coppice.
enum class PoseSource : std::uint8_t {
  none,       ///< it is not outside: Coppice moves it, and says where it is
  odom,       ///< /ROBOT/odom, in the map's frame
  amcl_pose,  ///< /ROBOT/amcl_pose
  tf,         ///< the transforms from the map's frame to the robot's
};

/// A robot's side of ROS.
struct RosRobotSettings {
  RosNames names{};
  PoseSource pose = PoseSource::none;
  bool stamped = false;  ///< cmd_vel is a TwistStamped
};

/// A robot's name as a part of ROS names: each byte that is no letter, digit or underscore becomes an
/// underscore, and a name that would begin with a digit gets an underscore in front. Valid ROS names stay
/// unchanged.
std::string ros_name(const RobotName& robot);

/// A name with the robot's in the places of {}.
std::string filled(const std::string& name, const RobotName& robot);

/// Throws std::runtime_error if two of these robots have the same name in ROS.
void check_ros_names(const RosNames& names, std::span<const RobotName> robots);

/// The DDS topic of a robot's ROS topic, as "rt/r1/odom".
std::string ros_topic(const RosNames& names, const RobotName& robot, std::string_view topic);
/// The DDS topic of a ROS topic of the whole fleet, as "rt/map".
std::string ros_topic(std::string_view topic);

}  // namespace coppice
