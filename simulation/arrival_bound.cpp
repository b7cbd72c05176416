#include "simulation/arrival_bound.h"

#include <algorithm>
#include <numbers>

#include "robot_agent/process/reference_limits.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr double at_once = 0.25;  // of its free speed: robots in each other's ways, one after the other
constexpr double waits_for_its_robot = 2;  // times as long takes a reference that waits
constexpr double bends = 10;               // of a way
constexpr double start = 30;               // seconds, of a fleet: missions, handshakes, first paths
// Seconds for each robot, beside the time for which it listens: its turn, and a round.
constexpr double turn_and_round = 2 * Timing::longest_turn + Timing::longest_stall;

/// A robot that follows goes no faster than its reference; one with a differential drive turns on the spot at
/// the bends of its way.
double slower_by_drive(const FuzzCase& fuzz_case) {
  if (!is_any(fuzz_case.settings.faults.drive)) return 1;
  double most = 1;
  for (const RobotTask& robot : fuzz_case.scenario.robots) {
    const Follower follower{limits_of(robot), robot.radius, robot.tracking_tolerance};
    most = std::max(most, robot.max_speed / reference_limits(follower, 1).max_speed);
  }
  return waits_for_its_robot * most;
}

double turning(const Scenario& scenario) {
  double seconds = 0;
  for (const RobotTask& robot : scenario.robots)
    seconds += bends * time_to_turn(std::numbers::pi / 2, limits_of(robot));
  return seconds;
}

double longest_braking_of(const Scenario& scenario) {
  double longest = 0;
  for (const RobotTask& robot : scenario.robots) longest = std::max(longest, braking_time(limits_of(robot)));
  return longest;
}

/// Robots stand while they are cut off, and listen afterwards.
double outages(const Faults& faults, const SufferedFaults& suffered, double listening) {
  double seconds = 0;
  for (const Partition& cut : faults.bus.partitions) seconds += cut.until - cut.from + listening;
  for (const CutLink& cut : faults.bus.cut_links) seconds += cut.until - cut.from + listening;
  const auto times = [](std::size_t count) { return static_cast<double>(count); };
  const std::size_t for_good = suffered.kills - suffered.restarts;
  seconds += times(suffered.pauses) * (faults.pause + listening);
  if (suffered.restarts > 0)
    seconds += times(suffered.restarts) * (faults.restart_after + turn_and_round + listening);
  return seconds + times(for_good) * (Timing::longest_partition + turn_and_round + listening);
}

/// The sum of the times that the robots would need alone for their last ways.
double free_flow_of(const FleetSimulation& simulation) {
  const proto::Report report = simulation.service().report(in_parts(simulation.tracks()));
  double sum = 0;
  for (const auto& robot : report.robots()) sum += robot.free_flow_time();
  return sum;
}

}  // namespace

double arrival_bound(const FuzzCase& fuzz_case, const FleetSimulation& simulation) {
  const SufferedFaults suffered = simulation.suffered();
  const double free_flow = free_flow_of(simulation);
  const Faults& faults = fuzz_case.settings.faults;
  const double listening = listening_time(longest_braking_of(fuzz_case.scenario), 1);
  const double last_order = fuzz_case.halts.empty() ? 0 : fuzz_case.halts.back().time;
  const auto robots = static_cast<double>(fuzz_case.scenario.robots.size());
  const double undisturbed = start + robots * (turn_and_round + listening) +
                             slower_by_drive(fuzz_case) * (free_flow + turning(fuzz_case.scenario)) / at_once;
  // Robots say again what is lost, and wait for what comes late.
  const double slower = (1 + faults.bus.delay + faults.bus.jitter) / (1 - faults.bus.loss);
  return std::max(fuzz_case.settings.lifelong, last_order) + slower * undisturbed +
         outages(faults, suffered, listening);
}

}  // namespace coppice
