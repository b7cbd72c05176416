#include "coppice/run/watching_options.h"

#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "coppice/run/local_fleets.h"
#include "files/number_check.h"
#include "files/output_check.h"
#include "monitor/view/fleet_table.h"
#include "planning/quantities.h"
#include "runtime/process.h"
#include "runtime/process_options.h"

namespace coppice {

namespace {

constexpr double highest_frame_rate = 120;

/// The command as the user typed it, but for how to reach a fleet.
std::string typed_command(const CLI::App& command) {
  std::vector<std::string> words{"coppice", command.get_name()};
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    const bool is_of_fleet = name == "--domain" || name == "--discovery" || name == "--security";
    if (option->count() == 0 || is_of_fleet) continue;
    if (!option->get_positional()) words.push_back(name);
    if (option->get_items_expected_max() > 0)
      words.insert(words.end(), option->results().begin(), option->results().end());
  }
  return shell_words(words);
}

void add_control_options(CLI::App& monitor, MonitorOptions& options, CLI::Option* recording) {
  monitor.option_defaults()->group("Control");
  auto* control =
      monitor.add_flag("--control", options.control, "programs may give orders over HTTP, with a token")
          ->excludes(recording);
  auto* token = monitor
                    .add_option("--token-file", options.token_file,
                                "the token in its first line, of at least 16 characters")
                    ->type_name("FILE")
                    ->default_str("none")
                    ->needs(control);
  control->needs(token);
}

void add_monitor(CLI::App& app, MonitorOptions& options, ChosenCommand& chosen) {
  auto* monitor = app.add_subcommand("monitor", "shows a fleet: a page, Foxglove, Prometheus");
  auto* file =
      monitor->add_option("recording", options.recording, "shows that instead of a fleet that drives")
          ->default_str("a fleet that drives");
  monitor->option_defaults()->group("Page");
  monitor->add_option("--port", options.web.port, "TCP port; 0: any that is free")
      ->check(whole_number_between(0, 65535));
  monitor->add_flag("--else-any-port", options.web.else_any_port, "if that port is taken: any that is free");
  monitor
      ->add_option(
          "--address", options.web.address,
          "IP address of this machine to listen at; another than 127.0.0.1 shows the fleet to the network")
      ->type_name("ADDRESS");
  monitor
      ->add_option(
          "--allow-origin", options.web.origins,
          "pages of this origin (https://HOST) may connect as Foxglove, as https://app.foxglove.dev may")
      ->type_name("ORIGIN")
      ->default_str("none");
  monitor
      ->add_option("--proxy-origin", options.web.proxies,
                   "a proxy serves the page at this origin (https://HOST): its pages and its Host are let in")
      ->type_name("ORIGIN")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return is_origin(text) ? std::string()
                                   : "expected https://HOST or https://HOST:PORT, found " + text;
          },
          "", "origin"))
      ->default_str("none");
  monitor->add_flag("--open", options.open, "opens the page in a browser");
  add_control_options(*monitor, options, file);
  add_network_options(*monitor, options.network, "observer's, with --control the dispatcher",
                      domain_of_fleet);
  for (const char* name : {"--domain", "--discovery", "--security"})
    monitor->get_option(name)->excludes(file);
  add_log_options(*monitor, options.log);
  monitor->callback([&options, &chosen, monitor] {
    chosen = [&options, monitor] {
      set_up_logging("coppice monitor", options.log.level, options.log.json);
      if (options.recording.empty()) find_fleet(*monitor, options.network);
      return monitor_command(options);
    };
  });
}

void add_top(CLI::App& app, TopOptions& options, ChosenCommand& chosen) {
  auto* top = app.add_subcommand("top", "shows a fleet as a table in the terminal");
  top->add_option("--order", options.order, "of the robots")
      ->check(CLI::IsMember(std::vector<std::string>(robot_orders.begin(), robot_orders.end())));
  top->add_flag("--once", options.once, "prints the table after three seconds, and ends");
  add_network_options(*top, options.network, "observer", domain_of_fleet);
  top->callback([&options, &chosen, top] {
    chosen = [&options, top] {
      find_fleet(*top, options.network);
      return top_command(options);
    };
  });
}

void add_record(CLI::App& app, RecordOptions& options, ChosenCommand& chosen) {
  auto* record = app.add_subcommand("record", "writes all that a fleet says to a file (MCAP)");
  record->add_option("file", options.file, "recording to write")->required()->check(output_file());
  record->add_option("--duration", options.duration, "seconds")
      ->check(number_above_zero())
      ->default_str("until it is told to stop");
  record->add_flag("--force", options.force, "replaces a file that is there");
  add_network_options(*record, options.network, "observer", domain_of_fleet);
  add_log_options(*record, options.log);
  record->callback([&options, &chosen, record] {
    chosen = [&options, record] {
      set_up_logging("coppice record", options.log.level, options.log.json);
      find_fleet(*record, options.network);
      return record_command(options);
    };
  });
}

