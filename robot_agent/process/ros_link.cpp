#include "robot_agent/process/ros_link.h"

#include <variant>
#include <vector>

#include <spdlog/spdlog.h>

namespace coppice {

namespace {

constexpr std::size_t refusals_logged = 10;  // then every thousandth
constexpr WallTime between_lines = 1;        // seconds

}  // namespace

/// Stamps of ROS are by the system's clock.
void RosLink::turn(RobotAgent& agent, ProcessClock& clock) {
  const std::vector<RosOdometry> sightings = topics_.take();
  const WallTime now = clock.now();
  for (RosOdometry seen : sightings) {
    seen.stamp = clock.time_of(seen.stamp);
    if (const auto problem = problem_with(seen, map_frame_)) {
      refuse(*problem);
    } else if (side_.knows_map()) {
      agent.on(side_.sighting(seen));
    }
  }
  for (RosMessage& message : side_.step(agent, now)) {
    std::visit([&](auto& m) { m.stamp = clock.by_system(m.stamp); }, message);
    topics_.publish(message);
  }
  if (agent.run() != nullptr && agent.run()->tracking()) tell(*agent.run()->tracking(), now);
}

void RosLink::refuse(const std::string& problem) {
  ++refused_;
  if (refused_ <= refusals_logged || refused_ % 1000 == 0)
    spdlog::warn("refused odometry: {} ({} refused so far)", problem, refused_);
}

void RosLink::tell(const Tracking& tracking, WallTime now) {
  const bool in_reach = tracking.in_reach(now);
  if (in_reach == in_reach_ || now - told_at_ < between_lines) return;
  in_reach_ = in_reach;
  told_at_ = now;
  if (in_reach) {
    spdlog::info("the robot is where it should be");
  } else if (tracking.is_recent(now)) {
    spdlog::warn("the robot is stopped: it is {:.2f} m off where it should be", tracking.error());
  } else {
    spdlog::warn("the robot is stopped: no odometry comes");
  }
}

}  // namespace coppice
