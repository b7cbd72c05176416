#include "simulation/fleet_simulation.h"

#include <algorithm>

namespace coppice {

namespace {

constexpr double bus_delay = 0.001;      // seconds; a DDS sample takes a tenth of that, a busy machine more
constexpr double step_duration = 0.001;  // seconds between two steps of one role
constexpr double watch_period = 0.1;

}  // namespace

FleetSimulation::FleetSimulation(const Scenario& scenario, const SimulationSettings& settings)
    : bus_(bus_delay),
      service_{
          PlannerService(
              scenario,
              {.timeout = settings.timeout, .planner = settings.planner, .plan_budget = settings.plan_budget},
              0),
          bus_.attach(Role::service)},
      broker_{TreeBroker(1, scenario.seed), bus_.attach(Role::broker)} {
  for (const RobotTask& task : scenario.robots) {
    agents_.push_back({RobotAgent(task.name), bus_.attach(Role::agent)});
  }
}

template <class R>
double FleetSimulation::Participant<R>::next_event() const {
  return std::max(earliest, std::min(role.next_wake(), port.next_delivery()));
}

template <class R>
void FleetSimulation::turn(Participant<R>& participant) {
  if (participant.next_event() > now_) return;
  for (const Message& message : participant.port.take()) participant.role.on(message, now_);
  if (participant.role.next_wake() > now_) return;
  for (const Message& message : participant.role.step(now_)) participant.port.publish(message);
  participant.earliest = now_ + step_duration;
}

double FleetSimulation::next_event() const {
  double next = std::min(service_.next_event(), broker_.next_event());
  for (const auto& agent : agents_) next = std::min(next, agent.next_event());
  return next;
}

void FleetSimulation::run(const std::function<bool(const PlannerService&, double)>& watch) {
  double next_watch = 0;
  while (!service_.role.finished()) {
    now_ = std::max(now_, next_event());
    bus_.set_time(now_);
    turn(service_);
    turn(broker_);
    for (auto& agent : agents_) turn(agent);
    if (now_ < next_watch) continue;
    next_watch = now_ + watch_period;
    if (!watch(service_.role, now_)) service_.role.interrupt();
  }
}

}  // namespace coppice
