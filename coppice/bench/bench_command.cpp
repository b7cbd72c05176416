#include <iostream>

#include "bench/experiments.h"
#include "coppice/bench/scale_bench.h"
#include "coppice/bench/sharing_bench.h"
#include "coppice/commands.h"
#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "coppice/planning/map_generator.h"
#include "runtime/process.h"

namespace coppice {

int bench_command(const BenchOptions& options, const std::string& program) {
  install_stop_signals();
  ExperimentOptions experiment{.output = options.output};
  experiment.stop = [] { return stop_requested(); };
  experiment.tell = [](const std::string& line) { std::cout << line << std::endl; };
  bool failed = false;
  experiment.fail = [&](const std::string& line) {
    failed = true;
    std::cerr << options.experiment << ": " << line << std::endl;
  };
  if (options.experiment == "paper") {
    experiment.robots = {2, 5, 10, 20, 50};
    experiment.maze_seeds = 3;
  }
  if (options.experiment == "lifelong") {
    experiment.maps = {"maze", "room"};
    experiment.robots = {10};
  }
  if (options.experiment == "avoidance") {
    experiment.maps = {"blank", "dense", "room"};
    experiment.robots = {2, 5, 10, 20};
  }
  if (options.experiment == "throughput") {
    experiment.maps.clear();
    experiment.seeds = 1;
    if (options.scenarios.empty())
      throw InputError("bench throughput: --scenarios is missing, expected scenario files");
  }
  if (options.experiment == "sharing") {
    experiment.maps = {"maze", "room"};
    experiment.robots = {2, 5, 10, 20};
    experiment.seeds = 5;
  }
  if (options.experiment == "scale") {
    experiment.maps = {"room"};
    experiment.robots = {10, 20, 50, 100, 200};
  }
  if (options.quick) {
    experiment.seeds = 3;
    experiment.maze_seeds = 1;
    if (options.experiment == "paper") experiment.robots = {2, 10};
    if (options.experiment == "peers") experiment.robots = {10};
    if (options.experiment == "sharing") experiment.robots = {5};
    if (options.experiment == "scale") experiment.robots = {4};
  }
  if (!options.maps.empty()) experiment.maps = options.maps;
  for (const std::string& map : experiment.maps) {
    if (!map_kind(map)) read_map(map);  // reports a bad map now and not after hours of measuring
  }
  if (options.radius) experiment.radius = *options.radius;
  if (!options.robots.empty()) experiment.robots = options.robots;
  if (options.seeds) {
    experiment.seeds = *options.seeds;
    experiment.maze_seeds.reset();
  }
  experiment.first_seed = options.first_seed;
  if (options.experiment == "paper") bench_paper(experiment);
  if (options.experiment == "peers") bench_peers(experiment);
  if (options.experiment == "lifelong") bench_lifelong(experiment);
  if (options.experiment == "avoidance") bench_avoidance(experiment);
  if (options.experiment == "sharing") bench_sharing(experiment, program);
  ScaleSettings scale{.time_scale = options.time_scale,
                      .discovery = options.discovery,
                      .security = options.security,
                      .report = options.report};
  if (options.quick) scale.fleet_seconds = 5;
  bool all_well = true;
  if (options.experiment == "scale") all_well = bench_scale(experiment, scale, program);
  if (options.experiment == "throughput")
    all_well = bench_throughput(experiment, {.scenarios = options.scenarios,
                                             .radius = options.radius,
                                             .max_speed = options.max_speed,
                                             .lifelong = options.lifelong,
                                             .references = options.references});
  return failed ? 2 : all_well ? 0 : 1;
}

}  // namespace coppice
