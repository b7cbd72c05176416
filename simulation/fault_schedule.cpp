#include "simulation/fault_schedule.h"

#include <algorithm>
#include <cmath>

#include "coppice/planning/random.h"

namespace coppice {

namespace {

constexpr double hour = 3600;

/// The time until the next event of a Poisson process with `rate` events an hour, seconds; infinity for rate
/// 0.
double gap(double rate, Random& random) {
  return rate > 0 ? -std::log(1 - random.uniform()) * hour / rate : std::numeric_limits<double>::infinity();
}

AgentFaults draw_faults_of(const std::string& robot, const Faults& faults, double horizon, Random& random) {
  AgentFaults drawn{.side = static_cast<int>(random.index(2)),
                    .clock = {.offset = random.uniform(-faults.clock_skew, faults.clock_skew)},
                    .restart_after = faults.restart_after,
                    .pause = faults.pause};
  for (double t = gap(faults.kill_rate, random); t < horizon;
       t += faults.restart_after + gap(faults.kill_rate, random))
    drawn.kills.push_back(t);
  for (double t = gap(faults.pause_rate, random); t < horizon;
       t += faults.pause + gap(faults.pause_rate, random))
    drawn.pauses.push_back(t);
  for (const Faults::Kill& kill : faults.kills) {
    if (kill.robot != robot) continue;
    if (kill.for_good) {  // removes earlier kills, which would be for good as well
      drawn.kills.clear();
      drawn.restart_after = std::numeric_limits<double>::infinity();
    }
    drawn.kills.push_back(kill.time);
  }
  std::ranges::sort(drawn.kills);
  return drawn;
}

}  // namespace

double AgentFaults::awake_from(double time) const {
  const auto next = std::ranges::upper_bound(pauses, time);
  return next == pauses.begin() ? time : std::max(time, *(next - 1) + pause);
}

double AgentFaults::killed_after(double time) const {
  const auto next = std::ranges::lower_bound(kills, time);
  return next == kills.end() ? std::numeric_limits<double>::infinity() : *next;
}

std::vector<AgentFaults> draw_faults(const Faults& faults, const Scenario& scenario, double horizon) {
  Random random(scenario.seed + 1);
  Random of_drift(scenario.seed + 2);  // a source of its own, so that drift changes no other fault
  std::vector<AgentFaults> drawn;
  for (const RobotTask& task : scenario.robots) {
    drawn.push_back(draw_faults_of(task.name, faults, horizon, random));
    drawn.back().clock.drift = of_drift.uniform(-faults.clock_drift / 2, faults.clock_drift / 2);
  }
  return drawn;
}

}  // namespace coppice
