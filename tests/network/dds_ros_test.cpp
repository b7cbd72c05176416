// Tests of the ROS 2 topics over the bus's participant, from both ends.
//
// CTest: RESOURCE_LOCK lane_2

#include "ros2/dds_ros.h"

#include <chrono>
#include <thread>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <gtest/gtest.h>

#include "dds/qos.h"
#include "ros2.h"
#include "ros2/topics.h"
#include "ros2PubSubTypes.h"
#include "runtime/process.h"
#include "tests/domains.h"
#include "tests/processes.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
namespace dds = eprosima::fastdds::dds;

TEST(DdsRos, OdometryArrivesWithItsFrameAndTheArrivalTime) {
  DdsBus here({.domain = test::own_domain(), .robot = "a"}, Role::agent, "agent a");
  DdsBus there({.domain = test::own_domain()}, Role::observer, "robot a");
  DdsRosRobot reader(here, "a", {.pose = PoseSource::odom});
  DdsRosRobot writer(there, "a", {});
  std::vector<RosOdometry> heard;
  ASSERT_TRUE(test::within(10s, [&] {
    writer.publish(RosOdometry{.stamp = 7, .pose = {{1, -2}, 3}, .twist = {{0.5, -0.25}, 0.125}});
    heard = reader.take();
    return !heard.empty();
  }));
  EXPECT_EQ(heard[0].frame, "a/odom");
  EXPECT_TRUE(problem_with(heard[0], "map"));  // another frame than the map's
  EXPECT_EQ(heard[0].pose.position, Point2(1, -2));
  EXPECT_NEAR(heard[0].pose.yaw, 3, 1e-12);
  EXPECT_EQ(heard[0].twist.linear, Point2(0.5, -0.25));
  EXPECT_EQ(heard[0].twist.angular, 0.125);
  EXPECT_NEAR(heard[0].stamp, DisciplinedClock::read().system, 10);
}

/// Announces the type of a goal, but is shorter.
class NoGoal final : public geometry_msgs::msg::dds_::Twist_PubSubType {
 public:
  NoGoal() { setName("geometry_msgs::msg::dds_::PoseStamped_"); }
};

TEST(DdsRos, BytesThatAreNoGoalAreNotAGoalAtTheOrigin) {
  DdsBus service({.domain = test::own_domain()}, Role::service, "service");
  const std::vector<RobotName> robots{"a", "b"};
  DdsRosFleet fleet(service, {}, robots);
  DdsBus other({.domain = test::own_domain()}, Role::observer, "other");
  dds::DomainParticipant& participant = other.participant();
  dds::TypeSupport type(new NoGoal());
  type->auto_fill_type_information(false);
  type->auto_fill_type_object(false);
  type.register_type(&participant);
  dds::Topic* const topic =
      participant.create_topic("rt/b/goal_pose", type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  dds::Publisher* const publisher = participant.create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  dds::DataWriterQos qos;
  apply(ros_topics::goal_pose, qos);
  dds::DataWriter* const writer = publisher->create_datawriter(topic, qos);
  ASSERT_NE(writer, nullptr);
  std::vector<RosGoal> goals;
  ASSERT_TRUE(test::within(10s, [&] {
    geometry_msgs::msg::dds_::Twist_ sample;
    writer->write(&sample);
    goals = fleet.take();
    return !goals.empty();
  }));
  EXPECT_EQ(goals[0].robot, "b");
  EXPECT_TRUE(problem_with(goals[0], "map"));
}

}  // namespace
}  // namespace coppice
