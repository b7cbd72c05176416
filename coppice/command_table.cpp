#include "coppice/command_table.h"

#include <algorithm>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "coppice/files/map_file.h"
#include "coppice/files/scenario_generator.h"
#include "coppice/simulate/fault_options.h"
#include "files/number_check.h"
#include "files/output_check.h"
#include "files/report_terms.h"
#include "planner_service/options.h"
#include "planning/nearest_name.h"
#include "planning/quantities.h"
#include "robot_agent/options.h"
#include "runtime/command_line.h"
#include "runtime/process.h"
#include "tree_broker/options.h"

namespace coppice {

namespace {

void add_fleet_options(CLI::App* command, FleetOptions& fleet) {
  add_recording_options(*command, fleet.record, "records all messages of the fleet (MCAP)");
  command->add_flag("--watch", fleet.watch, "shows the fleet on a page, and opens a browser if there is one");
  command->option_defaults()->group("Network");
  command->add_option("--domain", fleet.domain, "DDS domain")
      ->check(a_domain())
      ->default_str("an unused one, or with --ros that of ROS_DOMAIN_ID or 0");
  command
      ->add_option(
          "--discovery", fleet.discovery,
          "how processes find each other: multicast; static (multicast with a fixed table of endpoints, for "
          "large fleets); or discovery servers, separated by ;")
      ->check(a_discovery())
      ->default_str(fmt::format("{}; static from {} robots on", default_discovery, large_fleet));
  command
      ->add_option(
          "--security", fleet.security,
          "turns DDS-Security on: folder with the credentials of all roles (deploy/security/make-keys)")
      ->check(a_folder_name())
      ->default_str("off");
  command->option_defaults()->group("Supervision");
  command->add_option("--state", fleet.state, "folder for the state with which restarted processes continue")
      ->check(a_folder_name())
      ->default_str("nothing is kept, or if processes are restarted a folder for this run");
  command->add_flag("--standby", fleet.standby,
                    "starts a second broker that takes over if the first one fails");
  add_log_options(*command, fleet.log);
  command
      ->add_option("--logs", fleet.logs, "folder for the processes' logs, NAME.log; created if it is missing")
      ->check(a_folder_name())
      ->default_str("not kept");
  add_ros_options(*command, fleet.ros, true, true);
}

void add_run(CLI::App& app, RunOptions& options, FleetOptions& fleet, ChosenCommand& chosen) {
  auto* run = app.add_subcommand("run", "runs a fleet of processes over DDS on this machine");
  add_run_options(*run, options, Progression::many_processes);
  add_fleet_options(run, fleet);
  run->add_flag("--restart", fleet.restart, "restarts processes that end early; they continue");
  run->callback([&] { chosen = [&] { return run_command(options, fleet, "/proc/self/exe"); }; });
}

void add_serve(CLI::App& app, RunOptions& options, FleetOptions& fleet, ChosenCommand& chosen) {
  auto* serve = app.add_subcommand("serve", "runs a fleet that takes orders until it is told to stop");
  add_run_options(*serve, options, Progression::standing);
  add_fleet_options(serve, fleet);
  serve->get_option("--state")->default_str("a folder of this site below ~/.local/state/coppice");
  serve
      ->add_option("--start-at", fleet.start_at,
                   "file of poses where the robots stand as a new run begins (docs/reference.md)")
      ->type_name("POSES")
      ->default_str("where they stood at last, or in a new fleet the scenario's starts");
  serve->callback([&] {
    options.serves = true;
    fleet.restart = true;
    chosen = [&] { return run_command(options, fleet, "/proc/self/exe"); };
  });
}

void add_state(CLI::App& app, StateOptions& options, ChosenCommand& chosen) {
  auto* command =
      app.add_subcommand("state", "lists what a fleet has saved, and goes on from a damaged file");
  command->add_option("folder", options.folder, "the folder of --state")->required()->type_name("FOLDER");
  command->add_flag("--discard-damaged", options.discards,
                    "removes damaged records, keeps all others, and leaves a copy of the damaged file");
  command->callback([&] { chosen = [&] { return state_command(options); }; });
}

void add_inspect(CLI::App& app, InspectOptions& options, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("inspect", "prints what a file of a fleet's state holds, as JSON");
  command->add_option("file", options.file, "a journal in the folder of --state")
      ->required()
      ->type_name("FILE");
  command->callback([&] { chosen = [&] { return inspect_command(options); }; });
}

void add_discovery(CLI::App& app, DiscoveryOptions& options, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("discovery", "runs a discovery server, for networks without multicast");
  command
      ->add_option("--address", options.address,
                   "IPv4 address of this host that clients are told; 0.0.0.0: all; the server listens on all "
                   "in any case")
      ->type_name("ADDRESS");
  command->add_option("--port", options.port, "UDP port")->check(whole_number_between(1, 65535));
  command
      ->add_option("--place", options.place, "the server's position in the fleet's list of servers, from 0")
      ->check(whole_number_between(0, 255));
  command
      ->add_option("--alive", options.alive,
                   "file that is touched every second while the process works, for health checks")
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
  auto* command = app.add_subcommand(
      "doctor", "checks whether this machine has what a fleet needs, and says what to change");
  command->add_option("--robots", fleet.robots, "number of robots that will run on this machine")
      ->check(whole_number_between(1, 100000));
  command->add_option("--domain", fleet.domain, "DDS domain")->check(a_domain());
  command
      ->add_option("--discovery", fleet.discovery,
                   "as the fleet will use it; discovery servers need no multicast")
      ->check(a_discovery())
      ->default_str("the servers of ROS_DISCOVERY_SERVER, or multicast");
  command->callback([&] { chosen = [&] { return doctor_command(fleet); }; });
}

void add_simulate(CLI::App& app, RunOptions& options, Faults& faults, NewRecording& record,
                  ChosenCommand& chosen) {
  auto* command = app.add_subcommand("simulate", "simulates a fleet in one process on a virtual clock");
  add_run_options(*command, options, Progression::virtual_clock);
  add_recording_options(*command, record, "records all messages (MCAP), also the lost ones");
  add_fault_options(*command, faults, options.overrides.tracking_tolerance);
  command->callback([&] { chosen = [&] { return simulate_command(options, faults, record); }; });
}

void add_fuzz(CLI::App& app, FuzzOptions& options, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("fuzz", "simulates scenarios and faults drawn from consecutive seeds");
  command->add_option("--hours", options.robot_hours, "robot-hours of fleet time to simulate")
      ->check(number_above_zero());
  command->add_option("--seed", options.first_seed, "the first seed")->check(a_seed());
  command->add_flag("--restarts", options.restarts, "also kills and restarts agents");
  auto* again =
      command->add_option("--replay", options.replay, "runs only the case of this seed, and writes its files")
          ->check(a_seed())
          ->default_str("off");
  const auto file = [&](const char* name, std::string& chosen_file, const char* what,
                        const CLI::Validator& check) {
    command->add_option(name, chosen_file, what)->check(check)->needs(again)->default_str("not written");
  };
  file("--report", options.files.report, "report of the replay, JSON", output_file());
  file("--trajectory", options.files.trajectory, "trajectory of the replay, CSV", output_file());
  file("--picture", options.files.picture, "picture of the replay, SVG", picture_file());
  add_recording_options(*command, options.record, "recording of the replay, MCAP")->needs(again);
  command->callback([&] { chosen = [&] { return fuzz_command(options); }; });
}

void add_plan(CLI::App& app, RunOptions& options, GridPlanOptions& grid_plan, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("plan", "plans paths only: MA-RRdT* in one process");
  add_run_options(*command, options, Progression::paths_only);
  command
      ->add_option(
          "--grid-plan", grid_plan.file,
          "writes a joint plan on the cells of the map, too, for run --plan and for MAPF tools (LaCAM)")
      ->check(output_file())
      ->default_str("not written");
  command
      ->add_option("--grid-plan-form", grid_plan.form,
                   "steps: a line for each time step, as LaCAM; agents: a line for each robot, as CBS")
      ->check(CLI::IsMember(std::vector<std::string>(grid_plan_forms.begin(), grid_plan_forms.end())));
  command->callback([&] { chosen = [&] { return plan_command(options, grid_plan); }; });
}

std::string kinds_in_words() {
  std::string kinds =
      "Kinds of map, of any size, with random tasks:\n"
      "blank\tno obstacles\n"
      "dense\tmany small obstacles\n"
      "maze\tcorridors, one way between any two points\n"
      "room\trooms with doors\n"
      "Kinds of scenario that need coordination, with their own maps and robots:";
  for (const ScenarioKind& kind : scenario_kinds())
    kinds += fmt::format("\n{}\t{} robots: {}", kind.name, kind.robots, kind.what);
  return kinds;
}

void add_map(CLI::App& app, MapOptions& options, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("map", "makes a map and a scenario on it");
  std::string kinds = "blank|dense|maze|room";
  for (const ScenarioKind& kind : scenario_kinds()) kinds += fmt::format("|{}", kind.name);
  command->add_option("kind", options.kind, "a kind of map or of scenario, as below, or a map file")
      ->required()
      ->type_name(kinds + "|FILE");
  command->footer(kinds_in_words());
  command->add_option("output", options.output, "scenario to write (.json); the map is written beside it")
      ->required()
      ->check(output_file());
  command->add_option("--width", options.width, "width of a generated map, cells")
      ->check(whole_number_between(1, largest_map_file_side))
      ->default_str("512");
  command->add_option("--height", options.height, "height of a generated map, cells")
      ->check(whole_number_between(1, largest_map_file_side))
      ->default_str("512");
  command->add_option("--seed", options.seed, "seed of all random choices")->check(a_seed());
  command->add_option("--robots", options.robots, "number of robots")
      ->check(whole_number_between(1, static_cast<int>(most_robots)))
      ->default_str("8, or the number of the kind of scenario");
  command->add_option("--radius", options.radius, "radius of the robots, metres")
      ->check(number_above_zero())
      ->default_str("5 cells");
  command->add_option("--max-speed", options.max_speed, "greatest speed of the robots, metres per second")
      ->check(number_above_zero())
      ->default_str("20 cells per second");
  command->callback([&] { chosen = [&] { return map_command(options); }; });
}

void add_bench(CLI::App& app, BenchOptions& options, ChosenCommand& chosen) {
  const char* const of_experiment = "as the experiment defines";
  auto* command = app.add_subcommand("bench", "compares planners and measures fleets");
  command->add_option("experiment", options.experiment, "what to measure")
      ->required()
      ->check(CLI::IsMember({"paper", "peers", "lifelong", "avoidance", "throughput", "sharing", "scale"}));
  command->add_flag("--quick", options.quick, "uses few seeds and robots");
  command->add_option("--maps", options.maps, "kinds of map, or map files, separated by commas")
      ->delimiter(',')
      ->type_name("blank|dense|maze|room|FILE")
      ->default_str(of_experiment);
  command->add_option("--robots", options.robots, "numbers of robots, separated by commas")
      ->delimiter(',')
      ->check(whole_number_between(1, 1000))
      ->default_str(of_experiment);
  command->add_option("--radius", options.radius, "radius of the robots, metres")
      ->check(number_above_zero())
      ->default_str("5; for throughput that of the scenario");
  command->add_option("--seeds", options.seeds, "number of trials of each case")
      ->check(whole_number_between(1, 1000000))
      ->default_str(of_experiment);
  command->add_option("--seed", options.first_seed, "the first seed")
      ->check(whole_number_between<std::uint64_t>(0, std::numeric_limits<std::uint64_t>::max()));
  command->add_option("--output", options.output, "folder for the results")->check(output_folder());
  command->option_defaults()->group("Experiment throughput");
  command->add_option("--scenarios", options.scenarios, "scenario files, separated by commas")
      ->delimiter(',')
      ->type_name("FILE");
  command->add_option("--max-speed", options.max_speed, "speed of the robots, metres a second")
      ->check(number_above_zero())
      ->default_str("that of the scenario");
  command
      ->add_option("--lifelong", options.lifelong, "fleet seconds in which robots that arrive get new goals")
      ->check(number_between(0, largest_quantity));
  command
      ->add_option("--references", options.references,
                   "figures of other planners (bench/throughput_reference.csv)")
      ->type_name("FILE")
      ->default_str("none");
  command->option_defaults()->group("Experiment scale");
  command->add_option("--time-scale", options.time_scale, "fleet seconds per wall second")
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
  // app.help() would return the help of the chosen command, which is this one.
  return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
}

/// Must be added last, because it lists all other commands.
void add_help(CLI::App& app, std::string& topic, ChosenCommand& chosen) {
  auto* command = app.add_subcommand("help", "explains a command; help report: explains the report of a run");
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
      ->check(CLI::Validator(problem, fmt::format("{{{}}}", fmt::join(topics, ", "))))
      ->default_str("lists the commands");
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
  add_serve(app, options.run, options.fleet, chosen);
  add_watching_commands(app, options.watching, chosen);
  add_order_commands(app, options.order, chosen);
  add_state(app, options.state, chosen);
  add_inspect(app, options.inspect, chosen);
  add_discovery(app, options.discovery, chosen);
  add_doctor(app, options.fleet_plan, chosen);
  add_simulate(app, options.run, options.faults, options.record, chosen);
  add_fuzz(app, options.fuzz, chosen);
  add_plan(app, options.run, options.grid_plan, chosen);
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
