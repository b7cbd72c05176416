#include "bench/trial.h"

#include <algorithm>
#include <filesystem>

#include "bench/grid_a_star.h"
#include "bench/jump_point_search.h"
#include "bench/visibility_graph.h"
#include "coppice/files/map_file.h"
#include "planning/geometry/path_shortening.h"
#include "planning/trees/rrt_star.h"
#include "planning/trees/suggestions.h"

namespace coppice {

namespace {

constexpr double least_way = 0.4;  // of the map's diagonal: least distance from each start to its goal

std::vector<double> lengths_of(const FleetPlanner& planner, std::size_t robots) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i < robots; ++i) lengths.push_back(length_of(planner.path(i)));
  return lengths;
}

/// The first time finds cold caches, and a graph without the edges that it needs.
template <class Fn>
double seconds_of_second_time(Fn&& plan) {
  plan();
  const Stopwatch watch;
  plan();
  return watch.seconds();
}

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double v : values) total += v;
  return total;
}

}  // namespace

std::string map_title(const std::string& map) {
  return std::filesystem::path(map).stem().string();
}

TrialCase make_case(const std::string& map, int side, int robots, double radius, std::uint64_t seed) {
  Random random(seed);
  OccupancyMap occupancy = read_or_generate_map(map, side, side, random);
  ClearanceField field(occupancy);
  std::vector<PlanningProblem> problems;
  const double way = map == "blank" || robots <= 20 ? least_way : 0.2;
  std::vector<PlanningProblem> second;
  for (std::vector<PlanningProblem>* const tasks : {&problems, &second}) {
    for (const auto& [start, goal] : random_tasks(field, robots, radius, way, random))
      tasks->push_back({start, goal, radius});
  }
  return {map_title(map),   seed, std::move(occupancy), std::move(field), std::move(problems),
          std::move(second)};
}

int TrialResult::solved() const {
  return static_cast<int>(std::ranges::count_if(first_lengths, [](double length) { return length > 0; }));
}

TrialResult run_ma_rrdt_star(const TrialCase& trial, std::uint64_t seed, const TreeParameters& trees,
                             Improvement improvement, double longest_search) {
  TrialResult result{.planner = "MA-RRdT*"};
  const std::size_t robots = trial.problems.size();
  const Stopwatch watch;
  FleetPlanner planner(trial.field, trial.problems, trees, Random(seed));
  while (planner.search() && watch.seconds() < longest_search) {
  }
  planner.take_first_paths();
  result.first_seconds = watch.seconds();
  result.first_lengths = lengths_of(planner, robots);
  double own = 0;  // time for measuring, which is not the planner's
  bool improving = true;
  while (improving) {
    improving = planner.improve() && !(improvement == Improvement::until_taut && planner.all_taut());
    const double now = watch.seconds();
    if (planner.all_taut() && result.simplified_seconds == 0) {
      result.simplified_seconds = now - own;
      result.lengths = lengths_of(planner, robots);
    }
    result.progress.push_back({now - own, sum(lengths_of(planner, robots))});
    own += watch.seconds() - now;
  }
  result.lengths = lengths_of(planner, robots);
  for (std::size_t i = 0; i < robots; ++i) {
    result.valid_nodes += planner.counts(i).valid;
    result.invalid_nodes += planner.counts(i).invalid;
  }
  result.valid_nodes += planner.disjointed_counts().valid;
  result.invalid_nodes += planner.disjointed_counts().invalid;
  if (improvement == Improvement::until_taut) return result;
  result.second_seconds = seconds_of_second_time([&] {
    planner.begin_mission(trial.second);
    while (planner.search()) {
    }
    planner.take_first_paths();
  });
  return result;
}

TrialResult run_ma_rrt_star(const TrialCase& trial, std::uint64_t seed, double longest_search) {
  TrialResult result{.planner = "MA-RRT*"};
  for (std::size_t i = 0; i < trial.problems.size(); ++i) {
    const PlanningProblem& p = trial.problems[i];
    const Stopwatch watch;
    RrtStar<ClearanceField> planner(trial.field, p.start, p.goal, p.radius,
                                    suggested_epsilon(trial.field, p.radius), Random(seed + 1000 * i));
    while (watch.seconds() < longest_search && planner.step()) {
    }
    Path path = planner.path();
    result.first_lengths.push_back(length_of(path));
    const double first = watch.seconds();
    result.first_seconds += first;
    path = optimise_line_of_sight(trial.field, path, p.radius);
    result.simplified_seconds += watch.seconds();
    result.lengths.push_back(length_of(path));
    result.valid_nodes += planner.valid();
    result.invalid_nodes += planner.invalid();
  }
  return result;
}

namespace {

template <class Planner>
TrialResult run_on_grid(const std::string& name, const TrialCase& trial) {
  TrialResult result{.planner = name};
  Planner planner(trial.field);
  for (const PlanningProblem& p : trial.problems) {
    const Stopwatch watch;
    Path path = planner.path(p.start, p.goal, p.radius);
    result.first_lengths.push_back(length_of(path));
    result.first_seconds += watch.seconds();
    path = shorten(trial.field, std::move(path), p.radius);
    result.simplified_seconds += watch.seconds();
    result.lengths.push_back(length_of(path));
  }
  result.valid_nodes = planner.expanded();
  return result;
}

}  // namespace

TrialResult run_grid_a_star(const TrialCase& trial) {
  return run_on_grid<GridAStar>("grid A*", trial);
}

TrialResult run_visibility_graph(const TrialCase& trial) {
  TrialResult result{.planner = "visibility graph"};
  std::vector<Path> paths(trial.problems.size());
  const Stopwatch watch;
  VisibilityGraph planner(trial.occupancy, trial.field);
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const PlanningProblem& p = trial.problems[k];
    paths[k] = planner.path(p.start, p.goal, p.radius);
  }
  result.first_seconds = result.simplified_seconds = watch.seconds();
  for (const Path& path : paths) result.first_lengths.push_back(length_of(path));
  result.lengths = result.first_lengths;
  result.valid_nodes = planner.expanded();
  paths.resize(trial.second.size());
  result.second_seconds = seconds_of_second_time([&] {
    for (std::size_t k = 0; k < paths.size(); ++k) {
      const PlanningProblem& p = trial.second[k];
      paths[k] = planner.path(p.start, p.goal, p.radius);
    }
  });
  return result;
}

TrialResult run_jump_point_search(const TrialCase& trial) {
  return run_on_grid<JumpPointSearch>("jump points", trial);
}

double shortest_known(const std::vector<TrialResult>& results) {
  double total = 0;
  for (std::size_t i = 0; i < results.front().lengths.size(); ++i) {
    double least = 0;
    for (const TrialResult& result : results) {
      if (result.lengths[i] > 0 && (least == 0 || result.lengths[i] < least)) least = result.lengths[i];
    }
    total += least;
  }
  return total;
}

}  // namespace coppice
