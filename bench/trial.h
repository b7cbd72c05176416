// Common to all experiments: maps and tasks by seed, planners with the same timing, and their results.
//
// Seconds of the machine's clock, metres. The clearance field is built before the clock starts, because all
// planners share it.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/map_generator.h"
#include "planning/trees/fleet_plan.h"

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
  std::vector<PlanningProblem> second;  ///< other tasks on the same map, for a fleet that has done the first
};

/// The name of a map in tables: its kind, or its file's name.
std::string map_title(const std::string& map);

/// Makes a map of a kind from the seed, or reads it from a file, and draws tasks for `robots` robots. Throws
/// InputError for a bad name or file, and std::invalid_argument if there is no room for so many robots.
TrialCase make_case(const std::string& map, int side, int robots, double radius, std::uint64_t seed);

struct TrialResult {
  std::string planner;
  double first_seconds = 0;       ///< until the last first path
  double simplified_seconds = 0;  ///< with the planner's own simplification
  /// Until the last first path of the second tasks, with all that the planner keeps, when it does them for
  /// the second time; below 0: not measured.
  double second_seconds = -1;
  std::vector<double> first_lengths;  ///< of each robot; 0: no path
  std::vector<double> lengths;        ///< after simplification
  std::uint64_t valid_nodes = 0;
  std::uint64_t invalid_nodes = 0;
  /// Sum of the lengths over time, for planners that improve their paths.
  struct Progress {
    double seconds;
    double length;
  };
  std::vector<Progress> progress;

  int solved() const;
};

enum class Improvement : unsigned char { until_taut, to_the_end };

/// Improves the first paths until they are taut, or until no shorter ones are found. Then the trees serve the
/// second tasks. Paths that are only to be taut have no second tasks. Robots without a path after
/// `longest_search` seconds get none.
TrialResult run_ma_rrdt_star(const TrialCase& trial, std::uint64_t seed, const TreeParameters& trees = {},
                             Improvement improvement = Improvement::to_the_end,
                             double longest_search = std::numeric_limits<double>::infinity());
/// MA-RRT*: a separate RRT* for each robot, which gives up after `longest_search` seconds.
TrialResult run_ma_rrt_star(const TrialCase& trial, std::uint64_t seed, double longest_search);
TrialResult run_grid_a_star(const TrialCase& trial);
/// Jump point search on the same grid.
TrialResult run_jump_point_search(const TrialCase& trial);
/// Shortest paths at any angle. The first search prepares the map.
TrialResult run_visibility_graph(const TrialCase& trial);

/// OMPL's planners by name: RRTConnect, BiEST, RRTstar, BITstar. Each robot gets `cap` seconds.
bool built_with_ompl();
TrialResult run_ompl(const std::string& planner, const TrialCase& trial, std::uint64_t seed, double cap);

/// The sum over robots of the shortest length in any result. Robots without a path do not count.
double shortest_known(const std::vector<TrialResult>& results);

}  // namespace coppice
