#include "coppice/bench/scale_bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/output.h"
#include "bench/statistics.h"
#include "bench/trial.h"
#include "coppice/commands.h"
#include "coppice/files/input_error.h"
#include "coppice/planning/map_generator.h"
#include "coppice/run/examination.h"
#include "coppice/run/process_fleet.h"
#include "coppice/run/time_scale.h"
#include "files/report_file.h"
#include "files/temporary_folder.h"
#include "runtime/process.h"

namespace coppice {

namespace {

constexpr int square = 64;                 // metres per side for each robot: a room on maps of the kind room
constexpr int border = 4;                  // of the maps of rooms
constexpr double period_of_agents = 0.05;  // seconds, as in robot_agent/timing.h
constexpr std::chrono::milliseconds look_at_processes{500};
constexpr std::chrono::milliseconds grace_of_run{60'000};  // for a run to end its own processes

/// Resource usage of one process, from the kernel.
struct Usage {
  std::string role;
  double cpu_seconds = 0;
  double peak_megabytes = 0;
};
using Usages = std::map<int, Usage>;

/// Reads stat and status, proc(5). A process that has gone keeps its last values.
void look_at(int process, Usages& usages) {
  const std::string folder = fmt::format("/proc/{}/", process);
  std::ifstream stat(folder + "stat");
  std::string line;
  if (!std::getline(stat, line)) return;
  const auto close = line.rfind(')');
  std::istringstream fields(line.substr(close + 1));
  std::string skipped;
  for (int field = 3; field < 14; ++field) fields >> skipped;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  double peak_kilobytes = 0;
  std::ifstream status(folder + "status");
  while (std::getline(status, line) && peak_kilobytes == 0) {
    if (line.starts_with("VmHWM:")) peak_kilobytes = std::stod(line.substr(6));
  }
  if (peak_kilobytes == 0) return;  // a zombie
  std::ifstream name(folder + "comm");
  std::getline(name, line);
  Usage& usage = usages[process];
  usage = {line, (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK)),
           std::max(usage.peak_megabytes, peak_kilobytes / 1024)};
}

void look_at_children(int parent, Usages& usages) {
  std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", parent));
  for (int child = 0; children >> child;) look_at(child, usages);
}

struct MeasuredRun {
  double began_at = 0;  ///< seconds since the Unix epoch
  double seconds = 0;   ///< wall seconds
  proto::Report report;
  Usages usages;
};

std::vector<std::string> command_of(const std::string& program, const std::string& scenario,
                                    double time_scale, const ScaleSettings& settings,
                                    const std::string& report) {
  const std::string seconds = fmt::format("{}", settings.fleet_seconds);
  std::vector<std::string> command{
      program,     "run",    scenario,     "--time-scale", fmt::format("{}", time_scale),
      "--timeout", seconds,  "--lifelong", seconds,        "--report",
      report,      "--quiet"};
  if (!settings.discovery.empty()) command.insert(command.end(), {"--discovery", settings.discovery});
  if (!settings.security.empty()) command.insert(command.end(), {"--security", settings.security});
  return command;
}

MeasuredRun run_fleet(const std::string& program, const std::string& scenario, double time_scale,
                      const ScaleSettings& settings, const std::filesystem::path& folder,
                      const ExperimentOptions& options) {
  const std::string report = (folder / "report.json").string();
  std::filesystem::remove(report);
  ProcessClock clock;
  MeasuredRun run{.began_at = clock.now(), .report = {}, .usages = {}};
  ProcessFleet fleet(folder);
  const int pid = fleet.start("run", command_of(program, scenario, time_scale, settings, report),
                              ProcessFleet::Output::log);
  while (true) {
    look_at_children(pid, run.usages);
    if (const auto ended = fleet.reap()) {
      run.seconds = clock.now() - run.began_at;
      if (!std::filesystem::exists(report))
        throw std::runtime_error(fmt::format("coppice run {} ended with {} and no report: {}", scenario,
                                             ended->exit_code, ended->log_end));
      run.report = read_report(report);
      return run;
    }
    if (options.stop()) {
      fleet.terminate_all(grace_of_run);
      throw std::runtime_error("interrupted");
    }
    std::this_thread::sleep_for(look_at_processes);
  }
}

std::string scenario_of(const std::string& map, int robots, std::uint64_t seed, double radius,
                        const std::filesystem::path& folder) {
  const int columns = static_cast<int>(std::lround(std::sqrt(robots)));
  const int rows = static_cast<int>(std::lround(static_cast<double>(robots) / columns));
  const std::string file = (folder / "scenario.json").string();
  map_command({.kind = map,
               .width = columns * square + border,
               .height = rows * square + border,
               .seed = static_cast<std::uint32_t>(seed),
               .robots = robots,
               .radius = radius,
               .output = file});
  return file;
}

template <class Fn>
std::vector<double> of_robots(const MeasuredRun& run, Fn&& fn) {
  std::vector<double> values;
  for (const auto& robot : run.report.robots()) values.push_back(fn(robot.load()));
  return values;
}

template <class Fn>
std::vector<double> of_processes(const MeasuredRun& run, const std::string& role, Fn&& fn) {
  std::vector<double> values;
  for (const auto& [pid, usage] : run.usages) {
    if (usage.role == role) values.push_back(fn(usage));
  }
  return values;
}

double sum(const std::vector<double>& values) {
  return mean(values) * static_cast<double>(values.size());
}
double most(const std::vector<double>& values) {
  return quantile(values, 1);
}

constexpr const char* nobody_knows = "-";

/// When the last pair of agents was matched, seconds after the command; "-" if some pairs are not.
std::string all_matched(const MeasuredRun& run) {
  double last = 0;
  for (const auto& robot : run.report.robots()) {
    if (static_cast<int>(robot.load().agents_matched()) + 1 < run.report.robots_size()) return nobody_knows;
    last = std::max(last, robot.load().matched_at());
  }
  return fmt::format("{:.1f}", last - run.began_at);
}

std::vector<std::string> row_of(const MeasuredRun& run, double time_scale) {
  using Load = proto::Report::Load;
  const auto per_fleet_second = [](double count, const Load& load) {
    return load.periods() > 0 ? count / (load.periods() * period_of_agents) : 0;
  };
  const auto states = of_robots(run, [&](const Load& l) { return per_fleet_second(l.states_received(), l); });
  const auto samples =
      of_robots(run, [&](const Load& l) { return per_fleet_second(l.samples_received(), l); });
  const auto bytes =
      of_robots(run, [&](const Load& l) { return static_cast<double>(l.bytes_sent() + l.bytes_received()); });
  const auto sent = of_robots(run, [](const Load& l) { return static_cast<double>(l.bytes_sent()); });
  const auto periods = of_robots(run, [](const Load& l) { return l.periods(); });
  const auto missed = of_robots(run, [](const Load& l) { return l.periods_missed(); });
  const auto p50 = of_robots(run, [](const Load& l) { return l.state_age_p50(); });
  const auto p99 = of_robots(run, [](const Load& l) { return l.state_age_p99(); });
  const auto oldest = of_robots(run, [](const Load& l) { return l.state_age_max(); });
  const auto cpu = [](const Usage& u) { return u.cpu_seconds; };
  const auto memory = [](const Usage& u) { return u.peak_megabytes; };
  const auto share = [&](double seconds) { return fmt::format("{:.1f}", 100 * seconds / run.seconds); };
  int planned = 0;
  for (const auto& robot : run.report.robots()) planned += robot.planned();
  return {std::to_string(run.report.robots_size()),
          fmt::format("{:g}", time_scale),
          all_matched(run),
          std::to_string(planned),
          fmt::format("{:.1f}", run.report.last_path_at() - run.began_at),
          fmt::format("{:.1f}", mean(states)),
          fmt::format("{:.1f}", mean(samples)),
          fmt::format("{:.0f}", sum(samples) * time_scale),
          fmt::format("{:.1f}", mean(bytes) / run.seconds / 1e3),
          fmt::format("{:.2f}", sum(sent) / run.seconds / 1e6),
          share(mean(of_processes(run, "robot_agent", cpu))),
          share(sum(of_processes(run, "tree_broker", cpu))),
          share(sum(of_processes(run, "planner_service", cpu))),
          fmt::format("{:.1f}", most(of_processes(run, "robot_agent", memory))),
          fmt::format("{:.1f}", most(of_processes(run, "tree_broker", memory))),
          fmt::format("{:.1f}", most(of_processes(run, "planner_service", memory))),
          fmt::format("{:.0f}", 1e3 * median(p50)),
          fmt::format("{:.0f}", 1e3 * median(p99)),
          fmt::format("{:.0f}", 1e3 * most(p99)),
          fmt::format("{:.0f}", 1e3 * most(oldest)),
          fmt::format("{:.2f}", 100 * sum(missed) / std::max(1.0, sum(periods))),
          std::to_string(run.report.collisions())};
}

const std::vector<std::string> columns{"robots",
                                       "time scale",
                                       "matched s",
                                       "paths",
                                       "last path s",
                                       "states/agent/fleet s",
                                       "samples/agent/fleet s",
                                       "samples/s",
                                       "kB/s agent",
                                       "MB/s all",
                                       "CPU % agent",
                                       "CPU % broker",
                                       "CPU % service",
                                       "MB agent",
                                       "MB broker",
                                       "MB service",
                                       "age p50 ms",
                                       "age p99 ms",
                                       "age p99 worst ms",
                                       "age max ms",
                                       "missed %",
                                       "collisions"};

}  // namespace

bool bench_scale(const ExperimentOptions& options, const ScaleSettings& settings,
                 const std::string& program) {
  if (options.maps.size() != 1 || !map_kind(options.maps.front()))
    throw InputError(
        "--maps: scale generates a map for each number of robots, expected one of blank, dense, maze, room");
  const TemporaryFolder folder;
  const std::string executable = std::filesystem::canonical(program).string();
  Table table{columns, {}};
  bool all_well = true;
  Series states{"states of others", {}, {}, {}};
  Series samples{"all samples", {}, {}, {}};
  const auto measure = [&](int robots) {
    const double time_scale =
        settings.time_scale.value_or(usual_time_scale(static_cast<std::size_t>(robots), usable_cores()));
    options.tell(fmt::format("{} robots, {} fleet seconds at time scale {:g}", robots, settings.fleet_seconds,
                             time_scale));
    const std::string scenario =
        scenario_of(options.maps.front(), robots, options.first_seed, options.radius, folder.path());
    const MeasuredRun run = run_fleet(executable, scenario, time_scale, settings, folder.path(), options);
    table.rows.push_back(row_of(run, time_scale));
    const auto number = [&](std::size_t column) { return std::stod(table.rows.back()[column]); };
    states.x.push_back(robots);
    states.y.push_back(number(5));
    samples.x.push_back(robots);
    samples.y.push_back(number(6));
    all_well = all_well && table.rows.back()[2] != nobody_knows && run.report.collisions() == 0;
    // Written after each run, because the next one may fail.
    options.tell(as_markdown(table));
    write_experiment(options, "scale", table, table,
                     {{"received by an agent", "robots", "a fleet second", false, {states, samples}}}, 1);
    if (!settings.report.empty()) write_file(std::filesystem::path(settings.report), as_json(table));
  };
  for (const int robots : options.robots) {
    if (options.stop()) break;
    all_well &= succeeds(options, options.maps.front(), robots, [&] { measure(robots); });
  }
  return all_well;
}

}  // namespace coppice
