// The experiments of `coppice bench`: each writes NAME.csv (every trial), NAME.md (medians) and NAME.svg.
//
// A map that fails (there is no room for so many robots, say) is told and left out from there on; the others
// go on, and what was measured before is kept. Throws InputError for bad options or files that cannot be
// written.
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
  std::optional<int> maze_seeds;  ///< of the paper's experiment on the maze, where MA-RRT* takes long
  int seeds_on(const std::string& map) const { return map == "maze" ? maze_seeds.value_or(seeds) : seeds; }
  std::uint64_t first_seed = 1;
  int side = 512;     ///< cells
  double radius = 5;  ///< metres
  double cap = 0.2;   ///< seconds a robot and peer
  std::string output = ".";
  std::function<bool()> stop = [] { return false; };
  std::function<void(const std::string&)> tell = [](const std::string&) {};  ///< progress, a line each
  std::function<void(const std::string&)> fail = [](const std::string&) {};  ///< what failed, a line each
};

/// Runs `trial`. False if it throws: then `fail` is told so, with the map and the number of robots.
bool succeeds(const ExperimentOptions& options, const std::string& map, int robots,
              const std::function<void()>& trial);

/// MA-RRdT* against OMPL's planners and grid A*, in one process and in turn.
void bench_peers(const ExperimentOptions& options);

/// The paper's experiment: MA-RRdT* against MA-RRT*, by the number of robots.
void bench_paper(const ExperimentOptions& options);

/// Ten missions on one map, one after the other: what the forest of the earlier ones saves the later ones.
void bench_lifelong(const ExperimentOptions& options);

/// Whole fleets in the simulation against reciprocal velocity obstacles alone, on the same paths.
void bench_avoidance(const ExperimentOptions& options);

}  // namespace coppice
