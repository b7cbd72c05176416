// The subcommands of `coppice`. Each returns the exit code: 0 all well, 1 not every robot arrived (for plan:
// has a path). Bad input throws InputError.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dds/dds_bus.h"
#include "runtime/process_options.h"
#include "coppice/diagnosis.h"
#include "files/run_options.h"
#include "monitor/web_server.h"
#include "simulation/faults.h"

namespace coppice {

/// A command with what it was told; returns its exit code.
using ChosenCommand = std::function<int()>;

/// A recording that is to be made besides.
struct NewRecording {
  std::string file;    ///< empty: none
  bool force = false;  ///< replaces what is there
};

struct FleetOptions {
  std::optional<int> domain;  ///< none: one of its own
  std::string discovery;      ///< as in dds/dds_bus.h
  std::string security;       ///< folder with a folder of credentials for each role; empty: none
  std::string state;          ///< folder for what processes keep for their successors; empty: see `restart`
  bool standby = false;       ///< a second broker, that takes over if the first is gone
  bool restart = false;       ///< who ends early is started again; `state` is then a folder of its own
  bool watch = false;         ///< a monitor, and its page in a browser, too
  LogOptions log;             ///< of all processes
  std::string logs;           ///< folder for those that are not on the terminal; empty: they are not kept
  NewRecording record;
  RosOptions ros;
};

/// A fleet of processes over DDS on this machine. `program` is this executable; the roles' lie beside it.
int run_command(RunOptions options, const FleetOptions& fleet, const std::string& program);

struct DiscoveryOptions {
  std::string address = "0.0.0.0";  ///< of this host that clients are told; 0.0.0.0: all that it has
  std::uint16_t port = 11811;
  int place = 0;      ///< in the list of servers that the fleet is given
  std::string alive;  ///< file that is touched every second; empty: none
  LogOptions log;
};

/// A discovery server, until it is told to stop.
int discovery_command(const DiscoveryOptions& options);

struct RecordOptions {
  std::string file;
  DdsSettings network;
  std::optional<double> duration;  ///< seconds; none: until it is told to stop
  bool force = false;              ///< replaces what is there
  LogOptions log;
};

/// Writes what a fleet says to a file (monitor/recording.h).
int record_command(const RecordOptions& options);

/// Says what a recording holds, and whether it is whole.
int info_command(const std::string& file);

struct ReplayOptions {
  std::string file;
  DdsSettings network;
  double speed = 1;  ///< recorded seconds a second
  double from = 0;   ///< seconds after its beginning
};

/// Says what a recording holds on a bus on which there is nobody else but those who look on.
int replay_command(const ReplayOptions& options);

struct MonitorOptions {
  DdsSettings network;
  std::string recording;  ///< shows that; empty: a fleet that drives
  WebSettings web;
  bool open = false;  ///< a browser, too
  LogOptions log;
};

/// Shows a fleet that drives, or a recording, to pages, Foxglove and Prometheus, until it is told to stop.
int monitor_command(const MonitorOptions& options);

struct TopOptions {
  DdsSettings network;
  std::string order = "name";  ///< of the robots (monitor/fleet_table.h)
  bool once = false;           ///< prints the table instead of showing it on and on
};

/// Shows a fleet as a table in the terminal. 1 if no robot was heard of.
int top_command(const TopOptions& options);

struct PictureOptions {
  std::string recording;
  std::string output;            ///< .svg or .png; of a movie .gif, .webm or .mp4
  std::optional<double> time{};  ///< fleet seconds; none: the last moment
  bool movie = false;
  std::optional<double> from{};   ///< of a movie, fleet seconds; none: the beginning
  std::optional<double> until{};  ///< likewise; none: the end
  double frame_rate = 10;         ///< frames a second
  double speed = 1;               ///< fleet seconds a second
  bool quiet = false;
};

/// Pictures of a fleet out of a recording.
int picture_command(const PictureOptions& options);

/// Says whether this machine has what a fleet needs, and what to change. 1 if something is missing.
int doctor_command(const FleetPlan& plan);

/// All roles in this process, on a virtual clock, with faults. 1 also if anything touched.
int simulate_command(const RunOptions& options, const Faults& faults, const NewRecording& record);

/// Algorithm 2 in this process: paths only, no bus and no motion.
int plan_command(const RunOptions& options);

struct MapOptions {
  std::string kind;           ///< of map or scenario, or a map's file
  std::optional<int> width;   ///< cells (512); files, and kinds of scenario, have their own
  std::optional<int> height;  ///< the same
  std::uint32_t seed = 1;
  std::optional<int> robots;        ///< as many as the kind is meant for
  std::optional<double> radius;     ///< metres (5 cells); a kind of scenario has its own
  std::optional<double> max_speed;  ///< metres per second (20 cells); the same
  std::string output;               ///< scenario (.json); the map is written beside it
};

/// Generates a map and a scenario on it.
int map_command(const MapOptions& options);

struct FuzzOptions {
  double robot_hours = 1;  ///< of fleet time, over all robots: until then cases are drawn
  std::uint32_t first_seed = 1;
  bool restarts = false;                ///< agents are killed and started anew, too
  std::optional<std::uint32_t> replay;  ///< only the case of this seed, with its files
  RunOptions files;                     ///< what a replay writes
  NewRecording record;                  ///< the same
};

/// Scenarios and faults from consecutive seeds (simulation/fuzz.h). 1 if one failed.
int fuzz_command(const FuzzOptions& options);

struct BenchOptions {
  std::string experiment;         ///< paper, peers, lifelong, avoidance, sharing or scale
  bool quick = false;             ///< few seeds and robots: does it still run?
  std::vector<std::string> maps;  ///< kinds or files
  std::vector<int> robots;
  double radius = 5;  ///< of the robots, metres
  std::optional<int> seeds;
  std::uint64_t first_seed = 1;
  std::string output = ".";
  std::optional<double> time_scale{};  ///< of scale, fleet seconds a wall second; none: by the robots
  std::string discovery{};             ///< of scale, as for DdsSettings
  std::string security{};              ///< the same
  std::string report{};                ///< of scale, JSON; empty: none
};

/// An experiment: writes its table as CSV and Markdown, and its plots. `program` is this executable.
int bench_command(const BenchOptions& options, const std::string& program);

}  // namespace coppice
