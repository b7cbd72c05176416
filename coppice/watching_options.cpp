#include "coppice/watching_options.h"

#include <vector>

#include <CLI/CLI.hpp>

#include "bus/process.h"
#include "bus/process_options.h"
#include "files/number_check.h"
#include "files/output_check.h"
#include "monitor/fleet_table.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

constexpr double highest_frame_rate = 120;

void add_network_options(CLI::App& command, DdsSettings& network, const std::string& role) {
  command.add_option("--domain", network.domain, "DDS domain")->check(CLI::Range(0, 232));
  command.add_option("--discovery", network.discovery, "as the fleet was told")->check(a_discovery());
  command.add_option("--security", network.security, "folder with the " + role + "'s credentials")
      ->check(a_folder_name());
}

void add_monitor(CLI::App& app, MonitorOptions& options, int& exit_code) {
  auto* monitor = app.add_subcommand("monitor", "shows a fleet: a page, Foxglove, Prometheus");
  auto* file =
      monitor->add_option("recording", options.recording, "shows that instead of a fleet that drives");
  add_network_options(*monitor, options.network, "observer");
  for (const char* name : {"--domain", "--discovery", "--security"})
    monitor->get_option(name)->excludes(file);
  monitor->add_option("--port", options.web.port, "TCP port; 0: any that is free")
      ->check(CLI::Range(0, 65535));
  monitor->add_flag("--else-any-port", options.web.else_any_port, "if that port is taken: any that is free");
  monitor->add_option(
      "--address", options.web.address,
      "IP address of this machine to listen at; another than 127.0.0.1 shows the fleet to the network");
  monitor->add_option(
      "--allow-origin", options.web.origins,
      "pages of this origin (https://HOST) may connect as Foxglove, as https://app.foxglove.dev may");
  monitor->add_flag("--open", options.open, "opens the page in a browser");
  add_log_options(*monitor, options.log);
  monitor->callback([&] {
    set_up_logging("coppice monitor", options.log.level, options.log.json);
    exit_code = monitor_command(options);
  });
}

void add_top(CLI::App& app, TopOptions& options, int& exit_code) {
  auto* top = app.add_subcommand("top", "shows a fleet as a table in the terminal");
  add_network_options(*top, options.network, "observer");
  top->add_option("--order", options.order, "of the robots")
      ->check(CLI::IsMember(std::vector<std::string>(robot_orders.begin(), robot_orders.end())));
  top->add_flag("--once", options.once, "prints the table after three seconds, and ends");
  top->callback([&] { exit_code = top_command(options); });
}

void add_recordings(CLI::App& app, WatchingOptions& options, int& exit_code) {
  auto* record = app.add_subcommand("record", "writes all that a fleet says to a file (MCAP)");
  record->add_option("file", options.record.file, "recording to write")->required()->check(output_file());
  add_network_options(*record, options.record.network, "observer");
  record->add_option("--duration", options.record.duration, "seconds; without: until it is told to stop")
      ->check(number_above_zero());
  record->add_flag("--force", options.record.force, "replaces a file that is there");
  add_log_options(*record, options.record.log);
  record->callback([&] {
    set_up_logging("coppice record", options.record.log.level, options.record.log.json);
    exit_code = record_command(options.record);
  });

  auto* info = app.add_subcommand("info", "what a recording holds, and whether it is whole");
  info->add_option("file", options.recording, "recording")->required();
  info->callback([&] { exit_code = info_command(options.recording); });

  auto* replay = app.add_subcommand("replay", "says on a bus what a recording holds, to those who look on");
  replay->add_option("file", options.replay.file, "recording")->required();
  add_network_options(*replay, options.replay.network, "replayer");
  replay->add_option("--speed", options.replay.speed, "recorded seconds a second")
      ->check(number_between(least_quantity, largest_time_scale));
  replay->add_option("--from", options.replay.from, "seconds after its beginning")
      ->check(number_not_negative());
  replay->callback([&] { exit_code = replay_command(options.replay); });
}

void add_picture(CLI::App& app, PictureOptions& options, int& exit_code) {
  auto* picture = app.add_subcommand("picture", "draws a fleet out of a recording, or makes a movie of it");
  picture->add_option("recording", options.recording, "recording (MCAP)")->required();
  picture->add_option("output", options.output, "file to write: .svg or .png; of a movie .gif, .webm or .mp4")
      ->required();
  auto* time = picture->add_option("--time", options.time, "fleet seconds; without: the last moment");
  auto* movie =
      picture->add_flag("--movie", options.movie, "of all of it, or --from one time --until another");
  time->excludes(movie);
  picture->add_option("--from", options.from, "fleet seconds")->needs(movie);
  picture->add_option("--until", options.until, "fleet seconds")->needs(movie);
  picture->add_option("--fps", options.frame_rate, "frames a second")
      ->needs(movie)
      ->check(number_between(least_quantity, highest_frame_rate));
  picture->add_option("--speed", options.speed, "fleet seconds a second")
      ->needs(movie)
      ->check(number_between(least_quantity, largest_time_scale));
  picture->add_flag("--quiet", options.quiet, "says nothing");
  picture->callback([&] { exit_code = picture_command(options); });
}

}  // namespace

CLI::Option* add_recording_options(CLI::App& command, NewRecording& record, const char* of_what) {
  auto* file = command.add_option("--record", record.file, of_what)->check(output_file());
  command.add_flag("--force", record.force, "a recording that is there is replaced")->needs(file);
  return file;
}

void add_watching_commands(CLI::App& app, WatchingOptions& options, int& exit_code) {
  add_monitor(app, options.monitor, exit_code);
  add_top(app, options.top, exit_code);
  add_recordings(app, options, exit_code);
  add_picture(app, options.picture, exit_code);
}

}  // namespace coppice
