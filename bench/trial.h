// What every experiment shares: maps and tasks by seed, planners that are timed alike, and what is measured.
//
// Seconds of the machine's clock, metres. The clearance field is made before the clock starts: all planners
// have the same one.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "planning/clearance_field.h"
#include "planning/fleet_plan.h"
#include "planning/map_generator.h"

namespace coppice {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// One map with tasks for a fleet.
struct TrialCase {
  std::string map;  ///< kind, or name of the file
  std::uint64_t seed = 0;
  OccupancyMap occupancy;
  ClearanceField field;
  std::vector<PlanningProblem> problems;
};

/// What a table calls a map: its kind, or its file's name.
std::string map_title(const std::string& map);

/// A map of a kind that the seed makes, or that of a file, and tasks for so many robots on it. Throws
/// InputError for a bad name or file, std::invalid_argument where there is no room for so many robots.
TrialCase make_case(const std::string& map, int side, int robots, double radius, std::uint64_t seed);

struct TrialResult {
  std::string planner;
  double first_seconds = 0;           ///< until the last first path
  double simplified_seconds = 0;      ///< first_seconds and the planner's own simplification
  std::vector<double> first_lengths;  ///< of each robot; 0: no path
  std::vector<double> lengths;        ///< after simplification
  std::uint64_t valid_nodes = 0;
  std::uint64_t invalid_nodes = 0;
  /// Sum of the lengths over time, for planners that go on improving.
  struct Progress {
    double seconds;
    double length;
  };
  std::vector<Progress> progress;

  int solved() const;
};

/// Goes on after the first paths until nothing shorter turns up.
TrialResult run_ma_rrdt_star(const TrialCase& trial, std::uint64_t seed);
/// MA-RRT*: each robot its own RRT*, given up after so many samples.
TrialResult run_ma_rrt_star(const TrialCase& trial, std::uint64_t seed, std::uint64_t most_samples);
TrialResult run_grid_a_star(const TrialCase& trial);

/// OMPL's planners by name: RRTConnect, BiEST, RRTstar, BITstar; each robot gets `cap` seconds.
bool built_with_ompl();
TrialResult run_ompl(const std::string& planner, const TrialCase& trial, std::uint64_t seed, double cap);

/// The sum over robots of the shortest length that any of the results has; robots without any do not count.
double shortest_known(const std::vector<TrialResult>& results);

}  // namespace coppice
