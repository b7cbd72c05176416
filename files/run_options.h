// The options that `coppice run`, `plan`, `simulate` and the planner service share, and the files that they
// ask for.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "files/picture.h"
#include "files/scenario_file.h"
#include "files/trajectory_file.h"
#include "planning/planner_kind.h"
#include "report.pb.h"

namespace CLI {
class App;
}  // namespace CLI

namespace coppice {

struct RunOptions {
  std::string scenario;
  ScenarioOptions overrides;
  std::optional<double>
      time_scale;  ///< fleet seconds a wall second; none: real time, or as the command chooses
  double timeout = 3600;
  double lifelong = 0;  ///< fleet seconds in which robots that arrive get new goals
  std::string planner{planner_names[0]};
  std::optional<double> plan_budget;  ///< wall seconds for shorter paths after the first ones
  std::string report;                 ///< empty: not written
  std::string trajectory;
  std::string picture;
  bool quiet = false;  ///< neither progress nor the report is printed
};

/// How a command goes about a run: the defaults depend on it.
enum class Progression : unsigned char { paths_only, virtual_clock, one_process, many_processes };

/// Adds the options to a command, and what the table means that it prints; values out of range are usage
/// errors.
void add_run_options(CLI::App& command, RunOptions& options, Progression progression);

/// Of `run`, `simulate` and the service, wall seconds; `plan` goes on until nothing shorter turns up.
inline constexpr double default_plan_budget = 1;

PlannerKind chosen_planner(const RunOptions& options);

/// Throws InputError if one file is to be two of these, or is the scenario's, its map's or the recording's.
void check_results(const RunOptions& options, const Scenario& scenario, const std::string& recording = {});

/// Writes the files that were asked for; `picture()` makes the content of one. Throws InputError, which names
/// them all, if some cannot be written; the others are.
void write_results(const RunOptions& options, const proto::Report& report, const TrackParts& tracks,
                   const std::function<PictureContent()>& picture);

}  // namespace coppice
