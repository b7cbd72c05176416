#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bus/process.h"
#include "coppice/commands.h"
#include "monitor/monitor.h"
#include "monitor/player.h"
#include "monitor/rhythm.h"

namespace coppice {

namespace {

constexpr double turn_seconds = 0.01;  // the bus is looked at, and pages are told, so often
constexpr double count_period = 1;     // seconds
constexpr double state_period = 0.25;  // of a recording that is played

std::uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");  // in pages: proc(5)
  std::uint64_t total = 0;
  std::uint64_t resident = 0;
  file >> total >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// In whatever browser the desktop has; where there is none, the address that was printed has to do.
void open_browser(std::string url) {
  std::string program = "xdg-open";
  char* const arguments[] = {program.data(), url.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments, environ);
  int status = 0;
  if (error != 0 || waitpid(child, &status, 0) != child || status != 0)
    std::cerr << "xdg-open does not open a browser here\n";
}

void tell(const Monitor& monitor, const MonitorOptions& options) {
  std::cout << monitor.url() << std::endl;
  if (options.open) open_browser(monitor.url());
}

/// What drives now; nobody steers it from here.
void show_fleet(const MonitorOptions& options) {
  give_way();
  Monitor monitor(options.web, fmt::format("domain {}", options.network.domain));
  DdsBus bus(options.network, Role::viewer, "monitor");
  tell(monitor, options);
  Rhythm count_rhythm(count_period);
  while (!stop_requested()) {
    monitor.take(bus.take());
    const WallTime now = wall_now();
    if (count_rhythm.due(now)) monitor.note(bus.counts(), resident_bytes());
    monitor.turn(now, now, turn_seconds);
    monitor.wishes();
  }
}

void show_recording(const MonitorOptions& options) {
  const Recording recording(options.recording);
  Monitor monitor(options.web, std::filesystem::path(options.recording).filename().string(), true);
  tell(monitor, options);
  Player player(recording, wall_now());
  Rhythm state_rhythm(state_period);
  while (!stop_requested()) {
    const WallTime now = wall_now();
    bool steered = false;
    const std::vector<live::FromPage> wishes = monitor.wishes();
    const auto seeks = [](const live::FromPage& wish) { return wish.has_seek(); };
    for (auto wish = wishes.begin(); wish != wishes.end(); ++wish) {
      // Each reads the recording anew: of those of a page that is dragged the last counts.
      if (seeks(*wish) && std::any_of(wish + 1, wishes.end(), seeks)) continue;
      if (player.heed(*wish, now)) monitor.forget();
      steered = true;
    }
    monitor.take(player.due(now));
    if (state_rhythm.due(now) || steered) monitor.show(player.state(now));
    monitor.turn(player.at(now), now, turn_seconds);
  }
}

}  // namespace

int monitor_command(const MonitorOptions& options) {
  install_stop_signals();
  options.recording.empty() ? show_fleet(options) : show_recording(options);
  return 0;
}

}  // namespace coppice
