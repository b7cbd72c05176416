// planner_service --domain D SCENARIO: hands out the missions of a scenario, shows progress, writes the
// report.

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "dds/dds_bus.h"
#include "dds/discovery.h"
#include "files/input_error.h"
#include "files/picture.h"
#include "files/report_file.h"
#include "files/run_options.h"
#include "files/scenario_file.h"
#include "files/temporary_folder.h"
#include "messages/keep.h"
#include "messages/validation.h"
#include "planner_service/options.h"
#include "planner_service/planner_service.h"
#include "planner_service/progress.h"
#include "planner_service/robot_assignment.h"
#include "planner_service/roll_call.h"
#include "planner_service/run_record.h"
#include "planner_service/sole_service.h"
#include "planner_service/startup_barrier.h"
#include "ros2/dds_ros.h"
#include "ros2/names.h"
#include "runtime/command_line.h"
#include "runtime/journal.h"
#include "runtime/process.h"

namespace {

using namespace coppice;

constexpr double worth_telling = 3;            // seconds
constexpr std::uint32_t refusals_logged = 10;  // then every thousandth

/// The identity of this process among services. Each start draws a new one.
ServiceStatus own_status() {
  std::random_device device;
  ServiceStatus own{.service = (static_cast<std::uint64_t>(device()) << 32) | device() | 1u,
                    .process = static_cast<std::uint32_t>(getpid()),
                    .since = wall_now()};
  std::array<char, longest_name + 1> host{};
  if (gethostname(host.data(), longest_name) == 0) own.host = host.data();
  return own;
}

[[noreturn]] void refuse(const ServiceStatus& other, int domain) {
  throw std::runtime_error(fmt::format(
      "another planner service has the fleet on domain {}: {}: end that one, or name another --domain",
      domain, description_of(other, wall_now())));
}

/// Beside the service: who is which robot, whether another service has the fleet, and who has not come.
struct Reception {
  RobotAssignment desk;
  SoleService sole;
  RollCall roll;

  Reception(const std::vector<RobotName>& robots, WallTime now)
      : desk(robots, now), sole(own_status(), now), roll(robots, now) {}

