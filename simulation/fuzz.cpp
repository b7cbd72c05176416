#include "simulation/fuzz.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "coppice/files/scenario_generator.h"
#include "coppice/planning/map_generator.h"
#include "motion/joint_planner.h"
#include "motion/route_finder.h"
#include "simulation/invariants.h"

namespace coppice {

namespace {

constexpr double longest_run = 3600;  // fleet seconds
constexpr double radius = 5;          // metres, of robots on random maps
// Metres from obstacles, in addition to the radius, where starts and goals are drawn.
constexpr double spare = 1;
constexpr double max_speed = 20;
constexpr double longest_cut = 50;  // seconds; a robot that is cut off alone for 60 s counts as failed
// Seconds. Two robots that do not reach each other stay safe for any time if other robots that reach both are
// alive. After 120 s they give up.
constexpr double longest_cut_of_a_link = 110;
constexpr std::size_t robots_a_cut_link = 4;

/// A random kind of the scenarios that test coordination, or a random map with random tasks.
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
  for (const auto& [start, goal] :
       random_tasks(ClearanceField(scenario.map), robots, radius, 0.1, random, spare)) {
    scenario.robots.push_back(
        {fmt::format("r{}", scenario.robots.size() + 1), start, goal, radius, max_speed, 2 * max_speed, 1});
  }
  return scenario;
}

/// Draws each kind of fault in about half of the cases.
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
  if (random.uniform() < 0.3) {
    const double from = random.uniform(0, 20);
    faults.bus.partitions.push_back({from, from + random.uniform(0.5, longest_cut)});
  }
  return faults;
}

/// A robot that is alone on its side of a partition and fails there may be anywhere (docs/safety.md, A6). So
/// it fails later; in a small fleet, where those on its side may be down, in any case.
void postpone_lonely_kills(const Scenario& scenario, Faults& faults) {
  if (faults.bus.partitions.empty()) return;
  const Partition& cut = faults.bus.partitions.back();
  const std::vector<AgentFaults> drawn = draw_faults(faults, scenario, longest_run);
  for (Faults::Kill& kill : faults.kills) {
    const auto victim = std::ranges::find(scenario.robots, kill.robot, &RobotTask::name);
    const int side = drawn[static_cast<std::size_t>(victim - scenario.robots.begin())].side;
    const bool is_alone = std::ranges::count(drawn, side, &AgentFaults::side) == 1;
    if (kill.time > cut.from && (is_alone || drawn.size() < 10)) kill.time += cut.until;
  }
}

/// Draws cut links between robots; no robot has two of them.
std::vector<CutLink> draw_cut_links(const Scenario& scenario, const Faults& faults, Random& random) {
  const std::size_t robots = scenario.robots.size();
  const bool others_may_all_be_dead = faults.kill_rate > 0 && robots < 10;
  std::vector<CutLink> links;
  if (random.uniform() < 0.7 || !faults.bus.partitions.empty() || others_may_all_be_dead) return links;
  const std::size_t first = random.index(robots);
  const std::size_t count = robots < robots_a_cut_link ? 0 : 1 + random.index(robots / robots_a_cut_link);
  for (std::size_t k = 0; k < count; ++k) {
    const double from = random.uniform() < 0.5 ? 0 : random.uniform(0, 40);
    links.push_back({scenario.robots[(first + k) % robots].name,
                     scenario.robots[(first + k + robots / 2) % robots].name, from,
                     from + random.uniform(1, longest_cut_of_a_link)});
  }
  return links;
}

std::string in_words(const Scenario& scenario, const Faults& faults) {
  std::string text = fmt::format(
      "{} {}, loss {:.2f}, delay {:.3f} +- {:.3f} s, duplicates {:.2f}{}, "
      "pauses {:.0f}/h of {:.2f} s, clocks +- {:.2f} s",
      scenario.robots.size(), scenario.map_name, faults.bus.loss, faults.bus.delay, faults.bus.jitter,
      faults.bus.duplicate, faults.bus.reorder ? ", reordered" : "", faults.pause_rate, faults.pause,
      faults.clock_skew);
  if (faults.kill_rate > 0)
    text += fmt::format(", {:.0f} kills/h, restarted {:.2f} s later", faults.kill_rate, faults.restart_after);
  for (const Partition& cut : faults.bus.partitions)
    text += fmt::format(", in two pieces from {:.2f} to {:.2f} s", cut.from, cut.until);
  for (const CutLink& cut : faults.bus.cut_links)
    text += fmt::format(", {} and {} cut off from each other from {:.2f} to {:.2f} s", cut.a, cut.b, cut.from,
                        cut.until);
  for (const Faults::Kill& kill : faults.kills)
    text += fmt::format(", {} killed at {:.2f} s", kill.robot, kill.time);
  return text;
}

