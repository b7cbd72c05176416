// Targets for what others send that are not part of the fleet: ROS 2 nodes, Foxglove, and clients of the API.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <variant>

#include "coppice/files/input_error.h"
#include "messages/validation.h"
#include "monitor/foxglove/foxglove.h"
#include "monitor/server/order_request.h"
#include "monitor/view/live_stream.h"
#include "planner_service/run/planner_service.h"
#include "robot_agent/process/robot_agent.h"
#include "robot_agent/process/ros_side.h"
#include "ros2/dds_conversion.h"
#include "ros2PubSubTypes.h"
#include "tests/fuzz/targets.h"
#include "tests/unit/monitor/seen_fleet.h"

namespace coppice::fuzz {

namespace {

using namespace std::literals;  // for a string with zero bytes
namespace nav = nav_msgs::msg::dds_;
namespace tf2 = tf2_msgs::msg::dds_;
namespace geometry = geometry_msgs::msg::dds_;

constexpr WallTime missions_at = 3.5;  // there is no broker to wait for

Scenario one_robot() {
  Scenario scenario{
      .map_name = "hall",
      .map = {.width = 24, .height = 16, .blocked = std::vector<std::uint8_t>(std::size_t{24} * 16, 0)},
      .robots = {}};
  scenario.robots = {{"a", {4, 8}, {20, 8}, 1, 4, 8, 0.5}};
  return scenario;
}

template <class Support>
typename Support::type decoded(Bytes data) {
  CheckedRosType<Support> type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(data.size()));
  std::ranges::copy(data, payload.data);
  payload.length = static_cast<std::uint32_t>(data.size());
  typename Support::type sample;
  if (!type.deserialize(&payload, &sample)) std::abort();  // bytes that are no sample mark it, too
  return sample;
}

template <class Support>
Input encoded(typename Support::type sample) {
  Support type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  type.serialize(&sample, &payload);
  return {payload.data, payload.data + payload.length};
}

bool is_finite(const RosTwist& twist) {
  return twist.linear.allFinite() && std::isfinite(twist.angular);
}

/// An agent leads a robot that reports its position: once as read, and while it drives.
void ros_odometry(Bytes data) {
  RosOdometry seen = odometry_from(decoded<nav::Odometry_PubSubType>(data), 0);
  if (problem_with(seen, "map")) return;
  Scenario scenario = one_robot();
  scenario.robots[0].tracking_tolerance = 1;
  PlannerService service(scenario, {.plan_budget = 0}, 0);
  RobotAgent agent("a");
  agent.track_robot({});
  RosSide side("a");
  for (const WallTime at : {0.0, missions_at}) {
    for (const Message& message : service.step(at)) {
      side.heard(message);
      agent.on(arrival_of(message, at));
    }
  }
  for (int k = 0; k < 32; ++k) {
    seen.stamp = missions_at + 0.05 * k;
    if (k >= 8) agent.on(side.sighting(seen));
    for (const Outgoing& said : agent.step(seen.stamp)) {
      if (problem_with(said.message)) std::abort();
      side.said(said.message);
    }
    for (const RosMessage& message : side.step(agent, seen.stamp)) {
      const auto* const command = std::get_if<RosCommand>(&message);
      if (command != nullptr && !is_finite(command->twist)) std::abort();
    }
  }
}
std::vector<Input> ros_odometry_seeds() {
  const auto at = [](double x, double y, double yaw) {
    nav::Odometry_ sample = odometry_of({.pose = {{x, y}, yaw}, .twist = {{1, 0}, 0.1}}, {}, "a");
    sample.header().frame_id("map");
    return encoded<nav::Odometry_PubSubType>(sample);
  };
  return {at(4, -8, 0), at(5, -8, 1), at(20, 3, -2)};
}

/// The pose of a robot follows from transforms, or from none.
void ros_transforms(Bytes data) {
  Transforms known;
  for (const RosTransform& transform : transforms_from(decoded<tf2::TFMessage_PubSubType>(data), false))
    known.take(transform, 0);
  (void)known.pose_in("map", "a/base_link", 0);
}
std::vector<Input> ros_transforms_seeds() {
  return {encoded<tf2::TFMessage_PubSubType>(transforms_of({.pose = {{1, 2}, 3}}, {}, "a"))};
}

/// A goal for a robot is requested.
void ros_goal(Bytes data) {
  const RosGoal goal = goal_from(decoded<geometry::PoseStamped_PubSubType>(data), "a");
  PlannerService service(one_robot(), {.waits_for_goals = true}, 0);
  service.step(0);
  service.step(missions_at);
  const bool refused = service.on(goal).has_value();
  if (refused != (service.goals_refused() == 1)) std::abort();
  for (const Message& message : service.step(missions_at + 1)) {
    if (refused || problem_with(message)) std::abort();
  }
}
std::vector<Input> ros_goal_seeds() {
  const auto to = [](double x, double y, const char* frame) {
    geometry::PoseStamped_ sample;
    sample.header().frame_id(frame);
    sample.pose().position().x(x);
    sample.pose().position().y(y);
    return encoded<geometry::PoseStamped_PubSubType>(sample);
  };
  return {to(10, -4, "map"), to(10, -4, ""), to(-1, 4, "map"), to(1, 1, "odom")};
}

/// Each message begins with whether it is text, and ends with a zero byte. The answer must be finite.
void foxglove_client(Bytes data) {
  test::SeenFleet fleet;
  fleet.map();
  fleet.mission("a");
  fleet.path("a", {{0.5, 1.5}, {3.5, 1.5}});
  fleet.tree(1);
  fleet.root_nodes("a", 0, 3);
  LiveStream live("here");
  FoxgloveFeed feed;
  while (!data.empty()) {
    const auto end = std::ranges::find(data.subspan(1), 0);
    const std::string_view message(reinterpret_cast<const char*>(data.data()) + 1,
                                   static_cast<std::size_t>(end - data.begin() - 1));
    feed.on(message, data[0] != 'b');
    data = data.subspan(std::min(data.size(), message.size() + 2));
    fleet.now += 0.3;
    fleet.state("a", {1, 1.5}, {1, 0});
    live.look(fleet.view, fleet.now);
    (void)feed.next(fleet.view, live);
  }
}
std::vector<Input> foxglove_client_seeds() {
  constexpr std::string_view all =
      R"(t{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 1}, {"id": 2, "channelId": 7}]})"
      "\0"
      R"(t{"op": "subscribe", "subscriptions": [{"id": 3, "channelId": 3}, {"id": 3, "channelId": 99}]})"
      "\0"
      R"(t{"op": "unsubscribe", "subscriptionIds": [1, 5]})"
      "\0b\1\2\0"
      R"(t{"op": "advertise"})"sv;
  return {Input(all.begin(), all.end())};
}

/// What a request asks for has a robot at most, some places to go to, and a deadline that is a time.
void order_request(Bytes data) {
  const std::string_view body(reinterpret_cast<const char*>(data.data()), data.size());
  try {
    const OrderMessage order = order_of(body, 100);
    if (order.robots.size() > 1 || order.visits.empty() || order.visits.size() > most_visits) std::abort();
    if (order.deadline != 0 && !(order.deadline > 100)) std::abort();
  } catch (const InputError&) {
  }
  try {
    if (!halt_order_of(body, Action::stop).visits.empty()) std::abort();
  } catch (const InputError&) {
  }
}
std::vector<Input> order_request_seeds() {
  const auto input = [](std::string_view text) { return Input(text.begin(), text.end()); };
  return {input(R"({"id": "a-1", "robot": "r2", "goal": {"x": 1.5, "y": -2, "yaw": 0.5, "wait": 3},
 "priority": -7, "deadline": 60, "by": "me"})"),
          input(R"({"robot": null, "goals": [{"x": 1, "y": 2}, {"x": 3e1, "y": 4}]})"),
          input(R"({"robots": ["r1", "r2"], "by": "me"})")};
}

constexpr std::array all{Target{"ros_odometry", ros_odometry, ros_odometry_seeds},
                         Target{"ros_goal", ros_goal, ros_goal_seeds},
                         Target{"ros_transforms", ros_transforms, ros_transforms_seeds},
                         Target{"foxglove_client", foxglove_client, foxglove_client_seeds},
                         Target{"order_request", order_request, order_request_seeds}};

}  // namespace

std::span<const Target> client_targets() {
  return all;
}

}  // namespace coppice::fuzz