void add_recordings(CLI::App& app, WatchingOptions& options, ChosenCommand& chosen) {
  auto* info = app.add_subcommand("info", "what a recording holds, and whether it is whole");
  info->add_option("file", options.recording, "recording (MCAP)")->required();
  info->callback([&] { chosen = [&] { return info_command(options.recording); }; });

  auto* replay = app.add_subcommand("replay", "says on a bus what a recording holds, to those who look on");
  replay->add_option("file", options.replay.file, "recording (MCAP)")->required();
  replay->add_option("--speed", options.replay.speed, "recorded seconds a second")
      ->check(number_between(least_quantity, largest_time_scale));
  replay->add_option("--from", options.replay.from, "seconds after its beginning")
      ->check(number_not_negative());
  add_network_options(*replay, options.replay.network, "replayer", "0");
  replay->callback([&] { chosen = [&] { return replay_command(options.replay); }; });
}

void add_explain(CLI::App& app, ExplainOptions& options, ChosenCommand& chosen) {
  auto* explain = app.add_subcommand("explain", "says in sentences what a robot of a recording did, and why");
  explain->add_option("recording", options.recording, "recording (MCAP)")->required();
  explain->add_option("robot", options.robot, "the robot's name")->required()->type_name("ROBOT");
  explain->add_option("time", options.time, "fleet seconds: tells more of that moment")
      ->default_str("the whole recording, a sentence for each change");
  explain->callback([&] { chosen = [&] { return explain_command(options); }; });
}

void add_picture(CLI::App& app, PictureOptions& options, ChosenCommand& chosen) {
  auto* picture = app.add_subcommand("picture", "draws a fleet out of a recording, or makes a movie of it");
  picture->add_option("recording", options.recording, "recording (MCAP)")->required();
  picture->add_option("output", options.output, "file to write: .svg or .png; of a movie .gif, .webm or .mp4")
      ->required()
      ->check(output_file());
  auto* time = picture->add_option("--time", options.time, "fleet seconds")->default_str("the last moment");
  picture->add_flag("--quiet", options.quiet, "says nothing");
  picture->option_defaults()->group("Movies");
  auto* movie =
      picture->add_flag("--movie", options.movie, "of all of it, or --from one time --until another");
  time->excludes(movie);
  picture->add_option("--from", options.from, "fleet seconds")->needs(movie)->default_str("the beginning");
  picture->add_option("--until", options.until, "fleet seconds")->needs(movie)->default_str("the end");
  picture->add_option("--fps", options.frame_rate, "frames a second")
      ->needs(movie)
      ->check(number_between(least_quantity, highest_frame_rate));
  picture->add_option("--speed", options.speed, "fleet seconds a second")
      ->needs(movie)
      ->check(number_between(least_quantity, largest_time_scale));
  picture->callback([&] { chosen = [&] { return picture_command(options); }; });
}

}  // namespace

void add_network_options(CLI::App& command, DdsSettings& network, const std::string& role,
                         const std::string& domain) {
  command.option_defaults()->group("Network");
  command.add_option("--domain", network.domain, "DDS domain")->check(a_domain())->default_str(domain);
  command.add_option("--discovery", network.discovery, "as the fleet was told")
      ->check(a_discovery())
      ->default_str(default_discovery);
  command.add_option("--security", network.security, "folder with the " + role + "'s credentials")
      ->check(a_folder_name())
      ->default_str("off");
}

void find_fleet(const CLI::App& command, DdsSettings& network) {
  if (command.count("--domain") == 0)
    std::cerr << choose_fleet(network, local_fleets(), typed_command(command)) << std::endl;
}

CLI::Option* add_recording_options(CLI::App& command, NewRecording& record, const char* of_what) {
  auto* file =
      command.add_option("--record", record.file, of_what)->check(output_file())->default_str("not written");
  command.add_flag("--force", record.force, "a recording that is there is replaced")->needs(file);
  return file;
}

void add_watching_commands(CLI::App& app, WatchingOptions& options, ChosenCommand& chosen) {
  add_monitor(app, options.monitor, chosen);
  add_top(app, options.top, chosen);
  add_record(app, options.record, chosen);
  add_recordings(app, options, chosen);
  add_explain(app, options.explain, chosen);
  add_picture(app, options.picture, chosen);
}

}  // namespace coppice
