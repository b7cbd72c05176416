#include "ros2/dds_ros.h"

#include <string>
#include <utility>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include "dds/qos.h"
#include "ros2/dds_conversion.h"
#include "ros2/names.h"
#include "ros2/topics.h"
#include "ros2PubSubTypes.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
namespace geometry = geometry_msgs::msg::dds_;
namespace nav = nav_msgs::msg::dds_;
namespace tf2 = tf2_msgs::msg::dds_;

namespace {

constexpr int most_taken = 100;           // samples of a topic in one call
constexpr double longest_farewell = 0.5;  // seconds

/// Endpoints on a participant. The destructor removes them.
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
    qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;  // large maps are sent in fragments
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
  /// Without type information, as in dds/dds_bus.cpp: not all vendors can read each other's.
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

}  // namespace

struct DdsRosRobot::Implementation {
  RobotName robot;
  RosRobotSettings settings;
  Endpoints endpoints;
  dds::DataWriter* cmd_vel = nullptr;
  dds::DataWriter* plan = nullptr;
  dds::DataWriter* odom = nullptr;
  dds::DataWriter* tf = nullptr;
  dds::DataReader* seen = nullptr;         ///< by the source of the pose
  dds::DataReader* seen_static = nullptr;  ///< static transforms
  Transforms transforms{};

  void write(const RosOdometry& message) {
    if (odom == nullptr) return;  // the robot itself publishes its odometry
    auto odometry = odometry_of(message, settings.names, robot);
    odom->write(&odometry);
    auto sample = transforms_of(message, settings.names, robot);
    tf->write(&sample);
  }
  void write(const RosCommand& message) {
    if (settings.stamped) {
      auto twist = stamped_twist_of(message, settings.names, robot);
      cmd_vel->write(&twist);
    } else {
      auto twist = twist_of(message);
      cmd_vel->write(&twist);
    }
  }
  void write(const RosPlan& message) {
    auto path = path_of(message, settings.names);
    plan->write(&path);
  }

  template <class Support>
  dds::DataWriter* writer(const TopicInfo& info) {
    return endpoints.writer<Support>(info, ros_topic(settings.names, robot, info.name));
  }
  void read_pose();
  template <class Sample>
  void take_poses(std::vector<RosOdometry>& all) {
    take_all<Sample>(*seen, [&](const Sample& sample, WallTime arrived) {
      all.push_back(odometry_from(sample, arrived));
    });
  }
  void take_transforms(std::vector<RosOdometry>& all);
};

void DdsRosRobot::Implementation::read_pose() {
  const auto topic = [&](const TopicInfo& info) { return ros_topic(settings.names, robot, info.name); };
  const std::string tf_topic = filled(settings.names.tf, robot);
  switch (settings.pose) {
    case PoseSource::none:
      odom = writer<nav::Odometry_PubSubType>(ros_topics::odom);
      tf = endpoints.writer<tf2::TFMessage_PubSubType>(ros_topics::tf, ros_topic(tf_topic));
      return;
    case PoseSource::odom:
      seen = endpoints.reader<nav::Odometry_PubSubType>(ros_topics::odom, topic(ros_topics::odom));
      return;
    case PoseSource::amcl_pose:
      seen = endpoints.reader<geometry::PoseWithCovarianceStamped_PubSubType>(ros_topics::amcl_pose,
                                                                              topic(ros_topics::amcl_pose));
      return;
    case PoseSource::tf:
      seen = endpoints.reader<tf2::TFMessage_PubSubType>(ros_topics::tf, ros_topic(tf_topic));
      seen_static =
          endpoints.reader<tf2::TFMessage_PubSubType>(ros_topics::tf_static, ros_topic(tf_topic + "_static"));
      return;
  }
}

/// The robot is seen when one of the transforms to its frame has come.
void DdsRosRobot::Implementation::take_transforms(std::vector<RosOdometry>& all) {
  const std::string base = filled(settings.names.base_frame, robot);
  for (dds::DataReader* reader : {seen_static, seen}) {
    take_all<tf2::TFMessage_>(*reader, [&](const tf2::TFMessage_& sample, WallTime arrived) {
      for (const RosTransform& transform : transforms_from(sample, reader == seen_static)) {
        transforms.take(transform, arrived);
        if (transform.child != base || transform.is_static) continue;
        if (const auto pose = transforms.pose_in(settings.names.map_frame, base, arrived))
          all.push_back({.stamp = arrived, .frame = settings.names.map_frame, .pose = *pose});
      }
    });
  }
}

DdsRosRobot::DdsRosRobot(DdsBus& bus, const RobotName& robot, const RosRobotSettings& settings)
    : implementation_(new Implementation{robot, settings, Endpoints(bus.participant())}) {
  Implementation& it = *implementation_;
  it.cmd_vel = settings.stamped ? it.writer<geometry::TwistStamped_PubSubType>(ros_topics::cmd_vel)
                                : it.writer<geometry::Twist_PubSubType>(ros_topics::cmd_vel);
  it.plan = it.writer<nav::Path_PubSubType>(ros_topics::plan);
  it.read_pose();
}

DdsRosRobot::~DdsRosRobot() {
  implementation_->cmd_vel->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(longest_farewell));
}

void DdsRosRobot::publish(const RosMessage& message) {
  std::visit([&](const auto& m) { implementation_->write(m); }, message);
}

std::vector<RosOdometry> DdsRosRobot::take() {
  std::vector<RosOdometry> all;
  switch (implementation_->settings.pose) {
    case PoseSource::none:
      break;
    case PoseSource::odom:
      implementation_->take_poses<nav::Odometry_>(all);
      break;
    case PoseSource::amcl_pose:
      implementation_->take_poses<geometry::PoseWithCovarianceStamped_>(all);
      break;
    case PoseSource::tf:
      implementation_->take_transforms(all);
      break;
  }
  return all;
}

struct DdsRosFleet::Implementation {
  RosNames names;
  Endpoints endpoints;
  dds::DataWriter* map = nullptr;
  std::vector<std::pair<RobotName, dds::DataReader*>> goals{};
};

DdsRosFleet::DdsRosFleet(DdsBus& bus, const RosNames& names, std::span<const RobotName> robots)
    : implementation_(new Implementation{names, Endpoints(bus.participant())}) {
  Endpoints& endpoints = implementation_->endpoints;
  implementation_->map =
      endpoints.writer<nav::OccupancyGrid_PubSubType>(ros_topics::map, ros_topic(ros_topics::map.name));
  for (const RobotName& robot : robots)
    implementation_->goals.emplace_back(
        robot, endpoints.reader<geometry::PoseStamped_PubSubType>(
                   ros_topics::goal_pose, ros_topic(names, robot, ros_topics::goal_pose.name)));
}

DdsRosFleet::~DdsRosFleet() = default;

void DdsRosFleet::publish(const OccupancyMap& map, WallTime now) {
  auto grid = grid_of(map, implementation_->names, now);
  implementation_->map->write(&grid);
}

std::vector<RosGoal> DdsRosFleet::take() {
  std::vector<RosGoal> all;
  for (const auto& [robot, reader] : implementation_->goals) {
    take_all<geometry::PoseStamped_>(*reader,
                                     [&, robot = robot](const geometry::PoseStamped_& sample, WallTime) {
                                       all.push_back(goal_from(sample, robot));
                                     });
  }
  return all;
}

}  // namespace coppice
