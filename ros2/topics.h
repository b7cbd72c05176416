// The one table of the topics that Coppice has in ROS 2: name, and how it is delivered. Types are those of
// idl/ros2.idl, DDS names follow from ros_names.h, what each carries is in ros_conversion.h.
//
// QoS as ROS 2 has it by default (rmw_qos_profile_default: reliable, volatile, the last 10), and for tf, map
// and plan as tf2, map_server and planners have it.
#pragma once

#include "messages/topics.h"

namespace coppice::ros_topics {

using enum Reliability;
using enum Durability;

// clang-format off
//                                    name         reliability durability      depth   type
inline constexpr TopicInfo odom     {"odom",      reliable, volatile_,        10};  // Odometry
inline constexpr TopicInfo tf       {"tf",        reliable, volatile_,       100};  // TFMessage
inline constexpr TopicInfo cmd_vel  {"cmd_vel",   reliable, volatile_,        10};  // Twist
inline constexpr TopicInfo plan     {"plan",      reliable, transient_local,   1};  // Path
inline constexpr TopicInfo map      {"map",       reliable, transient_local,   1};  // OccupancyGrid
inline constexpr TopicInfo goal_pose{"goal_pose", reliable, volatile_,        10};  // PoseStamped
// clang-format on

}  // namespace coppice::ros_topics
