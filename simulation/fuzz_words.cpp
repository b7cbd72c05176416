#include "simulation/fuzz_words.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <span>

#include <fmt/format.h>

namespace coppice {

namespace {

constexpr double hardly_more = 1.001;  // equal values differ by rounding

template <class Value>
std::string range_of(std::span<const RobotTask> robots, Value&& value) {
  double least = value(robots.front());
  double most = least;
  for (const RobotTask& robot : robots) {
    least = std::min(least, value(robot));
    most = std::max(most, value(robot));
  }
  return most <= hardly_more * least ? fmt::format("{:.3g}", most)
                                     : fmt::format("{:.3g} to {:.3g}", least, most);
}

std::string turning_in_words(const std::vector<RobotTask>& robots) {
  std::vector<RobotTask> differential;
  std::ranges::copy_if(robots, std::back_inserter(differential),
                       [](const RobotTask& robot) { return is_differential(limits_of(robot)); });
  if (differential.empty()) return ", holonomic";
  const auto heading = std::ranges::count_if(
      differential, [](const RobotTask& robot) { return robot.goal_yaw_tolerance > 0; });
  return fmt::format(", {} differential with {} rad/s, stopping that in {} s, {} with a yaw at the goal",
                     differential.size(),
                     range_of(differential, [](const RobotTask& robot) { return robot.max_angular_speed; }),
                     range_of(differential,
                              [](const RobotTask& robot) {
                                return robot.max_angular_speed / robot.max_angular_acceleration;
                              }),
                     heading);
}

std::string robots_in_words(const Scenario& scenario) {
  const std::vector<RobotTask>& robots = scenario.robots;
  std::string text =
      fmt::format("{} robots on {} with cells of {:.3g} m: radius {} m, {} m/s, braking in {} s",
                  robots.size(), scenario.map_name, scenario.map.resolution,
                  range_of(robots, [](const RobotTask& r) { return r.radius; }),
                  range_of(robots, [](const RobotTask& r) { return r.max_speed; }),
                  range_of(robots, [](const RobotTask& r) { return r.max_speed / r.max_acceleration; }));
  text += turning_in_words(robots);
  const auto footprints =
      std::ranges::count_if(robots, [](const RobotTask& r) { return !r.footprint.empty(); });
  if (footprints > 0) text += fmt::format(", {} with footprints", footprints);
  if (scenario.margin > 0) text += fmt::format(", margin {:.3g} m", scenario.margin);
  if (robots.front().tracking_tolerance > 0)
    text += fmt::format(", tracking tolerance {} m",
                        range_of(robots, [](const RobotTask& r) { return r.tracking_tolerance; }));
  return text;
}

std::string network_in_words(const BusFaults& bus) {
  std::string text = fmt::format(", loss {:.2f}, delay {:.3f} +- {:.3f} s, duplicates {:.2f}{}", bus.loss,
                                 bus.delay, bus.jitter, bus.duplicate, bus.reorder ? ", reordered" : "");
  for (const Partition& cut : bus.partitions)
    text += fmt::format(", in two pieces from {:.2f} to {:.2f} s", cut.from, cut.until);
  for (const CutLink& cut : bus.cut_links)
    text += fmt::format(", {} and {} cut off from each other from {:.2f} to {:.2f} s", cut.a, cut.b, cut.from,
                        cut.until);
  return text;
}

std::string faults_in_words(const Faults& faults) {
  std::string text = network_in_words(faults.bus);
  if (faults.clock_skew > 0) text += fmt::format(", clocks +- {:.2f} s", faults.clock_skew);
  if (faults.clock_drift > 0) text += fmt::format(", clocks drift by {:.2g}", faults.clock_drift);
  if (faults.pause_rate > 0)
    text += fmt::format(", pauses {:.0f}/h of {:.2f} s", faults.pause_rate, faults.pause);
  if (faults.kill_rate > 0)
    text += fmt::format(", {:.0f} kills/h, restarted {:.2f} s later", faults.kill_rate, faults.restart_after);
  for (const Faults::Kill& kill : faults.kills)
    text += fmt::format(", {} killed at {:.2f} s", kill.robot, kill.time);
  if (is_any(faults.drive))
    text += fmt::format(", following with noise {:.2g} m, lag {:.2g} s, slip {:.2g}",
                        faults.drive.odometry_noise, faults.drive.lag, faults.drive.slip);
  return text;
}

std::string halt_in_words(const TimedOrder& halt) {
  constexpr std::array names{"go", "cancel", "pause", "resume", "stop", "release"};
  return fmt::format(
      ", {} {} at {:.2f} s", names[static_cast<std::size_t>(halt.order.action)],
      halt.order.robots.empty() ? "all" : fmt::format("{}", fmt::join(halt.order.robots, " and ")),
      halt.time);
}

}  // namespace

std::string in_words(const FuzzCase& fuzz_case) {
  const SimulationSettings& settings = fuzz_case.settings;
  std::string text = robots_in_words(fuzz_case.scenario) + faults_in_words(settings.faults);
  for (const TimedOrder& halt : fuzz_case.halts) text += halt_in_words(halt);
  text += fmt::format(", plan budget {:g} s", settings.plan_budget);
  if (!settings.plan.empty()) text += ", a joint plan on the cells";
  if (!reserves(settings.coordination)) text += ", by velocity obstacles";
  if (settings.lifelong > 0) text += fmt::format(", new goals for {:.0f} s", settings.lifelong);
  return text;
}

}  // namespace coppice
