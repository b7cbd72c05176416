#include "simulation/fuzz.h"

#include <algorithm>
#include <utility>

#include "coppice/files/plan_file.h"
#include "simulation/arrival_bound.h"
#include "simulation/fuzz_bodies.h"
#include "simulation/fuzz_faults.h"
#include "simulation/fuzz_halts.h"
#include "simulation/fuzz_random.h"
#include "simulation/fuzz_tasks.h"
#include "simulation/fuzz_words.h"

namespace coppice {

namespace {

// Fleet seconds. A run may take an hour, and then goes on until all should have arrived, ten hours at most.
constexpr double usual_run = 3600;
constexpr double longest_run = 10 * usual_run;
constexpr double between_looks = 60;
// Fleet seconds in which robots are likely to drive.
constexpr double shortest_driving = 10;
constexpr double longest_driving = 120;

/// What the run is asked for, apart from faults and halts. A further setting of the fleet is drawn here.
SimulationSettings draw_settings(std::uint32_t seed) {
  Random random = source_of(FuzzPart::run, seed);
  SimulationSettings settings{.timeout = longest_run};
  if (chance(0.25, random)) settings.lifelong = log_uniform(20, 300, random);
  // The search for shorter paths takes most of a simulation's time and has little to do with faults.
  if (chance(0.15, random)) settings.coordination = Coordination::rvo;
  settings.plan_budget = chance(0.15, random) ? 1 : chance(0.2, random) ? 0 : 0.05;
  return settings;
}

double time_of_driving(const Scenario& scenario, double lifelong) {
  double longest = lifelong;
  for (const RobotTask& robot : scenario.robots)
    longest = std::max(longest, free_flow_time((robot.goal - robot.start).norm(), limits_of(robot)));
  return std::clamp(longest, shortest_driving, longest_driving);
}

}  // namespace

FuzzCase draw_fuzz_case(std::uint32_t seed, bool restarts) {
  FuzzTasks tasks = draw_tasks(seed);
  Random of_drive = source_of(FuzzPart::drive, seed);
  const bool follow = chance(0.15, of_drive);
  draw_bodies(tasks.scenario, follow, seed);
  FuzzCase drawn{
      .seed = seed, .what = {}, .scenario = std::move(tasks.scenario), .settings = draw_settings(seed)};
  const Scenario& scenario = drawn.scenario;
  const double driving = time_of_driving(scenario, drawn.settings.lifelong);
  drawn.settings.faults = draw_faults_of_case(scenario, driving, restarts, seed);
  if (follow) drawn.settings.faults.drive = draw_drive_faults(scenario, of_drive);
  if (tasks.plan) {
    drawn.settings.plan = trajectories_of(*tasks.plan, scenario);
    drawn.settings.coordination = Coordination::reservations;
  }
  drawn.halts = draw_halts(scenario, driving, seed);
  drawn.what = in_words(drawn);
  return drawn;
}

void run_fuzz_case(const FuzzCase& fuzz_case, FleetSimulation& simulation,
                   const std::function<bool(const PlannerService&, double)>& watch) {
  auto next = fuzz_case.halts.begin();
  double next_look = usual_run;
  simulation.run([&](const PlannerService& service, double now) {
    for (; next != fuzz_case.halts.end() && next->time <= now; ++next) simulation.give(next->order);
    if (now > next_look) {
      if (now > arrival_bound(fuzz_case, simulation)) return false;
      next_look = now + between_looks;
    }
    return watch(service, now);
  });
}

}  // namespace coppice
