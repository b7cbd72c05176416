#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "coppice/commands.h"
#include "coppice/files/input_error.h"
#include "coppice/files/scenario_file.h"
#include "coppice/run/examination.h"
#include "coppice/run/local_fleets.h"
#include "coppice/run/log_watch.h"
#include "coppice/run/process_fleet.h"
#include "coppice/run/run_processes.h"
#include "coppice/run/state_folder.h"
#include "coppice/run/time_scale.h"
#include "coppice/run/unused_domain.h"
#include "dds/dds_bus.h"
#include "dds/discovery.h"
#include "files/output_check.h"
#include "files/pose_file.h"
#include "files/report_file.h"
#include "files/temporary_folder.h"
#include "files/text_file.h"
#include "planner_service/run/sole_service.h"
#include "ros2/names.h"
#include "runtime/journal.h"
#include "runtime/process.h"

namespace coppice {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds grace_of_roles{3000};
constexpr std::chrono::milliseconds grace_of_recorder{10000};
constexpr std::chrono::milliseconds pause_before_restart{500};
constexpr int most_refusals = 5;  // refusals in a row by the system, for a process that ran before
constexpr std::chrono::milliseconds pause_before_asking_again{2000};
constexpr std::chrono::milliseconds look_at_logs{500};
constexpr double look_around = 1;  // seconds
// Seconds per robot and fleet second to write report, trajectory and picture.
constexpr double writing = 2e-4;

/// Checked once, because all processes of a fleet on one host would report the same.
void check_servers(const FleetOptions& options) {
  const std::string servers = options.discovery.empty() ? usual_discovery_servers() : options.discovery;
  if (!are_servers(servers)) return;
  if (!options.security.empty())
    throw InputError(fmt::format(
        "--security goes without discovery servers (\"{}\"): those of this Fast DDS authenticate nobody",
        servers));
  if (!examine_servers(servers).are_usable)
    throw InputError(fmt::format("\"{}\" names no discovery servers, expected {}", servers, discovery_rule));
}

/// Creates the folder if it is missing. Throws InputError if it cannot be written to.
std::filesystem::path made_folder(const std::string& name) {
  std::error_code problem;
  std::filesystem::create_directories(name, problem);
  if (problem) throw InputError(fmt::format("{}: cannot be made: {}", name, problem.message()));
  check_output_folder(name);
  return name;
}

/// The service reads the file again. So what comes through a pipe is kept for it in `folder`.
std::string lasting_file(const std::string& file, const std::filesystem::path& folder) {
  std::error_code ignored;
  const bool is_pipe = std::filesystem::exists(file, ignored) &&
                       !std::filesystem::is_regular_file(file, ignored) &&
                       !std::filesystem::is_directory(file, ignored);
  if (!is_pipe) return file;
  const std::filesystem::path kept = folder / std::filesystem::path(file).filename();
  write_file(kept, read_file(file));
  return kept.string();
}

/// The folder for the state of processes; empty: processes keep no state. That of a standing fleet outlives
/// this run. A site that comes through a pipe has no name by which the next run would find it.
std::filesystem::path state_folder(const RunOptions& run, const FleetOptions& options, bool is_pipe,
                                   const std::filesystem::path& run_folder) {
  if (!options.state.empty()) return made_folder(options.state);
  if (run.serves && is_pipe)
    std::cerr << "the site has no file: the fleet's state is kept for this run only (--state)\n";
  if (run.serves && !is_pipe) return made_folder(usual_state_folder(run.scenario, options.domain).string());
  return options.restart ? made_folder((run_folder / "state").string()) : std::filesystem::path();
}

/// Robots stand where a file says only as a new run begins.
void check_start_at(const FleetOptions& options, const Scenario& scenario,
                    const std::filesystem::path& state) {
  if (options.start_at.empty()) return;
  read_poses(options.start_at, scenario);
  if (const auto run = journal_in(state.string(), service_name); run && !run->empty())
    throw InputError(fmt::format(
        "--start-at: {} holds a run that has not ended and goes on where its robots stand: start the fleet "
        "without --start-at, and end it before",
        state.string()));
}

void tell_of_state(const std::filesystem::path& state) {
  std::error_code ignored;
  const bool is_old = std::filesystem::exists(state / "poses.json", ignored) ||
                      std::filesystem::exists(state / "planner_service.journal", ignored);
  std::cout << fmt::format("state in {}: {}\n", state.string(),
                           is_old ? "the fleet goes on where it was" : "a new fleet")
            << std::flush;
}

/// The time that the service may take for its report after Ctrl-C. It grows with the robots, because many
/// processes on few processors respond late; with the time scale, because robots brake in fleet time; and
/// with the length of the run, because a long run writes much.
std::chrono::duration<double> patience_with(const Scenario& scenario, double time_scale,
                                            std::chrono::duration<double> run) {
  double braking = 0;  // fleet seconds
  for (const RobotTask& robot : scenario.robots) braking = std::max(braking, braking_time(limits_of(robot)));
  const auto robots = static_cast<double>(scenario.robots.size());
  return std::chrono::duration<double>(15 + 0.5 * robots + braking / time_scale) +
         writing * robots * time_scale * run;
}

void tell_of_end(const ProcessFleet::Ended& ended) {
  std::cerr << fmt::format("{} ended early, exit code {}{}{}\n", ended.name, ended.exit_code,
                           ended.log_end.empty() ? "" : ": ", ended.log_end);
}

/// Reports a time scale below 1.
double time_scale_for(std::size_t robots) {
  const double cores = usable_cores();
  const double scale = usual_time_scale(robots, cores);
  if (scale < 1)
    std::cerr << fmt::format("time scale {:.3g}: {} robots on {:g} processors (--time-scale)\n", scale,
                             robots, cores);
  return scale;
}

/// Passes Ctrl-C on to the service, repeatedly, because a service that is just starting misses it.
class StopRequest {
 public:
  bool is_there() const { return since_.has_value(); }
  bool is_older_than(std::chrono::duration<double> age) const {
    return since_ && Clock::now() - *since_ > age;
  }
  void pass_on(ProcessFleet& fleet) {
    if (!stop_requested() || Clock::now() < next_) return;
    if (!since_) since_ = Clock::now();
    next_ = Clock::now() + pause_before_asking_again;
    fleet.terminate(service_name);
  }

