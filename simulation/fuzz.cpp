#include "simulation/fuzz.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "files/scenario_generator.h"
#include "motion/route_finder.h"
#include "planning/map_generator.h"
#include "simulation/invariants.h"

namespace coppice {

namespace {

constexpr double longest_run = 3600;  // fleet seconds
constexpr double radius = 5;          // metres, of robots on random maps
constexpr double max_speed = 20;

/// Any of the kinds that try coordination, or a random map with random tasks.
Scenario draw_scenario(std::uint32_t seed, Random& random) {
  const auto& kinds = scenario_kinds();
  constexpr std::array maps{MapKind::blank, MapKind::dense, MapKind::maze, MapKind::room};
  const std::size_t choice = random.index(kinds.size() + 2 * maps.size());
  if (choice < kinds.size()) {
    Scenario scenario = make_scenario(kinds[choice].name, kinds[choice].robots, seed);
    scenario.map_name = kinds[choice].name;
    return scenario;
  }
  constexpr std::array names{"blank", "dense", "maze", "room"};
  const std::size_t kind = (choice - kinds.size()) % maps.size();
  const int side = 200 + 40 * static_cast<int>(random.index(6));
  Scenario scenario{.map_name = names[kind],
                    .map = generate_map(maps[kind], side, side, random),
                    .seed = seed,
                    .robots = {}};
  const int robots = 2 + static_cast<int>(random.index(19));
  for (const auto& [start, goal] : random_tasks(ClearanceField(scenario.map), robots, radius, 0.1, random)) {
    scenario.robots.push_back(
        {fmt::format("r{}", scenario.robots.size() + 1), start, goal, radius, max_speed, 2 * max_speed, 1});
  }
  return scenario;
}

/// Each kind of fault in about half of the cases.
Faults draw_kinds_of_faults(const Scenario& scenario, Random& random) {
  const auto sometimes = [&](double most) { return random.uniform() < 0.5 ? random.uniform(0, most) : 0.0; };
  Faults faults;
  faults.bus.loss = sometimes(0.4);
  faults.bus.delay = sometimes(0.25);
  faults.bus.jitter = faults.bus.delay * random.uniform();
  faults.bus.duplicate = sometimes(0.1);
  faults.bus.reorder = random.uniform() < 0.5;
  faults.pause_rate = sometimes(120);
  faults.pause = random.uniform(0.1, 1.2);
  faults.clock_skew = sometimes(2);
  if (random.uniform() < 0.3) {
    const RobotTask& victim = scenario.robots[random.index(scenario.robots.size())];
    faults.kills.push_back({victim.name, random.uniform(0, 40)});
  }
  return faults;
}

std::string in_words(const Scenario& scenario, const Faults& faults) {
  std::string text = fmt::format(
      "{} {}, loss {:.2f}, delay {:.3f} +- {:.3f} s, duplicates {:.2f}{}, "
      "pauses {:.0f}/h of {:.2f} s, clocks +- {:.2f} s",
      scenario.robots.size(), scenario.map_name, faults.bus.loss, faults.bus.delay, faults.bus.jitter,
      faults.bus.duplicate, faults.bus.reorder ? ", reordered" : "", faults.pause_rate, faults.pause,
      faults.clock_skew);
  for (const Faults::Kill& kill : faults.kills)
    text += fmt::format(", {} killed at {:.2f} s", kill.robot, kill.time);
  return text;
}

/// Whether a robot that has not arrived could have, past the dead, from where it is.
bool could_arrive(const FuzzCase& fuzz_case, const Point2& from, const RobotTask& task,
                  std::span<const Disc> dead) {
  const ClearanceField field(fuzz_case.scenario.map);
  // A gap that only a finer lattice finds is no way that anybody would miss.
  RouteFinder finder(field, task.radius, usual_spacing(task.radius) / 2);
  return !finder.route(from, task.goal, dead).empty();
}

}  // namespace

FuzzCase draw_fuzz_case(std::uint32_t seed) {
  Random random(seed);
  Scenario scenario = draw_scenario(seed, random);
  Faults faults = draw_kinds_of_faults(scenario, random);
  const double lifelong = random.uniform() < 0.2 ? 300 : 0;
  std::string what = in_words(scenario, faults);
  if (lifelong > 0) what += fmt::format(", new goals for {:.0f} s", lifelong);
  // Shorter paths cost most of a simulation's time and have little to do with faults.
  const double plan_budget = random.uniform() < 0.2 ? 1 : 0.05;
  return {seed,
          std::move(what),
          std::move(scenario),
          {.timeout = longest_run,
           .plan_budget = plan_budget,
           .lifelong = lifelong,
           .faults = std::move(faults)}};
}

FuzzResult judge(const FuzzCase& fuzz_case, const FleetSimulation& simulation) {
  const std::vector<NamedTrack> tracks = simulation.tracks();
  FuzzResult result{.failures = broken_invariants(fuzz_case.scenario, tracks, control_period),
                    .suffered = simulation.suffered()};
  if (result.suffered.rejected > 0)
    result.failures.push_back(fmt::format("{} messages that no reader takes", result.suffered.rejected));
  std::vector<Disc> dead;
  for (const NamedTrack& track : tracks) {
    const auto& points = track.track.points;
    result.robot_hours += static_cast<double>(points.size()) * control_period / 3600;
    if (!simulation.killed(track.robot)) continue;
    const Point2 start =
        simulation.service().task(track.robot).start;  // killed before it had heard of its mission
    dead.push_back({points.empty() ? start : points.back().position, track.track.radius});
  }
  const proto::Report report = simulation.service().report(tracks);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const auto& robot = report.robots(static_cast<int>(i));
    if (robot.arrived() || simulation.killed(robot.name())) continue;
    const RobotTask& task = simulation.service().task(robot.name());
    const auto& points = tracks[i].track.points;
    if (could_arrive(fuzz_case, points.empty() ? task.start : points.back().position, task, dead))
      result.failures.push_back(fmt::format("{} is stuck: {}", robot.name(), robot.reason()));
  }
  return result;
}

}  // namespace coppice
