// The subcommands of `coppice`. Each returns the exit code: 0 success, 1 not every robot arrived (for plan:
// has a path). Invalid input throws InputError.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "coppice/files/plan_file.h"
#include "coppice/run/diagnosis.h"
#include "coppice/simulation/faults.h"
#include "dds/dds_bus.h"
#include "files/run_options.h"
#include "monitor/server/web_server.h"
#include "runtime/process_options.h"

namespace coppice {

/// A command with its options. Returns the exit code.
using ChosenCommand = std::function<int()>;

/// A recording to be made during a command.
struct NewRecording {
  std::string file;    ///< empty: none
  bool force = false;  ///< replaces an existing file
};

struct FleetOptions {
  std::optional<int> domain;  ///< none: an unused one
  std::string discovery;      ///< as in dds/dds_bus.h
  std::string security;       ///< folder with a folder of credentials for each role; empty: no security
  /// Folder for the state that processes leave to their successors; empty: see `restart`, and
  /// coppice/run/state_folder.h for standing fleets.
  std::string state;
  std::string start_at;  ///< file of poses where the robots of a standing fleet begin; empty: none
  bool standby = false;  ///< starts a second broker, which takes over if the first one fails
  /// Restarts processes that end early; an empty `state` then means a folder of the run.
  bool restart = false;
  bool watch = false;  ///< also starts a monitor and opens its page in a browser
  LogOptions log;      ///< for all processes
  /// Folder for the logs of processes that do not write to the terminal; empty: logs are not kept.
  std::string logs;
  NewRecording record;
  RosOptions ros;
};

/// Runs a fleet of processes over DDS on this machine. `program` is this executable, beside the roles'
/// programs.
int run_command(RunOptions options, const FleetOptions& fleet, const std::string& program);

struct StateOptions {
  std::string folder;     ///< of --state
  bool discards = false;  ///< removes damaged records, and keeps a copy of the damaged file
};

/// Lists the journals of a fleet's state. Exit code 1: some are damaged.
int state_command(const StateOptions& options);

struct InspectOptions {
  std::string file;  ///< a journal
};

/// Prints each record of a journal as a line of JSON. Exit code 1: some are damaged.
int inspect_command(const InspectOptions& options);

struct DiscoveryOptions {
  std::string address = "0.0.0.0";  ///< of this host, as clients are told it; 0.0.0.0: all addresses
  std::uint16_t port = 11811;
  int place = 0;      ///< position in the fleet's list of servers
  std::string alive;  ///< file that is touched every second; empty: none
  LogOptions log;
};

/// Runs a discovery server until it is stopped.
int discovery_command(const DiscoveryOptions& options);

struct RecordOptions {
  std::string file;
  DdsSettings network;
  std::optional<double> duration;  ///< seconds; none: until it is stopped
  bool force = false;              ///< replaces an existing file
  LogOptions log;
};

/// Records a fleet's messages in a file (monitor/recording/recording.h).
int record_command(const RecordOptions& options);

/// Describes a recording, and tells whether it is complete.
int info_command(const std::string& file);

struct ExplainOptions {
  std::string recording;
  std::string robot;
  std::optional<double> time{};  ///< fleet seconds; none: the whole recording
};

/// Says in sentences what a robot of a recording did, and why.
int explain_command(const ExplainOptions& options);

struct ReplayOptions {
  std::string file;
  DdsSettings network;
  double speed = 1;  ///< recorded seconds per second
  double from = 0;   ///< seconds after the recording's beginning
};

/// Replays a recording on a bus without a fleet, to observers and viewers.
int replay_command(const ReplayOptions& options);

struct MonitorOptions {
  DdsSettings network;
  std::string recording;  ///< shows this file; empty: shows a live fleet
  WebSettings web;
  bool open = false;       ///< opens a browser, too
  bool control = false;    ///< takes orders over HTTP
  std::string token_file;  ///< with the token that clients must show for that
  LogOptions log;
};

/// Shows a live fleet or a recording to pages, Foxglove and Prometheus, until it is stopped.
int monitor_command(const MonitorOptions& options);

struct TopOptions {
  DdsSettings network;
  std::string order = "name";  ///< order of the robots (monitor/view/fleet_table.h)
  bool once = false;           ///< prints the table once instead of showing it continuously
};

/// Shows a fleet as a table in the terminal. Returns 1 if no robot was heard.
int top_command(const TopOptions& options);

struct PictureOptions {
  std::string recording;
  std::string output;            ///< .svg or .png; for a movie .gif, .webm or .mp4
  std::optional<double> time{};  ///< fleet seconds; none: the last moment
  bool movie = false;
  std::optional<double> from{};   ///< first time of a movie, fleet seconds; none: the beginning
  std::optional<double> until{};  ///< last time of a movie, fleet seconds; none: the end
  double frame_rate = 10;         ///< frames per second
  double speed = 1;               ///< fleet seconds per second
  bool quiet = false;
};

/// Draws a fleet from a recording.
int picture_command(const PictureOptions& options);

/// Checks whether this machine has what a fleet needs, and says what to change. Returns 1 if something is
/// missing.
int doctor_command(const FleetPlan& plan);

/// Runs all roles in this process, on a virtual clock, with faults. Returns 1 also after a collision.
int simulate_command(const RunOptions& options, const Faults& faults, const NewRecording& record);

/// The joint plan on the cells of the map that `coppice plan` writes beside the paths.
struct GridPlanOptions {
  std::string file;  ///< empty: none
  std::string form{grid_plan_forms[0]};
};

/// Runs Algorithm 2 in this process: paths only, no bus and no motion.
int plan_command(const RunOptions& options, const GridPlanOptions& grid_plan);

struct MapOptions {
  std::string kind;           ///< kind of map or scenario, or a map file
  std::optional<int> width;   ///< cells (512); only for generated maps
  std::optional<int> height;  ///< cells (512); only for generated maps
  std::uint32_t seed = 1;
  std::optional<int> robots;        ///< none: the number that suits the kind
  std::optional<double> radius;     ///< metres (5 cells); not for kinds of scenario
  std::optional<double> max_speed;  ///< metres per second (20 cells per second); not for kinds of scenario
  std::string output;               ///< scenario (.json); the map is written beside it
};

/// Generates a map and a scenario on it.
int map_command(const MapOptions& options);

struct FuzzOptions {
  double robot_hours = 1;  ///< fleet time of all robots together; cases are drawn until then
  std::uint32_t first_seed = 1;
  bool restarts = false;                ///< also kills and restarts agents
  std::optional<std::uint32_t> replay;  ///< runs only the case of this seed, and writes its files
  RunOptions files;                     ///< files that a replay writes
  NewRecording record;                  ///< recording of a replay
};

/// Simulates scenarios and faults drawn from consecutive seeds (simulation/fuzz.h). Returns 1 if one failed.
int fuzz_command(const FuzzOptions& options);

struct BenchOptions {
  std::string experiment;         ///< paper, peers, lifelong, avoidance, throughput, sharing or scale
  bool quick = false;             ///< few seeds and robots, to see whether it still runs
  std::vector<std::string> maps;  ///< kinds or files
  std::vector<int> robots;
  std::optional<double> radius{};  ///< of the robots, metres; none: 5, or the scenario's
  std::optional<int> seeds;
  std::uint64_t first_seed = 1;
  std::string output = ".";
  /// For scale, fleet seconds per wall second; none: by the number of robots.
  std::optional<double> time_scale{};
  std::string discovery{};               ///< for scale, as in DdsSettings
  std::string security{};                ///< for scale, as in DdsSettings
  std::string report{};                  ///< for scale, JSON; empty: none
  std::vector<std::string> scenarios{};  ///< for throughput, files
  std::optional<double> max_speed{};     ///< for throughput, metres a second; none: the scenario's
  double lifelong = 0;                   ///< for throughput, as of coppice simulate
  std::string references{};              ///< for throughput, file; empty: none
};

/// Runs an experiment. Writes its table as CSV and Markdown, and its plots. `program` is this executable.
int bench_command(const BenchOptions& options, const std::string& program);

}  // namespace coppice