 private:
  std::optional<Clock::time_point> since_;
  Clock::time_point next_;
};

/// Ends the recorder last, so that it records all messages of the others. False: the recording is incomplete.
bool end_all(ProcessFleet& fleet) {
  std::vector<ProcessFleet::Ended> gone = fleet.terminate_all(grace_of_roles, recorder_name);
  std::ranges::move(fleet.terminate_all(grace_of_recorder), std::back_inserter(gone));
  const auto recorder = std::ranges::find(gone, recorder_name, &ProcessFleet::Ended::name);
  if (recorder == gone.end() || recorder->exit_code == 0) return true;
  tell_of_end(*recorder);
  return false;
}

/// The terminal may show a line of progress, which must be cleared.
void pass_on(const std::vector<std::string>& warnings) {
  const char* const clears = isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "";
  for (const std::string& line : warnings) std::cerr << clears << line << '\n';
}

/// Refuses to run beside another service, because the agents of this run would become robots of its fleet. If
/// this process does not notice the other service in this short time, the planner service does before it
/// begins.
void check_that_nobody_serves(const DdsSettings& network) {
  DdsBus bus(network, Role::viewer, "coppice run");
  ProcessClock clock;
  const WallTime until = clock.now() + look_around;
  while (clock.now() < until && !stop_requested()) {
    bus.wait(longest_wait);
    for (const Arrival& arrival : bus.take()) {
      const auto* const service = std::get_if<ServiceStatus>(arrival.message.get());
      if (service != nullptr && !bus.hears_replay())  // a replay gives way to a fleet
        throw InputError(
            fmt::format("another planner service has the fleet on domain {}: {}: end that one, or "
                        "name another --domain",
                        network.domain, description_of(*service, clock.now())));
    }
  }
}

/// Processes that ended early, and must be started again.
class ProcessRestarts {
 public:
  /// True if it will be started again.
  bool note(const ProcessFleet::Ended& ended) {
    // A wrong usage stays wrong. But the system may temporarily refuse something to a process that ran
    // before.
    int& refusals = refusals_.try_emplace(ended.name, most_refusals).first->second;
    refusals = ended.exit_code == 2 ? refusals + 1 : 0;
    if (refusals > most_refusals) return false;
    due_.emplace(Clock::now() + pause_before_restart, ended.name);
    return true;
  }
  void start_those_due(ProcessFleet& fleet) {
    if (due_.empty() || due_.begin()->first > Clock::now()) return;
    const std::string name = due_.begin()->second;
    due_.erase(due_.begin());
    try {
      fleet.start_again(name);
    } catch (const std::exception& problem) {  // there may be too many processes at the moment
      std::cerr << name << ": " << problem.what() << ": tried again\n";
      due_.emplace(Clock::now() + pause_before_restart, name);
    }
  }

