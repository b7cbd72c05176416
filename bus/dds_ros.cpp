#include "bus/dds_ros.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <fastcdr/exceptions/Exception.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include "bus/dds_qos.h"
#include "bus/ros_names.h"
#include "bus/ros_topics.h"
#include "ros2.h"
#include "ros2PubSubTypes.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
namespace builtin = builtin_interfaces::msg::dds_;
namespace geometry = geometry_msgs::msg::dds_;
namespace nav = nav_msgs::msg::dds_;
namespace tf2 = tf2_msgs::msg::dds_;

namespace {

constexpr const char* unreadable_frame = "(unreadable)";
constexpr std::uint8_t occupied = 100;    // per cent, as map_server says it
constexpr int most_taken = 100;           // samples of a topic at a time
constexpr double longest_farewell = 0.5;  // seconds

/// A type that no bytes can make throw (dds_checked_type.h), and whose unreadable samples show.
template <class Support>
class CheckedRosType final : public Support {
 public:
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* bytes, void* data) override {
    try {
      if (bytes->length <= this->m_typeSize && Support::deserialize(bytes, data)) return true;
    } catch (const eprosima::fastcdr::exception::Exception&) {  // as if it were too short
    }
    auto& sample = *static_cast<typename Support::type*>(data);
    sample = {};
    sample.header().frame_id(unreadable_frame);
    return true;
  }
};

/// Endpoints on a participant, removed at the end.
class Endpoints {
 public:
  explicit Endpoints(dds::DomainParticipant& participant) : participant_(participant) {
    publisher_ = required(participant.create_publisher(dds::PUBLISHER_QOS_DEFAULT), "a publisher for ROS");
    subscriber_ = participant.create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~Endpoints() {
    publisher_->delete_contained_entities();
    participant_.delete_publisher(publisher_);
    if (subscriber_ != nullptr) {
      subscriber_->delete_contained_entities();
      participant_.delete_subscriber(subscriber_);
    }
    for (dds::Topic* topic : topics_) participant_.delete_topic(topic);
  }
  Endpoints(const Endpoints&) = delete;
  Endpoints& operator=(const Endpoints&) = delete;

  template <class Support>
  dds::DataWriter* writer(const TopicInfo& info, const std::string& name) {
    dds::DataWriterQos qos;
    apply(info, qos);
    qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;  // maps are cut in fragments
    return required(publisher_->create_datawriter(topic(new Support(), name), qos), "a writer for ROS");
  }
  template <class Support>
  dds::DataReader* reader(const TopicInfo& info, const std::string& name) {
    dds::DataReaderQos qos;
    apply(info, qos);
    return required(required(subscriber_, "a subscriber for ROS")
                        ->create_datareader(topic(new CheckedRosType<Support>(), name), qos),
                    "a reader for ROS");
  }

 private:
  /// Without type information, as dds_bus.cpp does: not all vendors read each other's.
  dds::Topic* topic(dds::TopicDataType* data_type, const std::string& name) {
    dds::TypeSupport type(data_type);
    type->auto_fill_type_information(false);
    type->auto_fill_type_object(false);
    type.register_type(&participant_);
    topics_.push_back(required(participant_.create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT),
                               "a topic of ROS"));
    return topics_.back();
  }

  dds::DomainParticipant& participant_;
  dds::Publisher* publisher_;
  dds::Subscriber* subscriber_;
  std::vector<dds::Topic*> topics_;
};

template <class Sample, class Fn>
void take_all(dds::DataReader& reader, Fn&& fn) {
  Sample sample;
  dds::SampleInfo info;
  for (int taken = 0; taken < most_taken && reader.take_next_sample(&sample, &info) ==
                                                eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
       ++taken) {
    if (info.valid_data) fn(sample, seconds(info.reception_timestamp));
  }
}

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

/// Covariances stay 0: the body of a robot that is no real one is where it says.
nav::Odometry_ odometry_of(const RosOdometry& message, const RobotName& robot) {
  nav::Odometry_ sample;
  set_header(sample, message.stamp, ros_frame(robot, "odom"));
  sample.child_frame_id(ros_frame(robot, "base_link"));
  set(sample.pose().pose(), message.pose);
  set(sample.twist().twist(), message.twist);
  return sample;
}

/// map -> odom, which are one here for nothing drifts, and odom -> base_link (REP 105).
tf2::TFMessage_ transforms_of(const RosOdometry& message, const RobotName& robot) {
  tf2::TFMessage_ sample;
  sample.transforms().resize(2);
  geometry::TransformStamped_& odom = sample.transforms()[0];
  set_header(odom, message.stamp, ros_map_frame);
  odom.child_frame_id(ros_frame(robot, "odom"));
  set(odom.transform().rotation(), 0.0);
  geometry::TransformStamped_& base = sample.transforms()[1];
  set_header(base, message.stamp, ros_frame(robot, "odom"));
  base.child_frame_id(ros_frame(robot, "base_link"));
  set(base.transform().translation(), message.pose.position);
  set(base.transform().rotation(), message.pose.yaw);
  return sample;
}

