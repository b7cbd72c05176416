#include "robot_agent/process/robot_agent.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "messages/validation.h"
#include "planning/quantities.h"
#include "robot_agent/control/words.h"
#include "robot_agent/process/reference_limits.h"

namespace coppice {

namespace {

constexpr WallTime status_interval = 0.5;  // seconds between two statuses, at most: the service sees it alive
constexpr WallTime all_missions_come = 3;  // seconds in which the missions of a run come one after the other

/// Where the body comes to rest if nothing is decided any more.
Standing resting_place(Driver body) {
  while (!body.stands() || body.turns_on_the_spot()) body.advance();
  return {body.position(), body.yaw()};
}

}  // namespace

void RobotAgent::expect(std::span<const Arrival> arrivals) const {
  for (const Arrival& arrival : arrivals) __builtin_prefetch(arrival.message.get());
  for (const Arrival& arrival : arrivals) {
    if (const auto* state = std::get_if<RobotState>(arrival.message.get())) fleet_->expect(state->robot);
  }
}

void RobotAgent::restore(std::optional<SavedState> saved) {
  if (saved) {
    // The service that halted the robot may be gone.
    if (saved->status.phase == Phase::halted) process_->halt = Halt::stopped;
    process_->stands = resting_place(saved->body);
  }
  process_->saved_state = std::move(saved);
}

void RobotAgent::on(const OdometrySample& robot) {
  if (process_->tracking) process_->stands = Standing{robot.position, robot.yaw, robot.at};
  if (run_) run_->see(robot);
}

/// States wait for the next control step; everything else is looked at when it comes.
void RobotAgent::on(Arrival arrival) {
  ++process_->load.samples_received;
  if (const auto* state = std::get_if<RobotState>(arrival.message.get())) {
    ++process_->load.states_received;
    if (fleet_->hear({std::move(arrival.message), state}, arrival.at) && run_) run_->hear(*state);
    return;
  }
  if (const auto* plan = std::get_if<JointPlanMessage>(arrival.message.get())) {
    const bool is_early = !run_ || plan->run != run_->mission().clock.run();
    std::shared_ptr<const JointPlanMessage> heard(std::move(arrival.message), plan);
    if (is_early) {
      early_plan_ = std::move(heard);
    } else {
      run_->hear(std::move(heard));
    }
  } else if (const auto* reserved = std::get_if<ReservationMessage>(arrival.message.get())) {
    if (run_) run_->hear(*reserved);
    reservations_.hear({std::move(arrival.message), reserved});
  } else {
    std::visit(
        [&](const auto& m) {
          if constexpr (requires { receive(m, WallTime{}); }) receive(m, arrival.at);
        },
        *arrival.message);
  }
  next_wake_ = std::min(next_wake_, arrival.at);
}

void RobotAgent::note(const BusCounts& counts, WallTime now) {
  AgentLoad& load = process_->load;
  process_->rejected_by_bus = static_cast<std::uint32_t>(counts.rejected);
  if (counts.agents > load.agents_matched) load.matched_at = now;
  load.agents_matched = static_cast<std::uint32_t>(counts.agents);
  load.bytes_sent = counts.bytes_sent;
  load.bytes_received = counts.bytes_received;
  load.processor_seconds = counts.processor_seconds;
}

void RobotAgent::receive(const MapMessage& message, WallTime) {
  std::shared_ptr<MapContext>& map = process_->newest_map;
  if (map && map->map_id == message.map_id) return;
  map = process_->map_contexts->of(message);
  process_->impossible += process_->trees.restrict_to(*map);
}

/// Fleet time so far from now that its fractions are lost is of no use.
void RobotAgent::receive(const Mission& mission, WallTime arrived) {
  if (!is_sane(mission.clock.fleet_time(arrived))) {
    ++process_->impossible;
    return;
  }
  const bool of_another_run = fleet_->run() && *fleet_->run() != mission.clock;
  if (of_another_run && passes_over(mission, fleet_->run()->run(), fleet_->own_mission())) return;
  if (of_another_run) begin_run();
  if (!run_heard_at_) run_heard_at_ = arrived;
  fleet_->hear(as_reference(mission), arrived);
}

void RobotAgent::receive(const HaltMessage& message, WallTime) {
  if (message.number < halts_heard_) return;
  halts_heard_ = message.number;
  process_->halt = halt_of(message, process_->name);
}

/// The missions as bodies carry them out. Bodies that robots follow are slower than the robots.
Mission RobotAgent::as_reference(Mission mission) const {
  const Follower robot{limits_of(mission), own_radius(mission), mission.tracking_tolerance};
  if (mission.robot == process_->name) mission.radius = driving_radius(mission);
  if (!process_->tracking) return mission;
  const Limits limits = reference_limits(robot, mission.clock.scale);
  mission.max_speed = limits.max_speed;
  mission.max_acceleration = limits.max_acceleration;
  mission.max_angular_speed = limits.max_angular_speed;
  mission.max_angular_acceleration = limits.max_angular_acceleration;
  return mission;
}

/// Fleet time begins anew. The robots of a standing fleet stay where they are; others stand where their
/// missions say.
void RobotAgent::begin_run() {
  if (run_ && !process_->tracking) process_->stands = resting_place(run_->body());
  run_.reset();
  fleet_ = std::make_unique<Fleet>(process_->name);
  run_heard_at_.reset();
  status_is_due_ = true;
  next_status_ = next_wake_ = 0;
}

void RobotAgent::receive(const InactiveTreesMessage& trees, WallTime) {
  switch (process_->trees.take(trees, process_->newest_map.get())) {
    case TreeStore::Verdict::of_another_map:
    case TreeStore::Verdict::known:
      return;
    case TreeStore::Verdict::impossible:
      ++process_->impossible;
      return;
    case TreeStore::Verdict::kept:
      break;
  }
  if (run_) {
    run_->hear(trees);
  } else {
    status_is_due_ = true;  // the service waits until all agents have the trees
  }
}

/// Other maps may be heard of while the robot drives on its own.
bool RobotAgent::has_map_of(const Mission& mission) const {
  const auto is_its_map = [&](const std::shared_ptr<MapContext>& map) {
    return map && map->map_id == mission.map_id;
  };
  return is_its_map(process_->newest_map) || (run_ && is_its_map(run_->map()));
}

/// A robot that is elsewhere has to be seen. Where a body stands is known, or it is where its mission says.
bool RobotAgent::knows_where_it_stands(WallTime now) const {
  const std::optional<Standing>& stands = process_->stands;
  return !process_->tracking || (stands && std::abs(now - stands->seen_at) <= process_->tracking->patience);
}

Mission RobotAgent::from_where_it_stands(Mission mission) const {
  const std::optional<Standing>& stands = process_->stands;
  if (!mission.starts_where_it_stands || !stands) return mission;
  if (mission.goal == mission.start) mission.goal = stands->position;
  mission.start = stands->position;
  mission.start_yaw = stands->yaw;
  return mission;
}

/// Takes up the mission once its map is there. A cancelled mission ends the run, also without a map.
void RobotAgent::begin_mission(WallTime now) {
  if (process_->retired || !fleet_->own_mission()) return;
  const Mission& mission = *fleet_->own_mission();
  if (run_ && run_->mission().number == mission.number && !mission.cancelled) return;  // nearly always
  if (mission.cancelled && !is_of_run(process_->saved_state, mission)) {
    if (run_) run_->stop();
    return;
  }
  if (!has_map_of(mission)) return;
  if (run_) {
    run_->take_up(mission, now);
  } else {
    if (mission.starts_where_it_stands && !knows_where_it_stands(now)) return;
    run_ = std::make_unique<Run>(*process_, *fleet_, reservations_, from_where_it_stands(mission), now);
    if (early_plan_) run_->hear(std::exchange(early_plan_, nullptr));
  }
}

std::vector<Outgoing> RobotAgent::step(WallTime now) {
  std::vector<Outgoing> out;
  begin_mission(now);
  if (run_) run_->step(now, out);
  report(now, out);
  next_wake_ = run_ ? std::min(next_status_, run_->next_wake(now)) : next_status_;
  return out;
}

/// Empty: no mission has come yet, and none needs to have come.
std::string RobotAgent::why_there_is_no_mission(WallTime now) const {
  const auto& own = fleet_->own_mission();
  if (own && !own->cancelled && !has_map_of(*own) && now - *run_heard_at_ > all_missions_come)
    return "the map of its mission has not come";
  if (own && !own->cancelled && own->starts_where_it_stands && !knows_where_it_stands(now))
    return "waits for the odometry of its robot, which says where it stands";
  if (own || !run_heard_at_) return {};
  std::vector<RobotName> robots = fleet_->robots_of_the_run();
  const bool all_have_come = robots.size() >= fleet_->size_of_the_run();
  if (robots.empty() || (!all_have_come && now - *run_heard_at_ <= all_missions_come)) return {};
  std::ranges::sort(robots, counts_before);
  const RobotName& name = process_->name;
  return robots.size() == 1 ? fmt::format("no mission for {}: the run has {}", name, robots.front())
                            : fmt::format("no mission for {}: the run has {} robots, {} to {}", name,
                                          robots.size(), robots.front(), robots.back());
}

AgentStatus RobotAgent::status(WallTime now) {
  AgentStatus status = run_ ? run_->status(now) : AgentStatus{.robot = process_->name};
  if (!run_) status.reason = bounded(why_there_is_no_mission(now));
  status.trees_received = process_->trees.size();
  status.rejected = process_->rejected_by_bus + process_->impossible;
  AgentLoad& load = process_->load;
  load.state_age_p50 = process_->state_ages.at_share(0.5);
  load.state_age_p99 = process_->state_ages.at_share(0.99);
  load.state_age_max = process_->state_ages.most();
  status.load = load;
  return status;
}

/// All track points go out with a change of the status, so that the record is complete. They do not go out
/// with each status, which comes by the wall's clock: in a slow fleet each message would hold one point.
void RobotAgent::report(WallTime now, std::vector<Outgoing>& out) {
  if (run_) {
    status_is_due_ = run_->take_status_change() || status_is_due_;
    run_->send_track(status_is_due_, out);
  }
  if (!status_is_due_ && now < next_status_) return;
  out.emplace_back(status(now));
  status_is_due_ = false;
  next_status_ = now + status_interval;
}

void RobotAgent::retire() {
  process_->retired = true;
  if (run_) run_->stop("the agent was told to stop");
}

std::vector<Outgoing> RobotAgent::final_messages(WallTime now) {
  std::vector<Outgoing> out;
  if (run_) run_->end_track();
  status_is_due_ = true;
  report(now, out);
  return out;
}

}  // namespace coppice