 private:
  std::multimap<Clock::time_point, std::string> due_;
  std::map<std::string, int> refusals_;
};

/// Runs until the service, and with it the run, has ended. `patience`: the time to wait for the report, by
/// the length of the run. Returns the exit code.
int watch(ProcessFleet& fleet, LogWatch& logs, bool restarts,
          const std::function<std::chrono::duration<double>(std::chrono::duration<double>)>& patience) {
  const Clock::time_point begin = Clock::now();
  Clock::time_point next_look = begin;
  ProcessClock clock;
  ProcessRestarts to_start;
  StopRequest stop;
  bool recorded = true;
  while (true) {
    stop.pass_on(fleet);
    if (Clock::now() >= next_look) {
      pass_on(logs.news(clock.now()));
      next_look = Clock::now() + look_at_logs;
    }
    const auto ended = fleet.reap();
    if (!ended && stop.is_there() && stop.is_older_than(patience(Clock::now() - begin))) {
      std::cerr << "the planner service does not answer: ended without a report\n";
      fleet.terminate_all(grace_of_roles);
      pass_on(logs.last_news(clock.now()));
      return 1;
    }
    to_start.start_those_due(fleet);
    if (!ended) {
      std::this_thread::sleep_for(poll_period);
      continue;
    }
    const bool is_service = ended->name == service_name;
    const bool has_reported = is_service && ended->exit_code <= 1;
    const bool says_why = is_service && ended->exit_code <= 2;
    if (!says_why) tell_of_end(*ended);
    if (ended->name == recorder_name) recorded = false;
    // A recorder is not restarted: it would replace the incomplete recording.
    const bool may_go_on = restarts && !has_reported && !stop.is_there() && ended->name != recorder_name &&
                           to_start.note(*ended);
    if (may_go_on || !is_service) continue;
    recorded = end_all(fleet) && recorded;
    pass_on(logs.last_news(clock.now()));
    return says_why ? std::max(ended->exit_code, recorded ? 0 : 1) : 1;
  }
}

}  // namespace

int run_command(RunOptions options, const FleetOptions& fleet_options, const std::string& program) {
  // Check the input before anything starts.
  const TemporaryFolder run_folder;
  const std::string named = options.scenario;
  options.scenario = lasting_file(options.scenario, run_folder.path());
  options.plan = lasting_file(options.plan, run_folder.path());
  ScenarioOptions overrides = scenario_options(options);
  overrides.follow = fleet_options.ros.drives();
  overrides.tracking_tolerance = fleet_options.ros.tolerance;
  overrides.warnings = MapWarnings::left_out;  // the service logs them
  const Scenario scenario = read_scenario(options.scenario, overrides);
  chosen_plan(options, scenario);
  chosen_coordination(options);
  check_results(options, scenario, fleet_options.record.file);
  check_ros(fleet_options.ros, fleet_options.discovery, fleet_options.security);
  if (fleet_options.ros.on) check_ros_names(fleet_options.ros.robot.names, names_of(scenario));
  check_servers(fleet_options);
  const NewRecording& record = fleet_options.record;
  if (!record.file.empty() && !record.force && std::filesystem::exists(record.file))
    throw InputError(record.file + ": already exists (--force replaces it)");
  install_stop_signals();
  const std::filesystem::path programs = std::filesystem::canonical(program).parent_path();
  const std::filesystem::path state =
      state_folder(options, fleet_options, options.scenario != named, run_folder.path());
  std::optional<FolderLock> lock;
  if (!state.empty()) lock.emplace(state);
  FleetOptions fleet_on_domain = fleet_options;
  fleet_on_domain.start_at = lasting_file(fleet_options.start_at, run_folder.path());
  check_start_at(fleet_on_domain, scenario, state);
  const std::filesystem::path logs =
      fleet_options.logs.empty() ? run_folder.path() : made_folder(fleet_options.logs);
  if (!options.time_scale) options.time_scale = time_scale_for(scenario.robots.size());
  std::optional<UnusedDomain> own_domain;
  if (!fleet_options.domain && !fleet_options.ros.on) own_domain.emplace(run_folder.path().string());
  if (!fleet_options.domain) fleet_on_domain.domain = own_domain ? own_domain->number() : usual_ros_domain();
  const std::vector<Process> processes =
      processes_of(scenario, options, fleet_on_domain, programs, state, run_folder.path() / "black-boxes");
  if (!own_domain) check_that_nobody_serves(settings_of(fleet_on_domain, scenario.robots.size()));
  if (!options.quiet)
    std::cout << fmt::format("fleet on domain {}; watch it with: {}", *fleet_on_domain.domain,
                             watching_command(fleet_on_domain, scenario.robots.size()))
              << std::endl;
  if (!options.quiet && options.serves) tell_of_state(state);
  ProcessFleet fleet(logs);
  std::vector<std::string> logged;
  for (const Process& process : processes) {
    fleet.start(process.name, process.command, process.output, process.niceness);
    if (process.output == ProcessFleet::Output::log) logged.push_back(process.name);
  }
  LogWatch log_watch(logs, logged, !fleet_options.logs.empty());
  return watch(fleet, log_watch, fleet_options.restart, [&](std::chrono::duration<double> run) {
    return patience_with(scenario, *options.time_scale, run);
  });
}

}  // namespace coppice
