// Converts the samples of ROS 2's types (idl/ros2.idl).
#pragma once

#include <fastdds/rtps/common/SerializedPayload.h>

#include "coppice/planning/occupancy_map.h"
#include "dds/checked_type.h"
#include "ros2.h"
#include "ros2/conversion.h"

namespace coppice {

nav_msgs::msg::dds_::Odometry_ odometry_of(const RosOdometry& message, const RobotName& robot);
tf2_msgs::msg::dds_::TFMessage_ transforms_of(const RosOdometry& message, const RobotName& robot);
nav_msgs::msg::dds_::Path_ path_of(const RosPlan& plan);
nav_msgs::msg::dds_::OccupancyGrid_ grid_of(const OccupancyMap& map, WallTime now);
geometry_msgs::msg::dds_::Twist_ twist_of(const RosCommand& message);

/// May hold anything: check the result with problem_with (ros2/conversion.h).
RosOdometry odometry_from(const nav_msgs::msg::dds_::Odometry_& sample, WallTime arrived);
RosGoal goal_from(const geometry_msgs::msg::dds_::PoseStamped_& sample, const RobotName& robot);

/// A type that never throws while deserialising (dds/checked_type.h). It marks an unreadable sample by its
/// frame.
template <class Support>
class CheckedRosType final : public Support {
 public:
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* bytes, void* data) override {
    if (deserialized<Support>(*this, bytes, data)) return true;
    auto& sample = *static_cast<typename Support::type*>(data);
    sample = {};
    sample.header().frame_id("(unreadable)");
    return true;
  }
};

}  // namespace coppice
