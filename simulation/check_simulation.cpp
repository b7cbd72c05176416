#include "simulation/check_simulation.h"

#include <algorithm>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "planning/quantities.h"
#include "simulation/drive_limits.h"
#include "simulation/fault_limits.h"

namespace coppice {

namespace {

void check_between(std::string_view field, double value, double least, double most) {
  if (value >= least && value <= most) return;
  throw InputError(
      fmt::format("{}: {} is not allowed, expected a number from {} to {}", field, value, least, most));
}

void check_faults(const Faults& faults, const Scenario& scenario) {
  check_between("faults.loss", faults.bus.loss, 0, largest_loss);
  check_between("faults.delay", faults.bus.delay, 0, longest_delay);
  check_between("faults.jitter", faults.bus.jitter, 0, longest_delay);
  check_between("faults.duplicate", faults.bus.duplicate, 0, 1);
  check_between("faults.kill_rate", faults.kill_rate, 0, most_an_hour);
  check_between("faults.pause_rate", faults.pause_rate, 0, most_an_hour);
  check_between("faults.pause", faults.pause, shortest_fault, longest_fault);
  check_between("faults.clock_skew", faults.clock_skew, 0, longest_fault);
  check_between("faults.clock_drift", faults.clock_drift, 0, largest_drift);
  check_between("faults.restart_after", faults.restart_after, shortest_fault,
                std::numeric_limits<double>::infinity());
  check_between("faults.drive.odometry_noise", faults.drive.odometry_noise, 0, most_noise);
  check_between("faults.drive.lag", faults.drive.lag, 0, longest_lag);
  check_between("faults.drive.slip", faults.drive.slip, 0, most_slip);
  check_drive(faults.drive, scenario);
  for (const Faults::Kill& kill : faults.kills) {
    if (std::ranges::count(scenario.robots, kill.robot, &RobotTask::name) == 0)
      throw InputError(fmt::format("faults.kills: there is no robot \"{}\"", kill.robot));
    check_between("faults.kills", kill.time, 0, longest_fault);
  }
  for (const Partition& partition : faults.bus.partitions) {
    if (!(partition.from < partition.until))
      throw InputError(
          fmt::format("faults.partitions: {} is not before {}", partition.from, partition.until));
  }
}

}  // namespace

void check_simulation(const Scenario& scenario, const SimulationSettings& settings) {
  check_scenario(scenario);
  check_faults(settings.faults, scenario);
  check_between("timeout", settings.timeout, shortest_fault, largest_quantity);
  check_between("plan_budget", settings.plan_budget, 0, largest_quantity);
  check_between("lifelong", settings.lifelong, 0, largest_quantity);
  if (const auto fault = fault_of(settings.trees)) throw InputError("trees." + std::string(*fault));
  if (!settings.plan.empty() && settings.plan.size() != scenario.robots.size())
    throw InputError(fmt::format("plan: has {} trajectories, expected {} or none", settings.plan.size(),
                                 scenario.robots.size()));
  if (!settings.plan.empty() && !reserves(settings.coordination))
    throw InputError("plan: goes with coordination by reservations only");
}

}  // namespace coppice
