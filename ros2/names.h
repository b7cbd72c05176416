// What Coppice's robots, topics and frames are called in ROS 2.
//
// Sources: ROS 2 design, "Topic and Service name mapping to DDS" (a topic /NAME is the DDS topic rt/NAME) and
// the rules there for names (letters, digits and underscores, no digit first); REP 105 for frames.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "messages/messages.h"

namespace coppice {

/// A robot's name as a part of ROS names: each byte that is no letter, digit or underscore becomes an
/// underscore, and one comes before a digit that would be first. Names in ROS 2 are as they are.
std::string ros_name(const RobotName& robot);

/// Throws std::runtime_error if two of these robots have the same name in ROS.
void check_ros_names(std::span<const RobotName> robots);

/// The DDS topic of a robot's ROS topic: "rt/r1/odom".
std::string ros_topic(const RobotName& robot, std::string_view topic);
/// Of one that the whole fleet shares: "rt/map".
std::string ros_topic(std::string_view topic);

/// A robot's frame, "odom" or "base_link" (REP 105): "r1/base_link".
std::string ros_frame(const RobotName& robot, std::string_view frame);
/// The frame of the map, with y up (ros_conversion.h).
inline constexpr const char* ros_map_frame = "map";

}  // namespace coppice