  void on(const Arrival& arrival) {
    desk.on(arrival);
    sole.on(arrival);
    roll.on(arrival);
  }
  WallTime next_wake() const { return std::min(desk.next_wake(), sole.next_wake()); }
  /// Gives away no robot before it knows that it may.
  void step(DdsBus& bus) {
    KeepsNothing keeper;
    step_role(bus, sole, keeper);
    if (sole.may_begin(wall_now())) step_role(bus, desk, keeper);
    for (const ServiceStatus& other : sole.take_inferiors())
      spdlog::warn("another planner service is on this domain, and is to end: {}",
                   description_of(other, wall_now()));
  }
};

/// Returns what arrives until no other service can have the fleet and `done()` holds.
template <class Done>
StartupBarrier listen(DdsBus& bus, Reception& reception, Heartbeat& heart, int domain, Done&& done) {
  StartupBarrier heard;
  while ((!reception.sole.may_begin(wall_now()) || !done(heard)) && !stop_requested()) {
    bus.wait(longest_wait);
    for (Arrival& arrival : bus.take()) {
      reception.on(arrival);
      heard.add(std::move(arrival));
    }
    if (const auto other = reception.sole.superior()) refuse(*other, domain);
    reception.step(bus);
    heart.beat(wall_now());
  }
  return heard;
}

/// Until an agent for each robot, and a broker, can hear of its mission, and those of a large fleet have
/// found each other: on few processors they do so sooner while none of them drives. Who has not come by then
/// gets its mission when it does.
StartupBarrier wait_for_agents(DdsBus& bus, Reception& reception, Heartbeat& heart, std::size_t robots,
                               int domain) {
  const WallTime begin = wall_now();
  const WallTime latest = begin + 1 + 0.2 * static_cast<double>(robots);
  StartupBarrier all = listen(bus, reception, heart, domain, [&](const StartupBarrier& heard) {
    const bool met = std::cmp_less(robots, large_fleet) || heard.is_synchronised(robots - 1) >= robots;
    return (met && bus.matched_readers<Mission>() >= robots + 1) || wall_now() >= latest;
  });
  const double waited = wall_now() - begin;
  if (waited > worth_telling)
    spdlog::info("after {:.1f} s {} of {} processes have come, and {} agents have found all others", waited,
                 bus.matched_readers<Mission>(), robots + 1, all.is_synchronised(robots - 1));
  return all;
}

/// What a service that was killed has kept of its run, if one has.
std::optional<Journal> journal_of_service(const std::string& folder) {
  auto journal = journal_in(folder, "planner_service");
  if (journal && !journal->complete())
    throw InputError(
        journal->file().string() +
        ": the disk was full when it was written, so that the run cannot go on from it. Stop all agents, "
        "stand the robots at the starts of the scenario, and remove it: a new run takes every robot to be "
        "there");
  return journal;
}

/// Goes on with the run that was kept; message by message, for an hour of a large fleet is hundreds of
/// megabytes.
RunRecord go_on(PlannerService& service, RobotAssignment& desk, const Journal& journal, Heartbeat& heart) {
  RunRecord record;
  journal.for_each([&](const Message& message) {
    heart.beat(wall_now());
    if (!service.recall({&message, 1}, wall_now()))
      throw InputError(journal.file().string() +
                       ": is of another run: end that one, remove the file, or name another folder");
    record.recall({&message, 1});
    desk.recall({&message, 1}, wall_now());
  });
  return record;
}

/// Where there is room for what is kept, if that is told.
std::filesystem::path folder_for_tracks(const ProcessOptions& process) {
  return process.state.empty() ? place_for_temporary_files() : std::filesystem::path(process.state);
}

/// Its topics in ROS, where it has any.
std::unique_ptr<DdsRosFleet> ros_of(const RosOptions& options, DdsBus& bus, const Scenario& scenario) {
  if (!options.on) return nullptr;
  auto ros = std::make_unique<DdsRosFleet>(bus, names_of(scenario));
  ros->publish(scenario.map, wall_now());
  return ros;
}

void take_goals(DdsRosFleet& ros, PlannerService& service) {
  for (const RosGoal& goal : ros.take()) {
    if (const auto problem = service.on(goal)) {
      const std::uint32_t refused = service.goals_refused();
      if (refused <= refusals_logged || refused % 1000 == 0)
        spdlog::warn("refused a goal of {}: {} ({} refused so far)", goal.robot, *problem, refused);
    } else {
      spdlog::info("{} is wanted elsewhere", goal.robot);
    }
  }
}

/// Says once of each robot that it gets no new goal. `told`: of whom that was said last time.
void tell_of_missing_goals(const PlannerService& service, std::vector<std::string>& told) {
  std::vector<std::string> without = service.robots_without_goal();
  for (const std::string& line : without) {
    if (std::ranges::count(told, line) == 0) spdlog::warn("{}", line);
  }
  told = std::move(without);
}

/// The service and its reception on one bus, until the run has ended, or another service has its fleet.
/// `display`: null: shows nothing.
void serve(DdsBus& bus, DdsRosFleet* ros, PlannerService& service, Reception& reception,
           Keeper<RunRecord, Journal>& keeper, Heartbeat& heart, ProgressDisplay* display, int domain) {
  std::vector<std::string> without_goal;
  while (!service.finished()) {
    if (stop_requested()) service.interrupt();
    bus.wait(
        std::clamp(std::min(service.next_wake(), reception.next_wake()) - wall_now(), 0.0, longest_wait));
    for (const Arrival& arrival : bus.take()) {
      keeper.heard(*arrival.message);
      service.on(arrival);
      reception.on(arrival);
    }
    if (const auto other = reception.sole.superior()) {
      if (!service.run()) refuse(*other, domain);  // no agent has heard of this one
      service.interrupt();
    }
    if (ros != nullptr) take_goals(*ros, service);
    step_role(bus, service, keeper);
    tell_of_missing_goals(service, without_goal);
    if (service.run()) reception.sole.begin(*service.run());
    reception.step(bus);
    for (const std::string& line : reception.roll.step(wall_now())) spdlog::warn("{}", line);
    heart.beat(wall_now());
    if (display != nullptr) display->show(service.progress(wall_now()), wall_now());
  }
  if (display != nullptr) display->finish(service.progress(wall_now()));
}

/// The run, and what is written of it. True if it succeeded.
bool run_succeeds(const RunOptions& options, const ProcessOptions& process, const RosOptions& in_ros,
                  Scenario scenario, Journal* journal) {
  TrackRecord tracks = TrackRecord::on_disk(folder_for_tracks(process));
  DdsBus bus(process.network, Role::service, "planner_service");
  Heartbeat heart(process.alive);
  const auto ros = ros_of(in_ros, bus, scenario);
  const int domain = process.network.domain;
  Reception reception(names_of(scenario), wall_now());
  const bool goes_on = journal != nullptr && !journal->empty();
  StartupBarrier heard;
  if (!goes_on) heard = wait_for_agents(bus, reception, heart, scenario.robots.size(), domain);
  PlannerService service(std::move(scenario),
                         {.time_scale = options.time_scale.value_or(1),
                          .timeout = options.timeout,
                          .planner = chosen_planner(options),
                          .plan_budget = options.plan_budget.value_or(default_plan_budget),
                          .lifelong = options.lifelong,
                          .waits_for_goals = in_ros.waits_for_goals,
                          .margin = in_ros.drives ? in_ros.tolerance : 0},
                         wall_now(), std::move(tracks));
  Keeper keeper(journal != nullptr ? go_on(service, reception.desk, *journal, heart) : RunRecord(), journal);
  if (service.run()) reception.sole.begin(*service.run());
  if (goes_on) heard = listen(bus, reception, heart, domain, [](const StartupBarrier&) { return true; });
  heard.for_each([&](const Arrival& arrival) {
    keeper.heard(*arrival.message);
    service.on(arrival);
  });
  heard = StartupBarrier();  // it may hold the tracks of the run before
  ProgressDisplay display(std::cout, ::isatty(STDOUT_FILENO) == 1);
  serve(bus, ros.get(), service, reception, keeper, heart, options.quiet ? nullptr : &display, domain);
  const proto::Report report = service.report();
  if (!options.quiet) std::cout << '\n' << report_table(report) << std::flush;
  write_results(options, report, service.tracks(), [&] { return service.picture(); });
  if (const auto other = reception.sole.superior()) refuse(*other, domain);
  return service.succeeded();
}

/// Exit code: 0 if the run succeeded.
int run(const RunOptions& options, const ProcessOptions& process, const RosOptions& in_ros) {
  check_ros(in_ros, process.network.discovery, process.network.security);
  Scenario scenario = read_scenario(options.scenario, options.overrides);
  check_results(options, scenario);
  if (in_ros.on) check_ros_names(names_of(scenario));
  auto journal = journal_of_service(process.state);
  const bool all = run_succeeds(options, process, in_ros, std::move(scenario), journal ? &*journal : nullptr);
  // Last of all: one that is killed before that, and started anew, ends this run again, and begins none.
  if (journal) std::filesystem::remove(journal->file());
  return all ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  fill_standard_streams();
  CLI::App app;
  ServiceOptions options;
  add_service_options(app, options);
  if (const auto exit_code = parse(app, argc, argv)) return *exit_code;
  set_up_logging("planner_service", options.process.log.level, options.process.log.json);
  install_stop_signals();
  return exit_code_of([&] { return run(options.run, options.process, options.ros); });
}
