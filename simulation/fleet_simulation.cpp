#include "simulation/fleet_simulation.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

namespace coppice {

namespace {

constexpr double bus_delay = 0.001;  // seconds; a DDS sample takes a tenth of that, more on a busy machine
constexpr double step_duration = 0.001;  // seconds between two steps of one role
constexpr double watch_period = 0.1;
constexpr double longest_foreseen = 3600;  // seconds
constexpr double ending = 10;              // seconds, about, until all robots stand after the end of the time
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding_of_time = 1e-9;        // seconds
constexpr double longest_without_command = 0.5;  // seconds, after which a robot stops by itself at the latest

/// Seconds without a command after which a robot stops by itself: as docs/ros.md assumes, so soon that it
/// keeps within its tolerance while its reference has braked.
double time_without_command(const RobotTask& task, const DriveFaults& drive, double scale) {
  const Limits reference = reference_limits({limits_of(task), task.radius, task.tracking_tolerance}, scale);
  return std::min(longest_without_command, task.tracking_tolerance / reference.max_speed - drive.lag);
}

/// The points of a track of a lifelong run, whose duration is known. Reserving them avoids copies of growing
/// tracks.
std::size_t points_foreseen(const SimulationSettings& settings) {
  if (settings.lifelong <= 0) return 0;
  const double seconds = std::min({settings.lifelong, settings.timeout, longest_foreseen});
  return static_cast<std::size_t>((seconds + ending) / control_period);
}

}  // namespace

FleetSimulation::FleetSimulation(const Scenario& scenario, const SimulationSettings& settings)
    : scenario_(scenario),
      settings_of_service_{.timeout = settings.timeout,
                           .planner = settings.planner,
                           .trees = settings.trees,
                           .forest = settings.forest,
                           .plan_budget = settings.plan_budget,
                           .lifelong = settings.lifelong,
                           .waits_for_goals = settings.takes_orders,
                           .plan = settings.plan,
                           .coordination = settings.coordination,
                           .robots_elsewhere = is_any(settings.faults.drive)},
      drive_(settings.faults.drive),
      bus_(bus_delay, settings.faults.bus, Random(scenario.seed)),
      service_(started_service()),
      broker_{TreeBroker(1, scenario.seed), bus_.attach(Role::broker)},
      sentinel_(scenario) {
  if (!settings.takes_orders) bus_.keep_for(Role::agent);
  std::vector<AgentFaults> drawn = draw_faults(settings.faults, scenario, settings.timeout);
  for (const RobotTask& task : scenario.robots) {
    AgentFaults& faults = drawn[agents_.size()];
    const double next_kill = faults.killed_after(0);
    agents_.push_back({.name = task.name,
                       .index = agents_.size(),
                       .process = nullptr,
                       .faults = std::move(faults),
                       .next_kill = next_kill,
                       .kept = std::make_unique<KeptInMemory>()});
    tracks_.push_back({task.name, {task.radius, {}}});
    tracks_.back().track.points.reserve(points_foreseen(settings));
    start(agents_.back());
    wakes_.emplace_back();
    set_wake(agents_.back());
  }
}

/// The service goes on with what one before it saved.
std::unique_ptr<FleetSimulation::Participant<PlannerService>> FleetSimulation::started_service() {
  auto service = std::unique_ptr<Participant<PlannerService>>(new Participant<PlannerService>{
      .role = PlannerService(scenario_, settings_of_service_, now_), .port = bus_.attach(Role::service)});
  RunKeeper keeper;
  keeper.recall(kept_of_service_.messages);
  service->role.recall(kept_of_service_.messages, now_);
  const bool may_return = settings_of_service_.waits_for_goals;
  keeper_of_service_.emplace(std::move(keeper), may_return ? &kept_of_service_ : nullptr);
  return service;
}

void FleetSimulation::restart_service() {
  service_->port.close();
  service_ = started_service();
}

void FleetSimulation::give(OrderMessage order) {
  service_->role.on(arrival_of(std::move(order), now_));
}

void FleetSimulation::start(Agent& agent) {
  const bool may_return = agent.faults.restart_after < infinity;
  auto& port = bus_.attach(Role::agent, agent.name, agent.faults.side);
  agent.process = std::make_unique<Participant<RobotAgent>>(
      Participant<RobotAgent>{.role = RobotAgent(agent.name, map_contexts_), .port = port});
  if (is_any(drive_))
    agent.process->role.track_robot(
        {.noise = drive_.odometry_noise, .yaw_noise = FollowingRobot::yaw_noise * drive_.odometry_noise});
  agent.process->role.restore(saved_state_of(agent.kept->messages, is_any(drive_)));
  StateKeeper keeper(agent.name, is_any(drive_));
  keeper.restore(agent.kept->messages);
  agent.keeper.emplace(std::move(keeper), may_return ? agent.kept.get() : nullptr);
}

void FleetSimulation::kill(Agent& agent) {
  agent.knew_failed.clear();
  for (const Agent& other : agents_) {
    const auto known = agent.run() ? agent.run()->fleet().find(other.name) : std::nullopt;
    if (known && known->failed) agent.knew_failed.push_back(other.name);
  }
  agent.process->port.close();
  agent.process.reset();
}

template <class R>
double FleetSimulation::Participant<R>::next_event(const AgentClock& clock) const {
  return std::max(earliest, std::min(clock.true_time(role.next_wake()), port.next_delivery()));
}

/// The next step if it comes before the next kill; otherwise the restart after that kill (infinity: none).
double FleetSimulation::Agent::next_event() const {
  const double back = next_kill + faults.restart_after;
  if (!process) return back;
  double awake = process->next_event(faults.clock);
  if (follower) awake = std::min(awake, follower->clock.wall_time(follower->robot.time() + control_period));
  const double next = faults.awake_from(awake);
  return next < next_kill ? next : back;
}

template <class R, class K>
void FleetSimulation::step(Participant<R>& participant, K&& keeper, const AgentClock& clock) {
  if (participant.next_event(clock) > now_) return;
  const WallTime local = clock.local(now_);
  std::vector<Arrival> arrivals = participant.port.take();
  if constexpr (requires { participant.role.expect(arrivals); }) participant.role.expect(arrivals);
  for (Arrival& arrival : arrivals) {
    arrival.at = clock.local(arrival.at);
    keeper.heard(*arrival.message);
    participant.role.on(std::move(arrival));
  }
  // Exactly the same arithmetic as in next_event.
  if (clock.true_time(participant.role.next_wake()) > now_) return;
  for (auto& said : participant.role.step(local)) {
    Outgoing outgoing(std::move(said));
    keeper.said(outgoing.message);
    if (listener_) listener_(outgoing.message, now_);
    if constexpr (std::is_same_v<R, RobotAgent>) sentinel_.hear(outgoing.message, now_);
    participant.port.publish(std::move(outgoing));
  }
  participant.earliest = now_ + step_duration;
}

void FleetSimulation::step(Agent& agent) {
  if (agent.process && now_ >= agent.next_kill) kill(agent);
  if (!agent.process) {
    if (now_ < agent.next_event()) return;
    agent.next_kill = agent.faults.killed_after(now_);
    ++agent.restarts;
    start(agent);
  }
  if (agent.next_event() > now_) return;
  meet_robot(agent);
  step(*agent.process, *agent.keeper, agent.faults.clock);
  const Run* const run = agent.process->role.run();
  if (run == nullptr) return;
  show(agent, *run);
  if (is_any(drive_)) return command_robot(agent, *run);
  record(agent, run->body().time());
  agent.body = run->body();
  agent.clock_of_run = agent.faults.clock.counted_from(run->mission().clock.epoch);
}

/// To the sentinel. With each decision it looks at one of the clocks that the agent knows: so the cost does
/// not grow with the square of the fleet, and each clock of 100 robots is looked at every 5 s.
void FleetSimulation::show(Agent& agent, const Run& run) {
  const RunId id = run.mission().clock.run();
  const AgentClock clock{agent.faults.clock.offset - id.epoch, agent.faults.clock.drift};
  if (!sentinel_.look(agent.index, {run.body(), clock, id, run.left_out(), run.map()->field}, now_)) return;
  agent.peer_in_turn = (agent.peer_in_turn + 1) % agents_.size();
  if (const ClockOffset* const known = run.fleet().clock_of(agents_[agent.peer_in_turn].name))
    sentinel_.check_clock(agent.index, agent.peer_in_turn, *known, now_);
}

/// The robot drives on until now, and its agent sees where it is.
void FleetSimulation::meet_robot(Agent& agent) {
  if (!agent.follower) return;
  Follower& follower = *agent.follower;
  const double before = follower.robot.time();
  move_robot(agent, follower.clock.fleet_time(now_));
  if (follower.robot.time() == before) return;
  const WallTime seen_at = agent.faults.clock.local(follower.clock.wall_time(follower.robot.time()));
  agent.process->role.on(follower.robot.odometry(seen_at));
}

/// The first robot that the agent leads stands at its start.
void FleetSimulation::command_robot(Agent& agent, const Run& run) {
  const FleetClock& clock = run.mission().clock;
  const double fleet_now = clock.fleet_time(now_);
  if (!agent.follower) {
    const std::uint64_t seed = scenario_.seed * 1'000'003ull + agent.index;
    const RobotTask& task = scenario_.robots[agent.index];
    agent.follower.emplace(Follower{.robot = FollowingRobot(task, drive_, fleet_now, Random(seed)),
                                    .stops_after = time_without_command(task, drive_, clock.scale),
                                    .clock = clock});
  }
  agent.follower->command = agent.process->role.command(agent.faults.clock.local(now_));
  agent.follower->commanded_at = fleet_now;
}

void FleetSimulation::move_robot(Agent& agent, double until) {
  Follower& follower = *agent.follower;
  while (follower.robot.time() + control_period <= until + rounding_of_time) {
    tracks_[agent.index].track.points.push_back(follower.robot.at());
    const bool stops = follower.robot.time() > follower.commanded_at + follower.stops_after;
    follower.robot.advance(stops ? DriveCommand{} : follower.command, control_period);
  }
}

/// Records all periods since the last step, with the motion of a body that is driven no further.
void FleetSimulation::record(Agent& agent, double until) {
  if (!agent.body) return;
  Driver& body = *agent.body;
  const AgentClock& clock = agent.clock_of_run;
  const double rate = 1 + clock.drift;  // its periods are as much shorter by the true clock
  while (body.time() + body.period() / 2 < until) {
    tracks_[agent.index].track.points.push_back({clock.true_time(body.time()), body.position(),
                                                 rate * body.velocity(), body.yaw(),
                                                 rate * body.angular_velocity()});
    body.advance();
  }
}

double FleetSimulation::next_event(const Wake& wake) const {
  const bool is_sent_something = wake.port && wake.port->next_delivery() < infinity;
  return is_sent_something ? agents_[wake.agent].next_event() : wake.alone;
}

double FleetSimulation::next_event() const {
  double next = std::min(service_->next_event(), broker_.next_event());
  for (const Wake& wake : wakes_) next = std::min(next, next_event(wake));
  return next;
}

void FleetSimulation::set_wake(const Agent& agent) {
  Wake& wake = wakes_[agent.index];
  wake = {.agent = agent.index, .alone = agent.next_event()};
  if (!agent.process) return;
  wake.kill = agent.next_kill;
  wake.port = &agent.process->port;
}

void FleetSimulation::run(const std::function<bool(const PlannerService&, double)>& watch) {
  double next_watch = 0;
  while (!service_->role.finished() && !sentinel_.broken()) {
    now_ = std::max(now_, next_event());
    bus_.set_time(now_);
    step(*service_, *keeper_of_service_);
    step(broker_, KeepsNothing{});
    for (const Wake& wake : wakes_) {
      if (now_ < wake.kill && now_ < next_event(wake)) continue;  // nearly always
      step(agents_[wake.agent]);
      set_wake(agents_[wake.agent]);
    }
    if (now_ < next_watch) continue;
    next_watch = now_ + watch_period;
    if (!watch(service_->role, now_)) service_->role.interrupt();
  }
  for (Agent& agent : agents_) {
    if (agent.body) record(agent, agent.clock_of_run.local(service_->role.progress(now_).elapsed));
    if (agent.follower) move_robot(agent, service_->role.progress(now_).elapsed);
  }
}

SufferedFaults FleetSimulation::suffered() const {
  SufferedFaults suffered{.lost = bus_.lost(), .rejected = bus_.rejected()};
  for (const Agent& agent : agents_) {
    suffered.kills += agent.restarts + (now_ >= agent.next_kill);
    suffered.restarts += agent.restarts;
    suffered.pauses += std::ranges::count_if(
        agent.faults.pauses, [&](double begin) { return begin < std::min(now_, agent.next_kill); });
  }
  return suffered;
}

const FleetSimulation::Agent& FleetSimulation::agent(const RobotName& robot) const {
  return *std::ranges::find(agents_, robot, &Agent::name);
}

bool FleetSimulation::Agent::knows(const RobotName& other) const {
  return (run() != nullptr && run()->fleet().is_placed(other)) ||
         std::ranges::find(knew_failed, other) != knew_failed.end();
}

bool FleetSimulation::knows(const RobotName& robot, const RobotName& other) const {
  return agent(robot).knows(other);
}

bool FleetSimulation::lost(const RobotName& robot) const {
  const auto is_dead = [&](const Agent& a) {
    return now_ >= a.next_kill && a.faults.restart_after == infinity;
  };
  return is_dead(agent(robot)) &&
         std::ranges::none_of(agents_, [&](const Agent& a) { return !is_dead(a) && a.knows(robot); });
}

std::vector<Disc> FleetSimulation::places_of_failed(const RobotName& robot) const {
  const Run* const run = agent(robot).run();
  return run == nullptr ? std::vector<Disc>() : run->places_of_failed();
}

bool FleetSimulation::killed(const RobotName& robot) const {
  return now_ >= agent(robot).next_kill;
}

}  // namespace coppice
