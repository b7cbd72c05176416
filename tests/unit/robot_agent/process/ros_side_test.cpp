// Tests of what an agent publishes in ROS, and of how it leads a robot by odometry.
#include "robot_agent/process/ros_side.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/robot_agent/agent_run.h"

namespace coppice {
namespace {

constexpr double pi = std::numbers::pi;

Mission mission_to(const Point2& goal, double scale = 1) {
  Mission mission = mission_of_a(0, goal);
  mission.plan_budget = 0;
  mission.clock.scale = scale;
  return mission;
}

/// A single agent, its ROS side, and an external robot that is moved by `follow`.
struct Fleet {
  explicit Fleet(const Mission& mission, std::optional<TrackingSettings> tracking = {}) {
    if (tracking) agent.track_robot(*tracking);
    hear(MapMessage{"wall", wall_with_door(), {}}, 0);
    hear(mission, 0);
  }
  void hear(const Message& message, double now) {
    side.heard(message);
    agent.on(arrival_of(message, now));
  }
  /// `follow(now)` is called after each step.
  template <class Fn>
  void run(double from, double until, Fn&& follow) {
    for (double now = from; now < until; now += period / 2) {
      for (const Message& message : messages(agent.step(now))) {
        side.said(message);
        said.push_back(message);
      }
      for (RosMessage& message : side.step(agent, now)) ros.push_back(std::move(message));
      follow(now);
    }
  }
  void run(double from, double until) {
    run(from, until, [](double) {});
  }
  template <class M>
  std::vector<M> in_ros() const {
    std::vector<M> all;
    for (const RosMessage& message : ros) {
      if (const M* m = std::get_if<M>(&message)) all.push_back(*m);
    }
    return all;
  }
  std::vector<TrackMessage::Point> track() const { return track_in(said); }
  RobotAgent agent{"a"};
  RosSide side{"a"};
  std::vector<Message> said{};
  std::vector<RosMessage> ros{};
};

TEST(RosSide, NothingIsPublishedBeforeThereIsARobot) {
  RobotAgent agent("a");
  RosSide side("a");
  EXPECT_TRUE(side.step(agent, 0).empty());
}

TEST(RosSide, ADifferentialRobotIsCommandedForwardAndToTurnOnly) {
  Mission mission = mission_to({20, 20});  // up the picture
  mission.max_angular_speed = 2;
  mission.max_angular_acceleration = 8;
  Fleet fleet(mission);
  fleet.run(0, 8);
  const auto odometry = fleet.in_ros<RosOdometry>();
  EXPECT_NEAR(odometry.front().pose.yaw, 0, 1e-9);
  EXPECT_NEAR(odometry.back().pose.yaw, pi / 2, 0.05) << "y is up in ROS";
  EXPECT_NEAR((odometry.back().pose.position - Point2(20, -20)).norm(), 0, 1);
  double fastest = 0;
  double turned = 0;
  for (const RosCommand& command : fleet.in_ros<RosCommand>()) {
    EXPECT_EQ(command.twist.linear.y(), 0);
    EXPECT_GE(command.twist.linear.x(), 0);
    fastest = std::max(fastest, command.twist.linear.x());
    turned += period * command.twist.angular;
  }
  EXPECT_NEAR(fastest, 20, 0.2);
  EXPECT_NEAR(turned, pi / 2, 0.2);
}

TEST(RosSide, PositionAndVelocityArePublishedWithYUp) {
  Fleet fleet(mission_to({20, 20}));  // up the picture
  fleet.run(0, 8);
  const auto odometry = fleet.in_ros<RosOdometry>();
  EXPECT_NEAR(static_cast<double>(odometry.size()), 8 / period, 10);
  EXPECT_NEAR((odometry.front().pose.position - Point2(20, -60)).norm(), 0, 1e-9);
  EXPECT_NEAR((odometry.back().pose.position - Point2(20, -20)).norm(), 0, 1);
  const auto fastest =
      std::ranges::max_element(odometry, {}, [](const RosOdometry& o) { return o.twist.linear.norm(); });
  EXPECT_NEAR(fastest->twist.linear.x(), 20, 0.1);
  EXPECT_NEAR(fastest->twist.linear.y(), 0, 1e-9);
  EXPECT_NEAR(fastest->pose.yaw, pi / 2, 0.2);         // forwards, not backwards
  EXPECT_NEAR(odometry.back().pose.yaw, pi / 2, 0.5);  // it stands and keeps its heading
  for (std::size_t k = 1; k < odometry.size(); ++k) {
    const Point2 moved = odometry[k].pose.position - odometry[k - 1].pose.position;
    EXPECT_LE(moved.norm(), 20 * (odometry[k].stamp - odometry[k - 1].stamp) + 1e-6);
    EXPECT_GE(moved.y(), -0.1);
  }
  const auto commands = fleet.in_ros<RosCommand>();
  ASSERT_EQ(commands.size(), odometry.size());
  EXPECT_EQ(commands.back().twist.linear, Point2(0, 0));
  const auto plans = fleet.in_ros<RosPlan>();
  ASSERT_FALSE(plans.empty());
  EXPECT_NEAR((plans.back().way.front() - Point2(20, -60)).norm(), 0, 1e-9);
  EXPECT_NEAR((plans.back().way.back() - Point2(20, -20)).norm(), 0, 1e-9);
}

TEST(RosSide, SpeedsRelateToWallTime) {
  Fleet fleet(mission_to({100, 60}, 0.5));
  fleet.run(0, 10);
  double fastest = 0;
  for (const RosOdometry& odometry : fleet.in_ros<RosOdometry>())
    fastest = std::max(fastest, odometry.twist.linear.norm());
  EXPECT_NEAR(fastest, 10, 0.1);
}

/// A robot that obeys with a lag and does not begin at its start.
struct Follower {
  void follow(Fleet& fleet, double now, bool tells = true) {
    for (std::size_t k = heard; k < fleet.ros.size(); ++k) {
      if (const auto* command = std::get_if<RosCommand>(&fleet.ros[k]))
        wanted = turned(out_of_robot(command->twist.linear, yaw), YAxis::down);
    }
    heard = fleet.ros.size();
    velocity += (wanted - velocity) * (period / 2) / 0.2;
    position += velocity * period / 2;
    if (!tells) return;
    const RosOdometry odometry{.stamp = now,
                               .frame = "map",
                               .pose = {turned(position, YAxis::down), yaw},
                               .twist = {into_robot(turned(velocity, YAxis::down), yaw), 0}};
    fleet.agent.on(fleet.side.sighting(odometry));
  }
  static constexpr double yaw = 2;
  Point2 position{20.3, 60};
  Point2 velocity = Point2::Zero();
  Point2 wanted = Point2::Zero();
  std::size_t heard = 0;
};

constexpr TrackingSettings patient{.patience = 0.5};
constexpr double tolerance = 12;

/// Of a robot that may be off its reference by the tolerance.
Mission loose_mission_to(const Point2& goal) {
  Mission mission = mission_to(goal);
  mission.radius += tolerance;
  mission.tracking_tolerance = tolerance;
  return mission;
}

// The service takes the robot to be at {20, 60}.
TEST(RosSide, ARobotOfAStandingFleetBeginsWhereItIsSeen) {
  Mission mission = loose_mission_to({20, 60});
  mission.starts_where_it_stands = true;
  Fleet fleet(mission, patient);
  fleet.run(0, 1);
  EXPECT_EQ(fleet.agent.run(), nullptr) << "nobody knows where it is";
  EXPECT_EQ(of<AgentStatus>(fleet.said).back().reason,
            "waits for the odometry of its robot, which says where it stands");
  Follower robot;
  robot.position = {28, 40};
  fleet.run(1, 3, [&](double now) { robot.follow(fleet, now); });
  ASSERT_NE(fleet.agent.run(), nullptr);
  EXPECT_LT((fleet.agent.run()->body().position() - Point2(28, 40)).norm(), 0.1);
  EXPECT_LT((robot.position - Point2(28, 40)).norm(), 0.5) << "it stays there";
}

TEST(RosSide, AnExternalRobotIsLedToItsGoal) {
  Fleet fleet(loose_mission_to({40, 20}), patient);
  Follower robot;
  double furthest = 0;
  fleet.run(0, 14, [&](double now) {
    robot.follow(fleet, now);
    furthest = std::max(furthest, (robot.position - fleet.agent.run()->body().position()).norm());
  });
  EXPECT_LT((robot.position - Point2(40, 20)).norm(), 1);
  EXPECT_EQ(of<AgentStatus>(fleet.said).back().phase, Phase::arrived);
  EXPECT_LT(furthest, tolerance);
  EXPECT_GT(furthest, 0.5);  // there was a deviation to correct
  EXPECT_TRUE(fleet.in_ros<RosOdometry>().empty());
  // The other robots keep clear of the tolerance, too.
  for (const RobotState& state : of<RobotState>(fleet.said)) {
    EXPECT_EQ(state.radius, 17);
    EXPECT_LE(state.promise.velocity.norm(), 18 + 1e-9);
  }
  for (const RosCommand& command : fleet.in_ros<RosCommand>())
    EXPECT_LE(command.twist.linear.norm(), 20 + 1e-9);
  // The track shows where the robot was, not where it should have been.
  const auto track = fleet.track();
  ASSERT_GT(track.size(), 200u);
  EXPECT_EQ(track.front().position, Point2(20.3, 60));
  for (std::size_t k = 1; k < track.size(); ++k) {
    EXPECT_GE(track[k].time, track[k - 1].time + period - 1e-9);
    const Point2 moved = (track[k].position - track[k - 1].position) / (track[k].time - track[k - 1].time);
    EXPECT_LT((moved - track[k].velocity).norm(), 6);
  }
}

TEST(RosSide, ARobotWithoutOdometryDoesNotStart) {
  Fleet fleet(loose_mission_to({40, 20}), patient);
  fleet.run(0, 5);
  EXPECT_EQ(fleet.agent.run()->body().position(), Point2(20, 60));
  EXPECT_TRUE(fleet.track().empty());
  for (const RosCommand& command : fleet.in_ros<RosCommand>()) EXPECT_EQ(command.twist.linear, Point2(0, 0));
}

TEST(RosSide, TheRobotStopsWhileOdometryIsMissingAndThenGoesOn) {
  Fleet fleet(loose_mission_to({20, 20}), patient);
  Follower robot;
  const auto with = [&](bool tells) { return [&, tells](double now) { robot.follow(fleet, now, tells); }; };
  fleet.run(0, 1, with(true));
  ASSERT_GT(robot.velocity.norm(), 5);
  fleet.run(1, 1.6, with(false));
  fleet.ros.clear();
  robot.heard = 0;
  fleet.run(1.6, 3, with(false));
  for (const RosCommand& command : fleet.in_ros<RosCommand>()) EXPECT_EQ(command.twist.linear, Point2(0, 0));
  EXPECT_TRUE(fleet.agent.stands());
  EXPECT_LT(robot.velocity.norm(), 0.1);
  EXPECT_LT((robot.position - fleet.agent.run()->body().position()).norm(), tolerance);
  fleet.run(3, 14, with(true));
  EXPECT_LT((robot.position - Point2(20, 20)).norm(), 1);
}

TEST(RosSide, TheRobotStopsIfItDeviatesMoreThanAllowed) {
  Fleet fleet(loose_mission_to({20, 20}), patient);
  Follower robot;
  fleet.run(0, 1, [&](double now) { robot.follow(fleet, now); });
  robot.position += Point2(40, 0);  // the robot is pushed
  fleet.run(1, 1.2, [&](double now) { robot.follow(fleet, now); });
  fleet.ros.clear();
  robot.heard = 0;
  fleet.run(1.2, 5, [&](double now) { robot.follow(fleet, now); });
  EXPECT_TRUE(fleet.agent.stands());
  for (const RosCommand& command : fleet.in_ros<RosCommand>()) EXPECT_EQ(command.twist.linear, Point2(0, 0));
  EXPECT_GT(robot.position.x(), 50);
  robot.position = fleet.agent.run()->body().position();  // the robot is brought back
  fleet.run(5, 14, [&](double now) { robot.follow(fleet, now); });
  EXPECT_LT((robot.position - Point2(20, 20)).norm(), 1);
}

TEST(RosSide, ARobotThatIsALittleBeyondItsToleranceDrivesBack) {
  Fleet fleet(loose_mission_to({20, 20}), patient);
  Follower robot;
  fleet.run(0, 1, [&](double now) { robot.follow(fleet, now); });
  robot.position += Point2(15, 0);  // the robot is pushed
  fleet.run(1, 14, [&](double now) { robot.follow(fleet, now); });
  EXPECT_LT((robot.position - Point2(20, 20)).norm(), 1);
}

/// A robot with a differential drive that obeys with a lag. Its y axis is that of ROS.
struct TurningFollower {
  void follow(Fleet& fleet, double now) {
    for (std::size_t k = heard; k < fleet.ros.size(); ++k) {
      if (const auto* command = std::get_if<RosCommand>(&fleet.ros[k])) wanted = command->twist;
    }
    heard = fleet.ros.size();
    const double share = period / 2 / 0.15;
    speed += share * (wanted.linear.x() - speed);
    turning += share * (wanted.angular - turning);
    sideways = std::max(sideways, std::abs(wanted.linear.y()));
    backwards = std::min(backwards, wanted.linear.x());
    yaw += turning * period / 2;
    position += speed * period / 2 * Point2(std::cos(yaw), std::sin(yaw));
    fleet.agent.on(fleet.side.sighting(
        {.stamp = now, .frame = "map", .pose = {position, yaw}, .twist = {{speed, 0}, turning}}));
  }
  Point2 position{21, -59};
  double yaw = 1;
  double speed = 0;
  double turning = 0;
  double sideways = 0;   ///< largest wanted speed to the side
  double backwards = 0;  ///< least wanted speed ahead
  RosTwist wanted{};
  std::size_t heard = 0;
};

TEST(RosSide, AnExternalDifferentialRobotIsLedToItsGoalAndTurnsThere) {
  Mission mission = loose_mission_to({40, 20});
  mission.max_angular_speed = 2;
  mission.max_angular_acceleration = 8;
  mission.start_yaw = -1;
  mission.goal_yaw = 2;
  mission.goal_yaw_tolerance = 0.1;
  Fleet fleet(mission, patient);
  TurningFollower robot;
  double furthest = 0;
  fleet.run(0, 25, [&](double now) {
    robot.follow(fleet, now);
    furthest = std::max(furthest,
                        (turned(robot.position, YAxis::down) - fleet.agent.run()->body().position()).norm());
  });
  EXPECT_EQ(of<AgentStatus>(fleet.said).back().phase, Phase::arrived);
  EXPECT_LT((robot.position - Point2(40, -20)).norm(), 1);
  EXPECT_NEAR(std::remainder(robot.yaw + 2, 2 * pi), 0, 0.1) << "y is down on the map";
  EXPECT_LT(furthest, tolerance / 2);
  EXPECT_EQ(robot.sideways, 0);
  EXPECT_EQ(robot.backwards, 0);
  EXPECT_NEAR(fleet.track().back().yaw, 2, 0.1);
}

TEST(RosSide, ARestartedAgentKnowsTheTrackOfTheRobot) {
  Fleet before(loose_mission_to({20, 20}), patient);
  Follower robot;
  before.run(0, 2, [&](double now) { robot.follow(before, now); });
  std::vector<Message> kept;
  StateKeeper keeper("a", true);
  const Mission mission = loose_mission_to({20, 20});
  EXPECT_EQ(keeper.heard(mission), Keep::begin_anew);
  kept.emplace_back(mission);
  for (const Message& message : before.said) {
    if (keeper.said(message) == Keep::append) kept.push_back(message);
  }
  Fleet after(loose_mission_to({20, 20}), patient);
  after.agent.restore(saved_state_of(kept, true));
  after.run(4, 16, [&](double now) { robot.follow(after, now); });
  const auto track = after.track();
  const auto earlier = before.track();
  ASSERT_GT(track.size(), earlier.size());
  EXPECT_TRUE(std::equal(earlier.begin(), earlier.end(), track.begin()));
  EXPECT_LT((robot.position - Point2(20, 20)).norm(), 1);
}

}  // namespace
}  // namespace coppice
