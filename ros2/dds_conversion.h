// Converts the samples of ROS 2's types (idl/ros2.idl).
#pragma once

#include <fastdds/rtps/common/SerializedPayload.h>

#include "coppice/planning/occupancy_map.h"
#include "dds/checked_type.h"
#include "ros2.h"
#include "ros2/conversion.h"
#include "ros2/names.h"
#include "ros2/transforms.h"

namespace coppice {

nav_msgs::msg::dds_::Odometry_ odometry_of(const RosOdometry& message, const RosNames& names,
                                           const RobotName& robot);
tf2_msgs::msg::dds_::TFMessage_ transforms_of(const RosOdometry& message, const RosNames& names,
                                              const RobotName& robot);
nav_msgs::msg::dds_::Path_ path_of(const RosPlan& plan, const RosNames& names);
nav_msgs::msg::dds_::OccupancyGrid_ grid_of(const OccupancyMap& map, const RosNames& names, WallTime now);
geometry_msgs::msg::dds_::Twist_ twist_of(const RosCommand& message);
geometry_msgs::msg::dds_::TwistStamped_ stamped_twist_of(const RosCommand& message, const RosNames& names,
                                                         const RobotName& robot);

/// May hold anything: check the result with problem_with (ros2/conversion.h).
RosOdometry odometry_from(const nav_msgs::msg::dds_::Odometry_& sample, WallTime arrived);
RosOdometry odometry_from(const geometry_msgs::msg::dds_::PoseWithCovarianceStamped_& sample,
                          WallTime arrived);
std::vector<RosTransform> transforms_from(const tf2_msgs::msg::dds_::TFMessage_& sample, bool is_static);
RosGoal goal_from(const geometry_msgs::msg::dds_::PoseStamped_& sample, const RobotName& robot);

/// A type that never throws while deserialising (dds/checked_type.h). It marks an unreadable sample by its
/// frame, or leaves it empty.
template <class Support>
class CheckedRosType final : public Support {
 public:
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* bytes, void* data) override {
    if (deserialized<Support>(*this, bytes, data)) return true;
    auto& sample = *static_cast<typename Support::type*>(data);
    sample = {};
    if constexpr (requires { sample.header(); }) sample.header().frame_id("(unreadable)");
    return true;
  }
};

}  // namespace coppice
