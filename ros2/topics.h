// The table of the topics that Coppice has in ROS 2: name and QoS. The types are those of idl/ros2.idl,
// ros2/names.h gives the DDS names, and ros2/conversion.h the content.
//
// The QoS are ROS 2's defaults (rmw_qos_profile_default: reliable, volatile, the last 10); for tf, map and
// plan those of tf2, map_server and the planners.
#pragma once

#include "messages/topics.h"

namespace coppice::ros_topics {

using enum Reliability;
using enum Durability;

// clang-format off
//                                    name         reliability durability      depth   type
inline constexpr TopicInfo odom     {"odom",      reliable, volatile_,        10};  // Odometry
inline constexpr TopicInfo tf       {"tf",        reliable, volatile_,       100};  // TFMessage
inline constexpr TopicInfo tf_static{"tf_static", reliable, transient_local, 100};  // TFMessage
inline constexpr TopicInfo amcl_pose{"amcl_pose", reliable, transient_local,   1};  // PoseWithCovarianceStamped
inline constexpr TopicInfo cmd_vel  {"cmd_vel",   reliable, volatile_,        10};  // Twist, or TwistStamped
inline constexpr TopicInfo plan     {"plan",      reliable, transient_local,   1};  // Path
inline constexpr TopicInfo map      {"map",       reliable, transient_local,   1};  // OccupancyGrid
inline constexpr TopicInfo goal_pose{"goal_pose", reliable, volatile_,        10};  // PoseStamped
// clang-format on

}  // namespace coppice::ros_topics
