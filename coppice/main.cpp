// coppice: run, simulate or plan a scenario, or generate one.

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
#include "files/number_check.h"
#include "files/output_check.h"
#include "files/run_options.h"
#include "files/scenario_generator.h"
#include "planning/quantities.h"

namespace {

/// The agents of a simulated fleet know more than a translation lookaside buffer reaches in pages of 4 KiB.
void use_huge_pages() {
#ifdef COPPICE_MIMALLOC
  mi_option_enable(mi_option_large_os_pages);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  using namespace coppice;
  fill_standard_streams();
  CLI::App app{"Coppice: multi-robot path planning and driving"};
  app.set_version_flag("--version", COPPICE_VERSION);
  app.require_subcommand(1);
  RunOptions options;
  MapOptions map;
  int exit_code = 0;

  auto* run = app.add_subcommand("run", "a fleet of processes over DDS on this machine");
  add_run_options(*run, options);
  FleetOptions fleet;
  run->add_option("--domain", fleet.domain,
                  "DDS domain; without: one that nobody uses, and with --ros that of ROS_DOMAIN_ID, or 0")
      ->check(CLI::Range(0, 232));
  run->add_option("--discovery", fleet.discovery,
                  "how processes find each other: multicast; static (by multicast, and a table of their "
                  "endpoints: for large fleets); or discovery servers, several with ; between them")
      ->check(a_discovery());
  run->add_option(
         "--security", fleet.security,
         "turns DDS-Security on: folder with the credentials of all roles (deploy/security/make-keys)")
      ->check(a_folder_name());
  run->add_option("--state", fleet.state,
                  "folder in which processes keep what they need to go on if they are started anew")
      ->check(a_folder_name());
  run->add_flag("--standby", fleet.standby, "a second broker that takes over if the first is gone");
  run->add_flag("--restart", fleet.restart, "processes that end early are started again, and go on");
  add_recording_options(*run, fleet.record, "recording of all that the fleet says (MCAP)");
  run->add_flag("--watch", fleet.watch, "shows the fleet on a page, in a browser where there is one");
  add_log_options(*run, fleet.log);
  run->add_option("--logs", fleet.logs, "folder for the processes' logs, NAME.log, made if it is missing")
      ->check(a_folder_name());
  add_ros_options(*run, fleet.ros, true, true);
  run->callback([&] { exit_code = run_command(options, fleet, "/proc/self/exe"); });
  WatchingOptions watching;
  add_watching_commands(app, watching, exit_code);
  DiscoveryOptions server;
  auto* discovery = app.add_subcommand("discovery", "a discovery server, for networks without multicast");
  discovery->add_option("--address", server.address,
                        "IPv4 address of this host that clients are told, 0.0.0.0: all; it listens at all");
  discovery->add_option("--port", server.port, "UDP port")->check(CLI::Range(1, 65535));
  discovery
      ->add_option("--place", server.place, "in the list of servers that the fleet is given, 0 for the first")
      ->check(CLI::Range(0, 255));
  discovery->add_option("--alive", server.alive,
                        "file that is touched every second while all is well: for health checks");
  add_log_options(*discovery, server.log);
  discovery->callback([&] {
    set_up_logging("coppice discovery", server.log.level, server.log.json);
    exit_code = exit_code_of([&] { return discovery_command(server); });
  });
  FleetPlan plan_of_fleet;
  auto* doctor = app.add_subcommand("doctor", "does this machine have what a fleet needs? what to change");
  doctor->add_option("--robots", plan_of_fleet.robots, "that are to run on this machine")
      ->check(CLI::Range(1, 100000));
  doctor->add_option("--domain", plan_of_fleet.domain, "DDS domain")->check(CLI::Range(0, 232));
  doctor
      ->add_option("--discovery", plan_of_fleet.discovery,
                   "as the fleet will be told; through servers needs no multicast")
      ->check(a_discovery());
  doctor->callback([&] { exit_code = doctor_command(plan_of_fleet); });
  auto* simulate = app.add_subcommand("simulate", "the same roles in one process on a virtual clock");
  add_run_options(*simulate, options);
  Faults faults;
  add_fault_options(*simulate, faults);
  NewRecording record;
  add_recording_options(*simulate, record, "recording of all that is said (MCAP), lost or not");
  simulate->callback([&] {
    use_huge_pages();
    exit_code = simulate_command(options, faults, record);
  });
  FuzzOptions fuzz;
  auto* hunt = app.add_subcommand("fuzz", "simulate scenarios and faults drawn from consecutive seeds");
  hunt->add_option("--hours", fuzz.robot_hours, "robot-hours of fleet time to simulate")
      ->check(number_above_zero());
  hunt->add_option("--seed", fuzz.first_seed, "the first one");
  hunt->add_flag("--restarts", fuzz.restarts, "agents are killed and started anew, too");
  auto* again = hunt->add_option("--replay", fuzz.replay, "only the case of this seed; writes its files");
  hunt->add_option("--report", fuzz.files.report, "of the replay, JSON")->check(output_file())->needs(again);
  hunt->add_option("--trajectory", fuzz.files.trajectory, "of the replay, CSV")
      ->check(output_file())
      ->needs(again);
  hunt->add_option("--picture", fuzz.files.picture, "of the replay, SVG")->check(output_file())->needs(again);
  add_recording_options(*hunt, fuzz.record, "of the replay, MCAP")->needs(again);
  hunt->callback([&] {
    use_huge_pages();
    exit_code = fuzz_command(fuzz);
  });
  auto* plan = app.add_subcommand("plan", "paths only: MA-RRdT* in one process");
  add_run_options(*plan, options);
  plan->callback([&] { exit_code = plan_command(options); });
  auto* generate = app.add_subcommand("map", "generate a map and a scenario on it");
  generate->add_option("kind", map.kind, "blank, dense, maze, room, a map's file, or one of those below")
      ->required();
  std::string kinds = "Kinds that try coordination:\n";
  for (const ScenarioKind& kind : scenario_kinds())
    kinds += fmt::format("  {:<12} {} robots: {}\n", kind.name, kind.robots, kind.what);
  generate->footer(kinds);
  generate->add_option("output", map.output, "scenario to write (.json); the map goes beside it")->required();
  generate->add_option("--width", map.width, "cells");
  generate->add_option("--height", map.height, "cells");
  generate->add_option("--seed", map.seed, "of every random choice");
  generate->add_option("--robots", map.robots, "robots")->check(CLI::Range(1, static_cast<int>(most_robots)));
  generate->add_option("--radius", map.radius, "of the robots, metres")->check(number_above_zero());
  generate->add_option("--max-speed", map.max_speed, "of the robots, m/s")->check(number_above_zero());
  generate->callback([&] { exit_code = map_command(map); });

  BenchOptions bench;
  auto* experiments = app.add_subcommand("bench", "measure against other planners, or mission after mission");
  experiments
      ->add_option("experiment", bench.experiment, "paper, peers, lifelong, avoidance, sharing or scale")
      ->required()
      ->check(CLI::IsMember({"paper", "peers", "lifelong", "avoidance", "sharing", "scale"}));
  experiments->add_flag("--quick", bench.quick, "few seeds and robots");
  experiments->add_option("--maps", bench.maps, "blank, dense, maze, room, or maps' files")->delimiter(',');
  experiments->add_option("--robots", bench.robots, "numbers of robots")
      ->delimiter(',')
      ->check(CLI::Range(1, 1000));
  experiments->add_option("--radius", bench.radius, "of the robots, metres")->check(number_above_zero());
  experiments->add_option("--seeds", bench.seeds, "trials of each")->check(CLI::Range(1, 1000000));
  experiments->add_option("--seed", bench.first_seed, "the first one");
  experiments->add_option("--output", bench.output, "folder for the results")->check(CLI::ExistingDirectory);
  experiments
      ->add_option("--time-scale", bench.time_scale,
                   "of scale: fleet seconds a wall second, instead of 1 for up to 50 robots")
      ->check(number_between(least_quantity, largest_time_scale));
  experiments->add_option("--discovery", bench.discovery, "of scale: as for coppice run")
      ->check(a_discovery());
  experiments->add_option("--security", bench.security, "of scale: as for coppice run")
      ->check(a_folder_name());
  experiments->add_option("--report", bench.report, "of scale: write the results (JSON)")
      ->check(output_file());
  experiments->callback([&] { exit_code = bench_command(bench, "/proc/self/exe"); });

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
