// Part of class PlannerService: it goes on with what the service before it saved, and tells what the next one
// is to know.
#include <algorithm>
#include <utility>

#include "planner_service/run/planner_service.h"
#include "planner_service/timing.h"

namespace coppice {

bool PlannerService::recall(std::span<const Message> saved, WallTime now) {
  for (const Message& message : saved) {
    if (const auto* mission = std::get_if<Mission>(&message)) {
      if (!recall_mission(*mission, now)) return false;
    } else if (const auto* order = std::get_if<OrderStatus>(&message)) {
      orders_.recall(*order);
    } else if (const auto* halts = std::get_if<HaltMessage>(&message)) {
      orders_.recall(*halts);
    } else {
      on(arrival_of(message, now));
      recall_silence(message, now);
    }
  }
  if (BegunRun* const run = run_of(phase_)) {
    run->missions_due = true;
    run->rediscovered_by = now + time_to_rediscover();
  }
  std::uint64_t drawn = 0;
  for (const RobotRecord& robot : robots_) drawn += robot.mission - 1;
  goals_.skip(drawn);
  return true;
}

void PlannerService::remember(const FleetMemory& memory) {
  orders_.recall(memory.halts);
  for (const OrderStatus& order : memory.orders) orders_.recall(order);
}

/// A robot that was never heard, and of which no pose was known, is as new to the next fleet as to this one.
FleetMemory PlannerService::memory() const {
  FleetMemory memory{.halts = orders_.halts(), .orders = orders_.ended()};
  for (const RobotRecord& robot : robots_) {
    const auto last = tracks_.last(robot.index);
    const RobotPose* const before = pose_of(settings_.starts, robot.task.name);
    if (last) {
      memory.poses.push_back({robot.task.name, rest_of(*last, robot.task), last->yaw});
    } else if (before != nullptr) {
      memory.poses.push_back(*before);
    }
  }
  return memory;
}

bool PlannerService::recall_mission(const Mission& mission, WallTime now) {
  RobotRecord* const robot = robots_.find(mission.robot);
  if (robot == nullptr || mission.map_id != map_id_ || mission.fleet_size != robots_.size()) return false;
  if (mission.number == robot->mission + 1) {
    const bool any_yaw = mission.goal_yaw_tolerance == 0;
    begin_next_mission(*robot, mission.start,
                       {mission.goal, any_yaw ? std::nullopt : std::optional(mission.goal_yaw)});
  }
  // Where the robots of a standing fleet began is not in the scenario.
  if (settings_.waits_for_goals && mission.number == robot->mission) robot->began_as(mission, goals_.field());
  const RobotTask& task = robot->task;
  const bool same_task = mission.number == robot->mission && mission.start == body_begins_at(task) &&
                         mission.goal == task.goal && mission.radius == reference_radius(task) &&
                         mission.max_speed == task.max_speed;
  if (!same_task || mission.clock.scale != settings_.time_scale || mission.planner != settings_.planner ||
      mission.trees != settings_.trees || mission.coordination != settings_.coordination)
    return false;
  if (std::holds_alternative<WaitingForTrees>(phase_)) phase_ = Running{};
  BegunRun& run = *run_of(phase_);
  run.clock = mission.clock;
  intake_.fleet_began(run.clock.epoch);
  // A robot whose track is lost is stopped while the run goes on.
  if (mission.cancelled && !robot->track_lost())
    phase_ = CollectingTracks{BegunRun(run), RunEnd::before_restart, now};
  return true;
}

WallTime PlannerService::time_to_rediscover() const {
  return service_timing.rediscovery_base +
         service_timing.rediscovery_per_robot * static_cast<double>(robots_.size());
}

/// The silence of an agent that fell silent long before the restart counts from then, as far as that leaves
/// the agents the time to discover this service.
void PlannerService::recall_silence(const Message& saved, WallTime now) {
  const auto* const status = std::get_if<AgentStatus>(&saved);
  const auto* const track = std::get_if<TrackMessage>(&saved);
  if (status == nullptr && track == nullptr) return;
  const RobotRecord* const robot = robots_.find(status != nullptr ? status->robot : track->robot);
  const FleetClock* const clock = clock_of(phase_);
  if (robot == nullptr || clock == nullptr) return;
  const auto last = tracks_.last(robot->index);
  if (!last) return;
  const WallTime longest = std::max(0.0, service_timing.longest_cut_off - time_to_rediscover());
  liveliness_.heard_before_restart(robot->index,
                                   std::clamp(clock->wall_time(last->time), now - longest, now));
}

}  // namespace coppice
