// The options that `coppice run`, `plan`, `simulate` and the planner service share, and the output files that
// these options name.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "coppice/files/scenario_file.h"
#include "coppice/motion/coordination.h"
#include "coppice/motion/trajectory.h"
#include "coppice/planning/planner_kind.h"
#include "coppice/planning/tree_parameters.h"
#include "files/picture.h"
#include "files/trajectory_file.h"
#include "report.pb.h"

namespace CLI {
class App;
}  // namespace CLI

namespace coppice {

struct RunOptions {
  std::string scenario;
  ScenarioOptions overrides;
  std::optional<double> time_scale;  ///< fleet seconds per wall second; none: 1, or the command's choice
  double timeout = 3600;
  double lifelong = 0;  ///< fleet seconds in which robots that arrive get new goals
  std::string planner{planner_names[0]};
  std::string forest{forest_names[0]};
  std::string restarts{restarts_names[0]};
  std::string coordination{coordination_names[0]};
  std::optional<std::string> rounds;  ///< none: nothing is said of coordination rounds
  TreeParameters trees{};             ///< chosen_trees() adds the restarts
  /// Wall seconds for shorter paths after the first ones; none: the command's default.
  std::optional<double> plan_budget;
  std::string plan;    ///< file of a joint plan that was made elsewhere; empty: none
  std::string report;  ///< name of the file; empty: not written
  std::string trajectory;
  std::string picture;
  bool serves = false;  ///< waits for orders when all robots have arrived, until it is stopped
  bool quiet = false;   ///< neither progress nor the report is printed
};

/// How a command carries out a run. Default values depend on it.
enum class Progression : unsigned char { paths_only, virtual_clock, one_process, many_processes, standing };

/// Adds the options, and the explanation of the terms of the table, to a command. Values out of range are
/// usage errors.
void add_run_options(CLI::App& command, RunOptions& options, Progression progression);

/// How to read the scenario. Robots that carry out a given plan keep no margin unless --margin says so: the
/// plan says how close they come.
ScenarioOptions scenario_options(const RunOptions& options);

/// Default of `run`, `simulate` and the service, wall seconds. `plan` continues until it finds no shorter
/// path.
inline constexpr double default_plan_budget = 1;

/// The joint plan; empty: none was named. Throws InputError if it is not one of this scenario, or if the
/// robots are to make no reservations.
std::vector<Trajectory> chosen_plan(const RunOptions& options, const Scenario& scenario);
PlannerKind chosen_planner(const RunOptions& options);
ForestStart chosen_forest(const RunOptions& options);
TreeParameters chosen_trees(const RunOptions& options);
/// Throws InputError if something is said of rounds that does not go with it.
Coordination chosen_coordination(const RunOptions& options);

/// Throws InputError if two output files are the same file, or if one is the scenario, its map or the
/// recording.
void check_results(const RunOptions& options, const Scenario& scenario, const std::string& recording = {});

/// Writes the requested files. `picture()` makes the content of the picture. If some files cannot be written,
/// the others are written all the same, and InputError names all failures.
void write_results(const RunOptions& options, const proto::Report& report, const TrackParts& tracks,
                   const std::function<PictureContent()>& picture);

}  // namespace coppice
