#include "simulation/fleet_simulation.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace coppice {

namespace {

constexpr double bus_delay = 0.001;      // seconds; a DDS sample takes a tenth of that, a busy machine more
constexpr double step_duration = 0.001;  // seconds between two steps of one role
constexpr double watch_period = 0.1;

}  // namespace

FleetSimulation::FleetSimulation(const Scenario& scenario, const SimulationSettings& settings)
    : bus_(bus_delay, settings.faults.bus, Random(scenario.seed)),
      service_{PlannerService(scenario,
                              {.timeout = settings.timeout,
                               .planner = settings.planner,
                               .plan_budget = settings.plan_budget,
                               .lifelong = settings.lifelong},
                              0),
               bus_.attach(Role::service)},
      broker_{TreeBroker(1, scenario.seed), bus_.attach(Role::broker)} {
  Random random(scenario.seed + 1);
  const auto grounds = std::make_shared<Grounds>();
  for (const RobotTask& task : scenario.robots) {
    AgentFaults faults = draw_faults(settings.faults, task.name, settings.timeout, random);
    auto& port = bus_.attach(Role::agent, task.name, faults.side);
    agents_.push_back({task.name, {RobotAgent(task.name, grounds), port}, std::move(faults)});
    agents_.back().track.radius = task.radius;
  }
}

template <class R>
double FleetSimulation::Participant<R>::next_event(double clock_offset) const {
  return std::max(earliest, std::min(role.next_wake() - clock_offset, port.next_delivery()));
}

double FleetSimulation::Agent::next_event() const {
  const double next = faults.awake_from(participant.next_event(faults.clock_offset));
  return next < faults.killed_at ? next : std::numeric_limits<double>::infinity();
}

template <class R>
void FleetSimulation::turn(Participant<R>& participant, double clock_offset) {
  if (participant.next_event(clock_offset) > now_) return;
  const WallTime local = now_ + clock_offset;
  for (Arrival& arrival : participant.port.take()) {
    arrival.at += clock_offset;
    participant.role.on(arrival);
  }
  if (participant.role.next_wake() - clock_offset > now_) return;  // as next_event has it, to the bit
  for (auto& message : participant.role.step(local)) participant.port.publish(std::move(message));
  participant.earliest = now_ + step_duration;
}

void FleetSimulation::turn(Agent& agent) {
  if (now_ >= agent.faults.killed_at) {
    agent.participant.port.close();
    return;
  }
  if (agent.next_event() > now_) return;
  turn(agent.participant, agent.faults.clock_offset);
  const auto& body = agent.participant.role.body();
  if (!body) return;
  record(agent, body->time());
  agent.body = *body;
}

/// Every period that has passed since the last turn, as the body drives by itself.
void FleetSimulation::record(Agent& agent, double until) {
  if (!agent.body) return;
  Driver& body = *agent.body;
  while (body.time() + body.period() / 2 < until) {
    agent.track.points.push_back({body.time() - agent.faults.clock_offset, body.position(), body.velocity()});
    body.advance();
  }
}

double FleetSimulation::next_event() const {
  double next = std::min(service_.next_event(), broker_.next_event());
  for (const Agent& agent : agents_) next = std::min(next, agent.next_event());
  return next;
}

void FleetSimulation::run(const std::function<bool(const PlannerService&, double)>& watch) {
  double next_watch = 0;
  while (!service_.role.finished()) {
    now_ = std::max(now_, next_event());
    bus_.set_time(now_);
    turn(service_);
    turn(broker_);
    for (Agent& agent : agents_) turn(agent);
    if (now_ < next_watch) continue;
    next_watch = now_ + watch_period;
    if (!watch(service_.role, now_)) service_.role.interrupt();
  }
  for (Agent& agent : agents_) {
    if (agent.body) record(agent, service_.role.progress(now_).elapsed + agent.faults.clock_offset);
  }
}

std::vector<NamedTrack> FleetSimulation::tracks() const {
  std::vector<NamedTrack> tracks;
  for (const Agent& agent : agents_) tracks.push_back({agent.name, agent.track});
  return tracks;
}

SufferedFaults FleetSimulation::suffered() const {
  SufferedFaults suffered{.lost = bus_.lost(), .rejected = bus_.rejected()};
  for (const Agent& agent : agents_) {
    suffered.kills += now_ >= agent.faults.killed_at;
    suffered.pauses += std::ranges::count_if(
        agent.faults.pauses, [&](double begin) { return begin < std::min(now_, agent.faults.killed_at); });
  }
  return suffered;
}

bool FleetSimulation::killed(const RobotName& robot) const {
  const auto agent = std::ranges::find(agents_, robot, &Agent::name);
  return agent != agents_.end() && now_ >= agent->faults.killed_at;
}

}  // namespace coppice
