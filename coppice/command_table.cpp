#include "coppice/command_table.h"

#include <algorithm>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "runtime/command_line.h"
#include "runtime/process.h"
#include "coppice/fault_options.h"
#include "files/map_file.h"
#include "files/number_check.h"
#include "files/output_check.h"
#include "files/report_terms.h"
#include "files/scenario_generator.h"
#include "planner_service/options.h"
#include "planning/nearest_name.h"
#include "planning/quantities.h"
#include "robot_agent/options.h"
#include "tree_broker/options.h"

namespace coppice {

namespace {

void add_run(CLI::App& app, RunOptions& options, FleetOptions& fleet, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("run", "a fleet of processes over DDS on this machine");
  add_run_options(*command, options, Progression::many_processes);
  add_recording_options(*command, fleet.record, "recording of all that the fleet says (MCAP)");
  command->add_flag("--watch", fleet.watch, "shows the fleet on a page, in a browser where there is one");
  command->option_defaults()->group("Network");
  command->add_option("--domain", fleet.domain, "DDS domain")
      ->check(a_domain())
      ->default_str("one that nobody uses, or with --ros that of ROS_DOMAIN_ID or 0");
  command
      ->add_option("--discovery", fleet.discovery,
                   "how processes find each other: multicast; static (by multicast, and a table of their "
                   "endpoints: for large fleets); or discovery servers, several with ; between them")
      ->check(a_discovery())
      ->default_str(fmt::format("{}, or with {} robots and more static", default_discovery, large_fleet));
  command
      ->add_option(
          "--security", fleet.security,
          "turns DDS-Security on: folder with the credentials of all roles (deploy/security/make-keys)")
      ->check(a_folder_name())
      ->default_str("off");
  command->option_defaults()->group("Supervision");
  command
      ->add_option("--state", fleet.state,
                   "folder in which processes keep what they need to go on if they are started anew")
      ->check(a_folder_name())
      ->default_str("nothing is kept, or with --restart a folder for this run");
  command->add_flag("--restart", fleet.restart, "processes that end early are started again, and go on");
  command->add_flag("--standby", fleet.standby, "a second broker that takes over if the first is gone");
  add_log_options(*command, fleet.log);
  command->add_option("--logs", fleet.logs, "folder for the processes' logs, NAME.log, made if it is missing")
      ->check(a_folder_name())
      ->default_str("not kept");
  add_ros_options(*command, fleet.ros, true, true);
  command->callback([&] { chosen = [&] { return run_command(options, fleet, "/proc/self/exe"); }; });
}

void add_discovery(CLI::App& app, DiscoveryOptions& options, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("discovery", "a discovery server, for networks without multicast");
  command
      ->add_option("--address", options.address,
                   "IPv4 address of this host that clients are told, 0.0.0.0: all; it listens at all")
      ->type_name("ADDRESS");
  command->add_option("--port", options.port, "UDP port")->check(whole_number_between(1, 65535));
  command
      ->add_option("--place", options.place,
                   "in the list of servers that the fleet is given, 0 for the first")
      ->check(whole_number_between(0, 255));
  command
      ->add_option("--alive", options.alive,
                   "file that is touched every second while all is well: for health checks")
      ->type_name("FILE")
      ->default_str("none");
  add_log_options(*command, options.log);
  command->callback([&] {
    chosen = [&] {
      set_up_logging("coppice discovery", options.log.level, options.log.json);
      return exit_code_of([&] { return discovery_command(options); });
    };
  });
}

void add_doctor(CLI::App& app, FleetPlan& fleet, ChosenCommand& chosen) {
  auto* command =
      app.add_subcommand("doctor", "whether this machine has what a fleet needs, and what to change");
  command->add_option("--robots", fleet.robots, "that are to run on this machine")
      ->check(whole_number_between(1, 100000));
  command->add_option("--domain", fleet.domain, "DDS domain")->check(a_domain());
  command
      ->add_option("--discovery", fleet.discovery,
                   "as the fleet will be told; through servers needs no multicast")
      ->check(a_discovery())
      ->default_str("the servers of ROS_DISCOVERY_SERVER, or multicast");
  command->callback([&] { chosen = [&] { return doctor_command(fleet); }; });
}

void add_simulate(CLI::App& app, RunOptions& options, Faults& faults, NewRecording& record,
                  ChosenCommand& chosen) {
  auto* command = app.add_subcommand("simulate", "the same roles in one process on a virtual clock");
  add_run_options(*command, options, Progression::virtual_clock);
  add_recording_options(*command, record, "recording of all that is said (MCAP), lost or not");
  add_fault_options(*command, faults);
  command->callback([&] { chosen = [&] { return simulate_command(options, faults, record); }; });
}

void add_fuzz(CLI::App& app, FuzzOptions& options, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("fuzz", "simulates scenarios and faults drawn from consecutive seeds");
  command->add_option("--hours", options.robot_hours, "robot-hours of fleet time to simulate")
      ->check(number_above_zero());
  command->add_option("--seed", options.first_seed, "the first one")->check(a_seed());
  command->add_flag("--restarts", options.restarts, "agents are killed and started anew, too");
  auto* again =
      command->add_option("--replay", options.replay, "only the case of this seed; writes its files")
          ->check(a_seed())
          ->default_str("off");
  const auto file = [&](const char* name, std::string& chosen_file, const char* what,
                        const CLI::Validator& check) {
    command->add_option(name, chosen_file, what)->check(check)->needs(again)->default_str("not written");
  };
  file("--report", options.files.report, "of the replay, JSON", output_file());
  file("--trajectory", options.files.trajectory, "of the replay, CSV", output_file());
  file("--picture", options.files.picture, "of the replay, SVG", picture_file());
  add_recording_options(*command, options.record, "of the replay, MCAP")->needs(again);
  command->callback([&] { chosen = [&] { return fuzz_command(options); }; });
}

void add_plan(CLI::App& app, RunOptions& options, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("plan", "paths only: MA-RRdT* in one process");
  add_run_options(*command, options, Progression::paths_only);
  command->callback([&] { chosen = [&] { return plan_command(options); }; });
}

std::string kinds_in_words() {
  std::string kinds =
      "Kinds of map, of any size, with random tasks:\n"
      "blank\tno obstacles\n"
      "dense\tmany small obstacles\n"
      "maze\tcorridors, one way between any two places\n"
      "room\trooms with doors\n"
      "Kinds of scenario that try coordination, with maps and robots of their own:";
  for (const ScenarioKind& kind : scenario_kinds())
    kinds += fmt::format("\n{}\t{} robots: {}", kind.name, kind.robots, kind.what);
  return kinds;
}

void add_map(CLI::App& app, MapOptions& options, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("map", "makes a map and a scenario on it");
  command->add_option("kind", options.kind, "a kind of map or of scenario, as below, or a map's file")
      ->required();
  command->footer(kinds_in_words());
  command->add_option("output", options.output, "scenario to write (.json); the map goes beside it")
      ->required()
      ->check(output_file());
  command->add_option("--width", options.width, "of a kind of map, cells")
      ->check(whole_number_between(1, largest_map_file_side))
      ->default_str("512");
  command->add_option("--height", options.height, "of a kind of map, cells")
      ->check(whole_number_between(1, largest_map_file_side))
      ->default_str("512");
  command->add_option("--seed", options.seed, "of every random choice")->check(a_seed());
  command->add_option("--robots", options.robots, "how many")
      ->check(whole_number_between(1, static_cast<int>(most_robots)))
      ->default_str("8, or of a kind of scenario as it says");
  command->add_option("--radius", options.radius, "of the robots, metres")
      ->check(number_above_zero())
      ->default_str("5 cells");
  command->add_option("--max-speed", options.max_speed, "of the robots, metres a second")
      ->check(number_above_zero())
      ->default_str("20 cells a second");
  command->callback([&] { chosen = [&] { return map_command(options); }; });
}

void add_bench(CLI::App& app, BenchOptions& options, ChosenCommand& chosen) {
  const char* const of_experiment = "those of the experiment";
  auto* command = app.add_subcommand("bench", "measures against other planners, or mission after mission");
  command->add_option("experiment", options.experiment, "what to measure")
      ->required()
      ->check(CLI::IsMember({"paper", "peers", "lifelong", "avoidance", "sharing", "scale"}));
  command->add_flag("--quick", options.quick, "few seeds and robots");
  command
      ->add_option("--maps", options.maps,
                   "blank, dense, maze, room, or maps' files, with commas between them")
      ->delimiter(',')
      ->default_str(of_experiment);
  command->add_option("--robots", options.robots, "numbers of robots, with commas between them")
      ->delimiter(',')
      ->check(whole_number_between(1, 1000))
      ->default_str(of_experiment);
  command->add_option("--radius", options.radius, "of the robots, metres")->check(number_above_zero());
  command->add_option("--seeds", options.seeds, "trials of each")
      ->check(whole_number_between(1, 1000000))
      ->default_str(of_experiment);
  command->add_option("--seed", options.first_seed, "the first one")
      ->check(whole_number_between<std::uint64_t>(0, std::numeric_limits<std::uint64_t>::max()));
  command->add_option("--output", options.output, "folder for the results")->check(output_folder());
  command->option_defaults()->group("Of scale");
  command->add_option("--time-scale", options.time_scale, "fleet seconds a second of the wall's clock")
      ->check(number_between(least_quantity, largest_time_scale))
      ->default_str("as of coppice run");
  command->add_option("--discovery", options.discovery, "as of coppice run")
      ->check(a_discovery())
      ->default_str("as of coppice run");
  command->add_option("--security", options.security, "as of coppice run")
      ->check(a_folder_name())
      ->default_str("off");
  command->add_option("--report", options.report, "writes the results (JSON)")
      ->check(output_file())
      ->default_str("not written");
  command->callback([&] { chosen = [&] { return bench_command(options, "/proc/self/exe"); }; });
}

constexpr const char* topic_of_reports = "report";

std::string help_on(const CLI::App& app, const std::string& topic) {
  if (topic == topic_of_reports) return help_text(terms_of_table() + "\n\n" + terms_of_report());
  if (!topic.empty()) return app.get_subcommand(topic)->help(app.get_name());
  // app.help() would be that of the command that was chosen: of this one.
  return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
}

/// The last one, for it knows all the others.
void add_help(CLI::App& app, std::string& topic, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("help", "how a command is used; help report: what a run's report says");
  std::vector<std::string> topics{topic_of_reports};
  for (const CLI::App* known : app.get_subcommands({})) topics.push_back(known->get_name());
  const auto problem = [topics](const std::string& text) {
    if (std::ranges::count(topics, text) > 0) return std::string();
    const std::string nearest = nearest_name(text, topics);
    return fmt::format("there is no {}, {}", text,
                       nearest.empty() ? fmt::format("expected one of {}", fmt::join(topics, ", "))
                                       : fmt::format("did you mean {}?", nearest));
  };
  command->add_option("topic", topic, "a command, or report")
      ->check(CLI::Validator(problem, ""))
      ->default_str("which commands there are");
  command->callback([&] {
    chosen = [&] {
      std::cout << help_on(app, topic);
      return 0;
    };
  });
}

}  // namespace

void add_commands(CLI::App& app, CommandOptions& options, ChosenCommand& chosen) {
  set_up_command_line(app, "coppice", "Coppice: multi-robot path planning and driving");
  app.require_subcommand(1);
  add_run(app, options.run, options.fleet, chosen);
  add_watching_commands(app, options.watching, chosen);
  add_discovery(app, options.discovery, chosen);
  add_doctor(app, options.fleet_plan, chosen);
  add_simulate(app, options.run, options.faults, options.record, chosen);
  add_fuzz(app, options.fuzz, chosen);
  add_plan(app, options.run, chosen);
  add_map(app, options.map, chosen);
  add_bench(app, options.bench, chosen);
  add_help(app, options.help_topic, chosen);
}

void visit_programs(const std::function<void(const CLI::App&)>& visit) {
  const auto visit_one = [&](auto&& add, auto options) {
    CLI::App app;
    add(app, options);
    visit(app);
  };
  ChosenCommand none;
  visit_one([&](CLI::App& app, CommandOptions& options) { add_commands(app, options, none); },
            CommandOptions());
  visit_one(add_broker_options, BrokerOptions());
  visit_one(add_agent_options, AgentOptions());
  visit_one(add_service_options, ServiceOptions());
}

}  // namespace coppice
