// The names of Coppice's robots, topics and frames in ROS 2.
//
// Sources: ROS 2 design, "Topic and Service name mapping to DDS" (a topic /NAME is the DDS topic rt/NAME) and
// its rules for names (letters, digits and underscores, no digit first); REP 105 for frames.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "messages/messages.h"

namespace coppice {

/// A robot's name as a part of ROS names: each byte that is no letter, digit or underscore becomes an
/// underscore, and a name that would begin with a digit gets an underscore in front. Valid ROS names stay
/// unchanged.
std::string ros_name(const RobotName& robot);

/// Throws std::runtime_error if two of these robots have the same name in ROS.
void check_ros_names(std::span<const RobotName> robots);

/// The DDS topic of a robot's ROS topic, as "rt/r1/odom".
std::string ros_topic(const RobotName& robot, std::string_view topic);
/// The DDS topic of a ROS topic of the whole fleet, as "rt/map".
std::string ros_topic(std::string_view topic);

/// The name of a robot's frame "odom" or "base_link" (REP 105), as "r1/base_link".
std::string ros_frame(const RobotName& robot, std::string_view frame);
/// The frame of the map, with y up (ros2/conversion.h).
inline constexpr const char* ros_map_frame = "map";

}  // namespace coppice
