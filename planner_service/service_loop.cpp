#include "planner_service/service_loop.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "coppice/files/input_error.h"
#include "dds/discovery.h"
#include "messages/validation.h"
#include "planner_service/timing.h"

namespace coppice {

namespace {

constexpr std::uint32_t refusals_logged = 10;  // then every thousandth

ServiceStatus status_of(std::uint64_t identity) {
  ServiceStatus own{
      .service = identity, .process = static_cast<std::uint32_t>(getpid()), .since = wall_now()};
  std::array<char, longest_name + 1> host{};
  if (gethostname(host.data(), longest_name) == 0) own.host = host.data();
  return own;
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

/// What the service says is saved, and the history tells of orders.
struct Record {
  Keeper<RunKeeper, Journal>& saved;
  OrderHistory* history;  ///< null: none is kept

  void said(const Message& message) {
    saved.said(message);
    if (history != nullptr) history->said(message);
  }
};

}  // namespace

std::optional<Journal> open_journal(const std::string& folder) {
  auto journal = journal_in(folder, "planner_service");
  if (journal && !journal->complete())
    throw InputError(
        journal->file().string() +
        ": the disk was full when it was written, so that the run cannot go on from it. Stop all agents, "
        "stand the robots at the starts of the scenario, and remove it: a new run takes every robot to be "
        "there");
  return journal;
}

ServiceLoop::ServiceLoop(DdsBus& bus, Heartbeat& heart, std::uint64_t identity,
                         const std::vector<RobotName>& robots, int domain)
    : bus_(bus),
      heart_(heart),
      domain_(domain),
      robots_(robots.size()),
      assignment_(robots, wall_now()),
      sole_(status_of(identity), wall_now()),
      roll_(robots, wall_now()) {}

void ServiceLoop::check_precedence() const {
  if (const auto other = sole_.superior())
    throw std::runtime_error(fmt::format(
        "another planner service has the fleet on domain {}: {}: end that one, or name another --domain",
        domain_, description_of(*other, wall_now())));
}

void ServiceLoop::on(const Arrival& arrival) {
  assignment_.on(arrival);
  sole_.on(arrival);
  roll_.on(arrival);
}

WallTime ServiceLoop::next_wake() const {
  return std::min(assignment_.next_wake(), sole_.next_wake());
}

/// It assigns no robot before it may begin a run.
void ServiceLoop::step() {
  KeepsNothing keeper;
  step_role(bus_, sole_, keeper);
  if (sole_.may_begin(wall_now())) step_role(bus_, assignment_, keeper);
  for (const ServiceStatus& other : sole_.take_inferiors())
    spdlog::warn("another planner service is on this domain, and is to end: {}",
                 description_of(other, wall_now()));
}

/// Returns what arrives until no other service can have the fleet and `done(heard)` holds.
template <class Done>
StartupBarrier ServiceLoop::listen(Done&& done) {
  StartupBarrier heard;
  while ((!sole_.may_begin(wall_now()) || !done(heard)) && !stop_requested()) {
    bus_.wait(longest_wait);
    for (Arrival& arrival : bus_.take()) {
      on(arrival);
      heard.add(std::move(arrival));
    }
    check_precedence();
    step();
    heart_.beat(wall_now());
  }
  return heard;
}

StartupBarrier ServiceLoop::wait_for_agents() {
  const WallTime begin = wall_now();
  const WallTime latest =
      begin + service_timing.startup_base + service_timing.startup_per_robot * static_cast<double>(robots_);
  StartupBarrier all = listen([&](const StartupBarrier& heard) {
    const bool discovered =
        std::cmp_less(robots_, large_fleet) || heard.agents_that_discovered(robots_ - 1) >= robots_;
    return (discovered && bus_.matched_readers<Mission>() >= robots_ + 1) || wall_now() >= latest;
  });
  const double waited = wall_now() - begin;
  if (waited > service_timing.startup_worth_logging)
    spdlog::info("after {:.1f} s {} of {} processes have come, and {} agents have found all others", waited,
                 bus_.matched_readers<Mission>(), robots_ + 1, all.agents_that_discovered(robots_ - 1));
  return all;
}

StartupBarrier ServiceLoop::wait_for_other_services() {
  return listen([](const StartupBarrier&) { return true; });
}

RunKeeper ServiceLoop::resume(PlannerService& service, const Journal& journal) {
  RunKeeper saved;
  journal.for_each([&](const Message& message) {
    heart_.beat(wall_now());
    if (!service.recall({&message, 1}, wall_now()))
      throw InputError(journal.file().string() +
                       ": is of another run: end that one, remove the file, or name another folder");
    saved.recall({&message, 1});
    assignment_.recall({&message, 1}, wall_now());
  });
  if (service.run()) sole_.begin(*service.run());
  return saved;
}

/// Logs once for each robot that it gets no new goal.
void ServiceLoop::log_missing_goals(const PlannerService& service) {
  std::vector<std::string> lines = service.robots_without_goal();
  for (const std::string& line : lines) {
    if (std::ranges::count(without_goal_, line) == 0) spdlog::warn("{}", line);
  }
  without_goal_ = std::move(lines);
}

void ServiceLoop::serve(PlannerService& service, Keeper<RunKeeper, Journal>& keeper, OrderHistory* history,
                        DdsRosFleet* ros, ProgressDisplay* display) {
  Record record{keeper, history};
  while (!service.finished()) {
    if (stop_requested()) service.interrupt();
    bus_.wait(std::clamp(std::min(service.next_wake(), next_wake()) - wall_now(), 0.0, longest_wait));
    for (const Arrival& arrival : bus_.take()) {
      keeper.heard(*arrival.message);
      service.on(arrival);
      on(arrival);
    }
    if (sole_.superior()) {
      if (!service.run()) check_precedence();  // no agent has heard of this service
      service.interrupt();
    }
    if (ros != nullptr) take_goals(*ros, service);
    step_role(bus_, service, record);
    log_missing_goals(service);
    if (service.run()) sole_.begin(*service.run());
    step();
    for (const std::string& line : roll_.step(wall_now())) spdlog::warn("{}", line);
    heart_.beat(wall_now());
    if (display != nullptr) display->show(service.progress(wall_now()), wall_now());
  }
  if (display != nullptr) display->finish(service.progress(wall_now()));
}

}  // namespace coppice
