// coppice: the command line. Each subcommand is a function of commands.h.

#include <exception>
#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#ifdef COPPICE_MIMALLOC
#include <mimalloc.h>
#endif

#include "bus/process.h"
#include "bus/process_options.h"
#include "coppice/commands.h"
#include "coppice/fault_options.h"
#include "coppice/watching_options.h"
#include "files/map_file.h"
#include "files/number_check.h"
#include "files/output_check.h"
#include "files/run_options.h"
#include "files/scenario_generator.h"
#include "planning/quantities.h"

namespace {

using namespace coppice;

/// What the command line says; it outlives the parsing, which runs the command.
struct Options {
  RunOptions run;  ///< of run, simulate and plan
  FleetOptions fleet;
  WatchingOptions watching;
  DiscoveryOptions discovery;
  FleetPlan fleet_plan;
  Faults faults;
  NewRecording record;  ///< of simulate
  FuzzOptions fuzz;
  MapOptions map;
  BenchOptions bench;
};

/// The agents of a simulated fleet know more than a translation lookaside buffer reaches in pages of 4 KiB.
void use_huge_pages() {
#ifdef COPPICE_MIMALLOC
  mi_option_enable(mi_option_large_os_pages);
#endif
}

void add_run(CLI::App& app, RunOptions& options, FleetOptions& fleet, int& exit_code) {
  auto* command = app.add_subcommand("run", "a fleet of processes over DDS on this machine");
  add_run_options(*command, options);
  command
      ->add_option("--domain", fleet.domain,
                   "DDS domain; without: one that nobody uses, and with --ros that of ROS_DOMAIN_ID, or 0")
      ->check(CLI::Range(0, 232));
  command
      ->add_option("--discovery", fleet.discovery,
                   "how processes find each other: multicast; static (by multicast, and a table of their "
                   "endpoints: for large fleets); or discovery servers, several with ; between them")
      ->check(a_discovery());
  command
      ->add_option(
          "--security", fleet.security,
          "turns DDS-Security on: folder with the credentials of all roles (deploy/security/make-keys)")
      ->check(a_folder_name());
  command
      ->add_option("--state", fleet.state,
                   "folder in which processes keep what they need to go on if they are started anew")
      ->check(a_folder_name());
  command->add_flag("--standby", fleet.standby, "a second broker that takes over if the first is gone");
  command->add_flag("--restart", fleet.restart, "processes that end early are started again, and go on");
  add_recording_options(*command, fleet.record, "recording of all that the fleet says (MCAP)");
  command->add_flag("--watch", fleet.watch, "shows the fleet on a page, in a browser where there is one");
  add_log_options(*command, fleet.log);
  command->add_option("--logs", fleet.logs, "folder for the processes' logs, NAME.log, made if it is missing")
      ->check(a_folder_name());
  add_ros_options(*command, fleet.ros, true, true);
  command->callback([&] { exit_code = run_command(options, fleet, "/proc/self/exe"); });
}

void add_discovery(CLI::App& app, DiscoveryOptions& options, int& exit_code) {
  auto* command = app.add_subcommand("discovery", "a discovery server, for networks without multicast");
  command->add_option("--address", options.address,
                      "IPv4 address of this host that clients are told, 0.0.0.0: all; it listens at all");
  command->add_option("--port", options.port, "UDP port")->check(CLI::Range(1, 65535));
  command
      ->add_option("--place", options.place,
                   "in the list of servers that the fleet is given, 0 for the first")
      ->check(CLI::Range(0, 255));
  command->add_option("--alive", options.alive,
                      "file that is touched every second while all is well: for health checks");
  add_log_options(*command, options.log);
  command->callback([&] {
    set_up_logging("coppice discovery", options.log.level, options.log.json);
    exit_code = exit_code_of([&] { return discovery_command(options); });
  });
}

void add_doctor(CLI::App& app, FleetPlan& fleet, int& exit_code) {
  auto* command = app.add_subcommand("doctor", "does this machine have what a fleet needs? what to change");
  command->add_option("--robots", fleet.robots, "that are to run on this machine")
      ->check(CLI::Range(1, 100000));
  command->add_option("--domain", fleet.domain, "DDS domain")->check(CLI::Range(0, 232));
  command
      ->add_option("--discovery", fleet.discovery,
                   "as the fleet will be told; through servers needs no multicast")
      ->check(a_discovery());
  command->callback([&] { exit_code = doctor_command(fleet); });
}

void add_simulate(CLI::App& app, RunOptions& options, Faults& faults, NewRecording& record, int& exit_code) {
  auto* command = app.add_subcommand("simulate", "the same roles in one process on a virtual clock");
  add_run_options(*command, options);
  add_fault_options(*command, faults);
  add_recording_options(*command, record, "recording of all that is said (MCAP), lost or not");
  command->callback([&] {
    use_huge_pages();
    exit_code = simulate_command(options, faults, record);
  });
}

void add_fuzz(CLI::App& app, FuzzOptions& options, int& exit_code) {
  auto* command = app.add_subcommand("fuzz", "simulate scenarios and faults drawn from consecutive seeds");
  command->add_option("--hours", options.robot_hours, "robot-hours of fleet time to simulate")
      ->check(number_above_zero());
  command->add_option("--seed", options.first_seed, "the first one");
  command->add_flag("--restarts", options.restarts, "agents are killed and started anew, too");
  auto* again =
      command->add_option("--replay", options.replay, "only the case of this seed; writes its files");
  command->add_option("--report", options.files.report, "of the replay, JSON")
      ->check(output_file())
      ->needs(again);
  command->add_option("--trajectory", options.files.trajectory, "of the replay, CSV")
      ->check(output_file())
      ->needs(again);
  command->add_option("--picture", options.files.picture, "of the replay, SVG")
      ->check(picture_file())
      ->needs(again);
  add_recording_options(*command, options.record, "of the replay, MCAP")->needs(again);
  command->callback([&] {
    use_huge_pages();
    exit_code = fuzz_command(options);
  });
}

void add_plan(CLI::App& app, RunOptions& options, int& exit_code) {
  auto* command = app.add_subcommand("plan", "paths only: MA-RRdT* in one process");
  add_run_options(*command, options);
  command->callback([&] { exit_code = plan_command(options); });
}

std::string kinds_in_words() {
  std::string kinds =
      "Kinds of map, of any size, with random tasks:\n"
      "  blank          no obstacles\n"
      "  dense          many small obstacles\n"
      "  maze           corridors, one way between any two places\n"
      "  room           rooms with doors\n"
      "Kinds of scenario that try coordination, with maps and robots of their own:\n";
  for (const ScenarioKind& kind : scenario_kinds())
    kinds += fmt::format("  {:<14} {} robots: {}\n", kind.name, kind.robots, kind.what);
  return kinds;
}

void add_map(CLI::App& app, MapOptions& options, int& exit_code) {
  auto* command = app.add_subcommand("map", "generate a map and a scenario on it");
  command->add_option("kind", options.kind, "a kind of map or of scenario, as below, or a map's file")
      ->required();
  command->footer(kinds_in_words());
  command->add_option("output", options.output, "scenario to write (.json); the map goes beside it")
      ->required();
  command->add_option("--width", options.width, "of a kind of map, cells (512)")
      ->check(CLI::Range(1, largest_map_file_side));
  command->add_option("--height", options.height, "of a kind of map, cells (512)")
      ->check(CLI::Range(1, largest_map_file_side));
  command->add_option("--seed", options.seed, "of every random choice");
  command->add_option("--robots", options.robots, "robots (8; of a scenario: see below)")
      ->check(CLI::Range(1, static_cast<int>(most_robots)));
  command->add_option("--radius", options.radius, "of the robots, metres (5 cells)")
      ->check(number_above_zero());
  command->add_option("--max-speed", options.max_speed, "of the robots, m/s (20 cells a second)")
      ->check(number_above_zero());
  command->callback([&] { exit_code = map_command(options); });
}

void add_bench(CLI::App& app, BenchOptions& options, int& exit_code) {
  auto* command = app.add_subcommand("bench", "measure against other planners, or mission after mission");
  command->add_option("experiment", options.experiment, "paper, peers, lifelong, avoidance, sharing or scale")
      ->required()
      ->check(CLI::IsMember({"paper", "peers", "lifelong", "avoidance", "sharing", "scale"}));
  command->add_flag("--quick", options.quick, "few seeds and robots");
  command->add_option("--maps", options.maps, "blank, dense, maze, room, or maps' files")->delimiter(',');
  command->add_option("--robots", options.robots, "numbers of robots")
      ->delimiter(',')
      ->check(CLI::Range(1, 1000));
  command->add_option("--radius", options.radius, "of the robots, metres")->check(number_above_zero());
  command->add_option("--seeds", options.seeds, "trials of each")->check(CLI::Range(1, 1000000));
  command->add_option("--seed", options.first_seed, "the first one");
  command->add_option("--output", options.output, "folder for the results")->check(CLI::ExistingDirectory);
  command
      ->add_option("--time-scale", options.time_scale,
                   "of scale: fleet seconds a wall second, instead of what run takes for so many robots")
      ->check(number_between(least_quantity, largest_time_scale));
  command->add_option("--discovery", options.discovery, "of scale: as for coppice run")->check(a_discovery());
  command->add_option("--security", options.security, "of scale: as for coppice run")->check(a_folder_name());
  command->add_option("--report", options.report, "of scale: write the results (JSON)")->check(output_file());
  command->callback([&] { exit_code = bench_command(options, "/proc/self/exe"); });
}

}  // namespace

int main(int argc, char** argv) {
  fill_standard_streams();
  CLI::App app{"Coppice: multi-robot path planning and driving"};
  app.set_version_flag("--version", COPPICE_VERSION);
  app.require_subcommand(1);
  Options options;
  int exit_code = 0;
  add_run(app, options.run, options.fleet, exit_code);
  add_watching_commands(app, options.watching, exit_code);
  add_discovery(app, options.discovery, exit_code);
  add_doctor(app, options.fleet_plan, exit_code);
  add_simulate(app, options.run, options.faults, options.record, exit_code);
  add_fuzz(app, options.fuzz, exit_code);
  add_plan(app, options.run, exit_code);
  add_map(app, options.map, exit_code);
  add_bench(app, options.bench, exit_code);

  set_up_logging("coppice", "info");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  } catch (const std::exception& problem) {
    std::cerr << problem.what() << '\n';
    return 2;
  }
  return exit_code;
}
