#include "ros2/dds_conversion.h"

#include <cmath>
#include <cstdint>

#include "ros2/names.h"

namespace coppice {

namespace builtin = builtin_interfaces::msg::dds_;
namespace geometry = geometry_msgs::msg::dds_;
namespace nav = nav_msgs::msg::dds_;
namespace tf2 = tf2_msgs::msg::dds_;

namespace {

constexpr std::uint8_t occupied = 100;  // percent, as map_server publishes it

builtin::Time_ time_of(WallTime time) {
  const double whole = std::floor(time);
  builtin::Time_ result;
  result.sec(static_cast<std::int32_t>(whole));
  result.nanosec(static_cast<std::uint32_t>((time - whole) * 1e9));
  return result;
}

template <class Sample>
void set_header(Sample& sample, WallTime stamp, const std::string& frame) {
  sample.header().stamp(time_of(stamp));
  sample.header().frame_id(frame);
}

template <class V>
void set(V& vector, const Point2& p) {
  vector.x(p.x());
  vector.y(p.y());
}

void set(geometry::Quaternion_& rotation, double yaw) {
  rotation.z(std::sin(yaw / 2));
  rotation.w(std::cos(yaw / 2));
}

void set(geometry::Pose_& to, const RosPose& pose) {
  set(to.position(), pose.position);
  set(to.orientation(), pose.yaw);
}

void set(geometry::Twist_& to, const RosTwist& twist) {
  set(to.linear(), twist.linear);
  to.angular().z(twist.angular);
}

RosPose pose_from(const geometry::Pose_& pose) {
  const auto& turn = pose.orientation();
  return {{pose.position().x(), pose.position().y()}, yaw_of(turn.x(), turn.y(), turn.z(), turn.w())};
}

}  // namespace

/// Covariances stay 0: a virtual robot is exactly where it says.
nav::Odometry_ odometry_of(const RosOdometry& message, const RosNames& names, const RobotName& robot) {
  nav::Odometry_ sample;
  set_header(sample, message.stamp, filled(names.odom_frame, robot));
  sample.child_frame_id(filled(names.base_frame, robot));
  set(sample.pose().pose(), message.pose);
  set(sample.twist().twist(), message.twist);
  return sample;
}

/// map -> odom, which coincide because nothing drifts, and odom -> base_link (REP 105).
tf2::TFMessage_ transforms_of(const RosOdometry& message, const RosNames& names, const RobotName& robot) {
  tf2::TFMessage_ sample;
  sample.transforms().resize(2);
  geometry::TransformStamped_& odom = sample.transforms()[0];
  set_header(odom, message.stamp, names.map_frame);
  odom.child_frame_id(filled(names.odom_frame, robot));
  set(odom.transform().rotation(), 0.0);
  geometry::TransformStamped_& base = sample.transforms()[1];
  set_header(base, message.stamp, filled(names.odom_frame, robot));
  base.child_frame_id(filled(names.base_frame, robot));
  set(base.transform().translation(), message.pose.position);
  set(base.transform().rotation(), message.pose.yaw);
  return sample;
}

/// Each pose faces the next one. The last pose faces as the one before.
nav::Path_ path_of(const RosPlan& plan, const RosNames& names) {
  nav::Path_ sample;
  set_header(sample, plan.stamp, names.map_frame);
  sample.poses().resize(plan.way.size());
  Heading heading;
  for (std::size_t k = 0; k < plan.way.size(); ++k) {
    if (k + 1 < plan.way.size()) heading.facing(plan.way[k + 1] - plan.way[k]);
    set_header(sample.poses()[k], plan.stamp, names.map_frame);
    set(sample.poses()[k].pose(), {plan.way[k], heading.yaw()});
  }
  return sample;
}

nav::OccupancyGrid_ grid_of(const OccupancyMap& map, const RosNames& names, WallTime now) {
  const OccupancyMap up = with_y_up(map);
  nav::OccupancyGrid_ sample;
  set_header(sample, now, names.map_frame);
  sample.info().map_load_time(time_of(now));
  sample.info().resolution(static_cast<float>(up.resolution));
  sample.info().width(static_cast<std::uint32_t>(up.width));
  sample.info().height(static_cast<std::uint32_t>(up.height));
  set(sample.info().origin(), {up.origin, 0});
  sample.data().reserve(up.blocked.size());
  for (const std::uint8_t blocked : up.blocked) sample.data().push_back(blocked != 0 ? occupied : 0);
  return sample;
}

RosOdometry odometry_from(const nav::Odometry_& sample, WallTime arrived) {
  const auto& twist = sample.twist().twist();
  return {.stamp = arrived,
          .frame = sample.header().frame_id(),
          .pose = pose_from(sample.pose().pose()),
          .twist = {{twist.linear().x(), twist.linear().y()}, twist.angular().z()}};
}

/// It says nothing of the velocity.
RosOdometry odometry_from(const geometry::PoseWithCovarianceStamped_& sample, WallTime arrived) {
  return {.stamp = arrived, .frame = sample.header().frame_id(), .pose = pose_from(sample.pose().pose())};
}

std::vector<RosTransform> transforms_from(const tf2::TFMessage_& sample, bool is_static) {
  std::vector<RosTransform> all;
  for (const geometry::TransformStamped_& t : sample.transforms()) {
    const auto& place = t.transform().translation();
    const auto& turn = t.transform().rotation();
    const RosPose pose{{place.x(), place.y()}, yaw_of(turn.x(), turn.y(), turn.z(), turn.w())};
    all.push_back({t.header().frame_id(), t.child_frame_id(), pose, is_static});
  }
  return all;
}

RosGoal goal_from(const geometry::PoseStamped_& sample, const RobotName& robot) {
  const auto& turn = sample.pose().orientation();
  const bool turns = turn.x() != 0 || turn.y() != 0 || turn.z() != 0 || turn.w() != 0;
  const RosPose pose = pose_from(sample.pose());
  return {robot, sample.header().frame_id(), pose.position, turns ? std::optional(pose.yaw) : std::nullopt};
}

geometry::TwistStamped_ stamped_twist_of(const RosCommand& message, const RosNames& names,
                                         const RobotName& robot) {
  geometry::TwistStamped_ sample;
  set_header(sample, message.stamp, filled(names.base_frame, robot));
  set(sample.twist(), message.twist);
  return sample;
}

geometry::Twist_ twist_of(const RosCommand& message) {
  geometry::Twist_ sample;
  set(sample, message.twist);
  return sample;
}

}  // namespace coppice
