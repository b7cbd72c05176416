// The experiments of `coppice bench`. Each writes NAME.csv (every trial), NAME.md (medians) and NAME.svg.
//
// A map that fails (for example without room for so many robots) is reported and left out from then on. The
// other maps continue, and earlier measurements are kept. Throws InputError for bad options, or if a file
// cannot be written.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace coppice {

struct ExperimentOptions {
  std::vector<std::string> maps{"blank", "dense", "maze", "room"};
  std::vector<int> robots{10, 50};
  int seeds = 20;
  std::optional<int> maze_seeds;  ///< for the paper's experiment on the maze, where MA-RRT* takes long
  int seeds_on(const std::string& map) const { return map == "maze" ? maze_seeds.value_or(seeds) : seeds; }
  std::uint64_t first_seed = 1;
  int side = 512;     ///< cells
  double radius = 5;  ///< metres
  double cap = 0.2;   ///< seconds per robot and planner
  std::string output = ".";
  std::function<bool()> stop = [] { return false; };
  std::function<void(const std::string&)> tell = [](const std::string&) {};  ///< progress, one line per call
  std::function<void(const std::string&)> fail = [](const std::string&) {};  ///< failures, one line per call
};

/// Runs `trial`. Returns false if it throws, and passes the reason to `fail` with the map and the number of
/// robots.
bool succeeds(const ExperimentOptions& options, const std::string& map, int robots,
              const std::function<void()>& trial);

/// MA-RRdT* against OMPL's planners and grid A*, in one process, one after the other.
void bench_peers(const ExperimentOptions& options);

/// The paper's experiment: MA-RRdT* against MA-RRT*, by number of robots.
void bench_paper(const ExperimentOptions& options);

/// Ten missions in a row on one map: how much the forest of earlier missions saves in later ones.
void bench_lifelong(const ExperimentOptions& options);

struct ThroughputSettings {
  std::vector<std::string> scenarios;  ///< files
  std::optional<double> radius{};      ///< of all robots, metres; none: the scenario's
  std::optional<double> max_speed{};   ///< of all robots, metres a second; none: the scenario's
  double lifelong = 0;                 ///< fleet seconds in which robots that arrive get new goals
  std::string references{};            ///< file of reference_figures.h; empty: none
};

/// Fleets in the simulation: how soon robots arrive, and what they wait for. Returns whether all robots
/// arrived and none touched anything.
bool bench_throughput(const ExperimentOptions& options, const ThroughputSettings& settings);

/// Fleets in the simulation, with reservations and by reciprocal velocity obstacles, with and without
/// coordination rounds; and RVO alone on the same paths.
void bench_avoidance(const ExperimentOptions& options);

}  // namespace coppice