/// Each pose faces the next one, the last one as the one before.
nav::Path_ path_of(const RosPlan& plan) {
  nav::Path_ sample;
  set_header(sample, plan.stamp, ros_map_frame);
  sample.poses().resize(plan.way.size());
  Heading heading;
  for (std::size_t k = 0; k < plan.way.size(); ++k) {
    if (k + 1 < plan.way.size()) heading.facing(plan.way[k + 1] - plan.way[k]);
    set_header(sample.poses()[k], plan.stamp, ros_map_frame);
    set(sample.poses()[k].pose(), {plan.way[k], heading.yaw()});
  }
  return sample;
}

nav::OccupancyGrid_ grid_of(const OccupancyMap& map, WallTime now) {
  const OccupancyMap up = with_y_up(map);
  nav::OccupancyGrid_ sample;
  set_header(sample, now, ros_map_frame);
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
  const auto& pose = sample.pose().pose();
  const auto& turn = pose.orientation();
  const auto& twist = sample.twist().twist();
  return {
      .stamp = arrived,
      .frame = sample.header().frame_id(),
      .pose = {{pose.position().x(), pose.position().y()}, yaw_of(turn.x(), turn.y(), turn.z(), turn.w())},
      .twist = {{twist.linear().x(), twist.linear().y()}, twist.angular().z()}};
}

}  // namespace

struct DdsRosRobot::Implementation {
  RobotName robot;
  Endpoints endpoints;
  dds::DataWriter* cmd_vel = nullptr;
  dds::DataWriter* plan = nullptr;
  dds::DataWriter* odom = nullptr;
  dds::DataWriter* tf = nullptr;
  dds::DataReader* seen = nullptr;

  void write(const RosOdometry& message) {
    if (odom == nullptr) return;  // it is not for us to say
    auto odometry = odometry_of(message, robot);
    odom->write(&odometry);
    auto transforms = transforms_of(message, robot);
    tf->write(&transforms);
  }
  void write(const RosCommand& message) {
    geometry::Twist_ twist;
    set(twist, message.twist);
    cmd_vel->write(&twist);
  }
  void write(const RosPlan& message) {
    auto path = path_of(message);
    plan->write(&path);
  }
};

DdsRosRobot::DdsRosRobot(DdsBus& bus, const RobotName& robot, bool elsewhere)
    : implementation_(new Implementation{robot, Endpoints(bus.participant())}) {
  Implementation& it = *implementation_;
  const auto topic = [&](const TopicInfo& info) { return ros_topic(robot, info.name); };
  it.cmd_vel =
      it.endpoints.writer<geometry::Twist_PubSubType>(ros_topics::cmd_vel, topic(ros_topics::cmd_vel));
  it.plan = it.endpoints.writer<nav::Path_PubSubType>(ros_topics::plan, topic(ros_topics::plan));
  if (elsewhere) {
    it.seen = it.endpoints.reader<nav::Odometry_PubSubType>(ros_topics::odom, topic(ros_topics::odom));
  } else {
    it.odom = it.endpoints.writer<nav::Odometry_PubSubType>(ros_topics::odom, topic(ros_topics::odom));
    it.tf = it.endpoints.writer<tf2::TFMessage_PubSubType>(ros_topics::tf, ros_topic(ros_topics::tf.name));
  }
}

DdsRosRobot::~DdsRosRobot() {
  implementation_->cmd_vel->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(longest_farewell));
}

void DdsRosRobot::publish(const RosMessage& message) {
  std::visit([&](const auto& m) { implementation_->write(m); }, message);
}

std::vector<RosOdometry> DdsRosRobot::take() {
  std::vector<RosOdometry> all;
  if (implementation_->seen == nullptr) return all;
  take_all<nav::Odometry_>(*implementation_->seen, [&](const nav::Odometry_& sample, WallTime arrived) {
    all.push_back(odometry_from(sample, arrived));
  });
  return all;
}

struct DdsRosFleet::Implementation {
  Endpoints endpoints;
  dds::DataWriter* map = nullptr;
  std::vector<std::pair<RobotName, dds::DataReader*>> goals{};
};

DdsRosFleet::DdsRosFleet(DdsBus& bus, std::span<const RobotName> robots)
    : implementation_(new Implementation{Endpoints(bus.participant())}) {
  Endpoints& endpoints = implementation_->endpoints;
  implementation_->map =
      endpoints.writer<nav::OccupancyGrid_PubSubType>(ros_topics::map, ros_topic(ros_topics::map.name));
  for (const RobotName& robot : robots)
    implementation_->goals.emplace_back(
        robot, endpoints.reader<geometry::PoseStamped_PubSubType>(
                   ros_topics::goal_pose, ros_topic(robot, ros_topics::goal_pose.name)));
}

DdsRosFleet::~DdsRosFleet() = default;

void DdsRosFleet::publish(const OccupancyMap& map, WallTime now) {
  auto grid = grid_of(map, now);
  implementation_->map->write(&grid);
}

std::vector<RosGoal> DdsRosFleet::take() {
  std::vector<RosGoal> all;
  for (const auto& [robot, reader] : implementation_->goals) {
    take_all<geometry::PoseStamped_>(*reader, [&](const geometry::PoseStamped_& sample, WallTime) {
      const auto& place = sample.pose().position();
      all.push_back({robot, sample.header().frame_id(), {place.x(), place.y()}});
    });
  }
  return all;
}

}  // namespace coppice