/// The robots' tasks from their final positions: failed robots do not move, and robots that arrived are at
/// their goals.
std::vector<JointTask> ends_of(const std::vector<NamedTrack>& tracks, const FleetSimulation& simulation) {
  std::vector<JointTask> ends;
  for (const NamedTrack& track : tracks) {
    const RobotTask& task = simulation.service().task(track.robot);
    const auto& points = track.track.points;
    // No points: killed before it had a body.
    const Point2 end = points.empty() ? task.start : points.back().position;
    const bool killed = simulation.killed(track.robot);
    ends.push_back({end, killed ? std::nullopt : std::optional(task.goal), task.radius, !killed});
  }
  return ends;
}

/// Whether a living robot could have arrived from its position, past the failed robots.
bool could_arrive(const ClearanceField& field, const JointTask& robot, std::span<const JointTask> ends) {
  std::vector<Disc> failed;
  for (const JointTask& end : ends) {
    if (!end.movable) failed.push_back({end.position, end.radius});
  }
  // A gap that only a finer lattice finds is too narrow to count.
  RouteFinder finder(field, robot.radius, usual_spacing(robot.radius) / 2);
  return !finder.route(robot.position, *robot.goal, failed).empty();
}

/// Whether each robot could have arrived, with other living robots in its way as well. Failed robots may
/// close the only place where two robots could have exchanged their order.
std::vector<bool> could_be_sorted_out(const ClearanceField& field, const std::vector<JointTask>& ends) {
  MapRoadmaps places(field);
  JointPlanner planner(places, ends, Random(1));
  while (!planner.step()) {
  }
  std::vector<bool> could(ends.size(), true);
  for (const std::size_t i : planner.plan().stranded) could[i] = false;
  return could;
}

/// Differential robots, some of which have a yaw at their goal. They take up as much room as before.
void draw_turning(Scenario& scenario, Random& random) {
  for (RobotTask& robot : scenario.robots) {
    robot.max_angular_speed = robot.max_speed / robot.radius * random.uniform(0.3, 1.5);
    robot.max_angular_acceleration = robot.max_angular_speed * random.uniform(1, 20);
    robot.radius -= off_the_chord(limits_of(robot), control_period);
    robot.start_yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
    if (random.uniform() < 0.5) continue;
    robot.goal_yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
    robot.goal_yaw_tolerance = default_yaw_tolerance;
  }
}

}  // namespace

FuzzCase draw_fuzz_case(std::uint32_t seed, bool restarts, bool turning) {
  Random random(seed);
  Scenario scenario = draw_scenario(seed, random);
  Random of_turning(seed + 3);
  if (turning) draw_turning(scenario, of_turning);
  Faults faults = draw_kinds_of_faults(scenario, random);
  if (restarts) {
    Random of_restarts(seed + 1);  // a source of its own, so that the other faults of the seed stay the same
    // One restart in the fleet every 10 to 60 s. If restarts were more frequent than joint plans take, no run
    // would end.
    faults.kill_rate = of_restarts.uniform(60, 360) / static_cast<double>(scenario.robots.size());
    faults.restart_after = of_restarts.uniform(0.1, 8);
    for (Faults::Kill& kill : faults.kills) kill.for_good = true;
  }
  postpone_lonely_kills(scenario, faults);
  Random of_links(seed + 2);
  faults.bus.cut_links = draw_cut_links(scenario, faults, of_links);
  const double lifelong = random.uniform() < 0.2 ? 300 : 0;
  std::string what = in_words(scenario, faults);
  if (turning) what += ", differential";
  if (lifelong > 0) what += fmt::format(", new goals for {:.0f} s", lifelong);
  // The search for shorter paths takes most of a simulation's time and has little to do with faults.
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
  const std::vector<NamedTrack>& tracks = simulation.tracks();
  FuzzResult result{.failures = broken_invariants(fuzz_case.scenario, tracks, control_period),
                    .suffered = simulation.suffered()};
  if (result.suffered.rejected > 0)
    result.failures.push_back(fmt::format("{} messages that no reader takes", result.suffered.rejected));
  for (const NamedTrack& track : tracks)
    result.robot_hours += static_cast<double>(track.track.points.size()) * control_period / 3600;
  const proto::Report report = simulation.service().report(in_parts(tracks));
  const std::vector<JointTask> ends = ends_of(tracks, simulation);
  const ClearanceField field(fuzz_case.scenario.map);
  const bool somebody_died = !std::ranges::all_of(ends, &JointTask::movable);
  std::optional<std::vector<bool>> sorted_out;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto& robot = report.robots(static_cast<int>(i));
    if (robot.arrived() || !ends[i].movable || !could_arrive(field, ends[i], ends)) continue;
    if (somebody_died && !sorted_out) sorted_out = could_be_sorted_out(field, ends);
    const bool shut_in = somebody_died && !(*sorted_out)[i];
    // What the robot knew of the failed robots was lost with its own process and with all others.
    const bool ignorant =
        somebody_died && simulation.suffered().restarts > 0 &&
        robot.reason().find("its agent was started or woke in mid-run, and") != std::string::npos;
    std::vector<std::string>& list = shut_in || ignorant ? result.shut_in : result.failures;
    list.push_back(fmt::format("{} is stuck: {}", robot.name(), robot.reason()));
  }
  return result;
}

}  // namespace coppice
