#include "robot_agent/process/ros_side.h"

#include <algorithm>

namespace coppice {

namespace {

constexpr WallTime beat = 0.05;  // seconds

}  // namespace

void RosSide::heard(const Message& message) {
  if (const auto* map = std::get_if<MapMessage>(&message)) y_axis_ = map->map.y_axis;
}

void RosSide::said(const Message& message) {
  const auto* path = std::get_if<PathMessage>(&message);
  if (path != nullptr && path->robot == robot_) path_ = path->waypoints;
}

OdometrySample RosSide::sighting(const RosOdometry& seen) {
  const double up = y_axis() == YAxis::up ? 1 : -1;
  return {.at = seen.stamp,
          .position = turned(seen.pose.position, y_axis()),
          .velocity = turned(out_of_robot(seen.twist.linear, seen.pose.yaw), y_axis()),
          .yaw = up * seen.pose.yaw,
          .angular_velocity = up * seen.twist.angular};
}

/// A holonomic robot turns on the spot when it sets off elsewhere, as a disc can: that is not a speed of
/// turning.
RosOdometry RosSide::odometry(const Run& run, WallTime now) {
  const Driver& body = run.body();
  const FleetClock& clock = run.mission().clock;
  const double since = std::clamp(clock.fleet_time(now) - body.time(), 0.0, body.period());
  const Point2 velocity = turned(body.velocity() * clock.scale, y_axis());
  const Point2 position = turned(body.position() + since * body.velocity(), y_axis());
  if (is_differential(body.limits())) {
    const double up = y_axis() == YAxis::up ? 1 : -1;
    const double yaw = up * wrapped(body.yaw() + since * body.angular_velocity());
    return {.stamp = now,
            .pose = {position, yaw},
            .twist = {{velocity.norm(), 0}, up * body.angular_velocity() * clock.scale}};
  }
  const double yaw = heading_.facing(velocity);
  return {.stamp = now, .pose = {position, yaw}, .twist = {into_robot(velocity, yaw), 0}};
}

std::vector<RosMessage> RosSide::step(RobotAgent& agent, WallTime now) {
  std::vector<RosMessage> out;
  const Run* const run = agent.run();
  if (run == nullptr) return out;
  if (path_) {
    RosPlan plan{now, {}};
    for (const Point2& p : *path_) plan.way.push_back(turned(p, y_axis()));
    path_.reset();
    out.emplace_back(std::move(plan));
  }
  if (now < next_) return out;
  next_ = std::max(next_, now - beat / 2) + beat;
  if (run->tracking()) {
    const DriveCommand wanted = agent.command(now);
    const double up = y_axis() == YAxis::up ? 1 : -1;
    out.emplace_back(RosCommand{now, {turned(wanted.linear, y_axis()), up * wanted.angular}});
  } else {
    const RosOdometry seen = odometry(*run, now);
    out.emplace_back(seen);
    out.emplace_back(RosCommand{now, seen.twist});
  }
  return out;
}

}  // namespace coppice
