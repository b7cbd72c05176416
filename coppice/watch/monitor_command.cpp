#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "coppice/commands.h"
#include "coppice/files/input_error.h"
#include "coppice/orders/order_id.h"
#include "files/text_file.h"
#include "monitor/monitor.h"
#include "monitor/recording/player.h"
#include "monitor/view/rhythm.h"
#include "runtime/process.h"

namespace coppice {

namespace {

constexpr double turn_seconds = 0.01;  // seconds: the loop reads the bus and serves pages once in this time
constexpr double turn_with_debts = 0.001;   // seconds, while clients wait for what becomes of their orders
constexpr std::size_t shortest_token = 16;  // characters: none that is shorter is hard to guess
constexpr double count_period = 1;          // seconds
constexpr double state_period = 0.25;       // seconds, for a recording that is played
constexpr double last_words = 0.4;          // seconds in which open pages receive the end of a run

std::uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");  // in pages: proc(5)
  std::uint64_t total = 0;
  std::uint64_t resident = 0;
  file >> total >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Without a desktop, xdg-open would open a text browser in the terminal, over other output.
bool has_desktop() {
  const auto is_set = [](const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
}

/// Opens the desktop's browser, if there is a desktop.
void open_browser(std::string url) {
  if (!has_desktop()) return;
  std::string program = "xdg-open";
  char* const arguments[] = {program.data(), url.data(), nullptr};
  posix_spawn_file_actions_t silently;
  posix_spawn_file_actions_init(&silently);
  posix_spawn_file_actions_addopen(&silently, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&silently, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &silently, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&silently);
  // On some desktops xdg-open runs as long as the browser.
  if (error == 0) std::thread([child] { waitpid(child, nullptr, 0); }).detach();
}

/// Prints the address in a line by itself, for hosts without a browser.
void tell(const Monitor& monitor, const MonitorOptions& options) {
  if (options.web.port != 0 && monitor.port() != options.web.port)
    std::cerr << fmt::format("port {} is taken: the page is at port {}\n", options.web.port, monitor.port());
  std::cout << monitor.url() << std::endl;
  if (options.open) open_browser(monitor.url());
}

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The first line of the file.
std::string token_in(const std::string& file) {
  const std::string text = read_text(file);
  const std::string token = text.substr(0, text.find_first_of("\r\n"));
  if (token.size() < shortest_token)
    throw InputError(fmt::format("{}:1: expected a token of at least {} characters, found {}", file,
                                 shortest_token, token.size()));
  return token;
}

/// Shows the live fleet. Wishes of pages are ignored. With a token, clients that show it give orders, which
/// must not wait for other processes.
void show_fleet(const MonitorOptions& options, const WebSettings& web) {
  if (!options.control) give_way();
  Monitor monitor(web, fmt::format("domain {}", options.network.domain), false, draw_order_id);
  DdsBus bus(options.network, options.control ? Role::dispatcher : Role::viewer, "monitor");
  tell(monitor, options);
  ProcessClock clock;
  Rhythm count_rhythm(count_period);
  std::optional<WallTime> asked_to_stop;
  while (true) {
    const WallTime now = clock.now();
    if (stop_requested() && !asked_to_stop) asked_to_stop = now;
    const bool tells_of_the_end = monitor.is_watched() && asked_to_stop && now - *asked_to_stop < last_words;
    if (asked_to_stop && !tells_of_the_end) return;
    monitor.take(take(bus, clock));
    monitor.note_replay(bus.hears_replay());
    if (count_rhythm.due(now)) {
      monitor.note(processor_seconds(), resident_bytes(), bus.counts().rejected);
    }
    monitor.turn(now, now, monitor.owes_replies() ? turn_with_debts : turn_seconds);
    for (const OrderMessage& order : monitor.take_orders()) bus.publish(Message(order));
    monitor.wishes();
  }
}

void show_recording(const MonitorOptions& options) {
  const Recording recording(options.recording);
  Monitor monitor(options.web, std::filesystem::path(options.recording).filename().string(), true);
  tell(monitor, options);
  ProcessClock clock;
  Player player(recording, clock.now());
  Rhythm state_rhythm(state_period);
  Rhythm count_rhythm(count_period);
  while (!stop_requested()) {
    const WallTime now = clock.now();
    bool steered = false;
    const std::vector<live::FromPage> wishes = monitor.wishes();
    const auto seeks = [](const live::FromPage& wish) { return wish.has_seek(); };
    for (auto wish = wishes.begin(); wish != wishes.end(); ++wish) {
      // Each seek reads the recording anew. Of the seeks of a dragged page only the last one counts.
      if (seeks(*wish) && std::any_of(wish + 1, wishes.end(), seeks)) continue;
      if (player.heed(*wish, now)) monitor.forget();
      steered = true;
    }
    monitor.take(player.due(now));
    if (count_rhythm.due(now)) monitor.note(processor_seconds(), resident_bytes());
    if (state_rhythm.due(now) || steered) monitor.show(player.state(now));
    monitor.turn(player.at(now), now, turn_seconds);
  }
}

}  // namespace

int monitor_command(const MonitorOptions& options) {
  install_stop_signals();
  WebSettings web = options.web;
  if (options.control) web.token = token_in(options.token_file);
  options.recording.empty() ? show_fleet(options, web) : show_recording(options);
  return 0;
}

}  // namespace coppice
