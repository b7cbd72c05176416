#include "planner_service/run/service_loop.h"

#include <algorithm>
#include <array>
#include <memory>
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

constexpr std::uint32_t refusals_logged = 10;       // then every thousandth
constexpr std::size_t room_for_orders = 512 << 10;  // bytes: thousand orders, or a minute of tracks
constexpr std::size_t least_free_room = 256 << 10;  // bytes that new orders leave to those that are there
constexpr WallTime between_looks_at_disk = 0.25;    // seconds

ServiceStatus status_of(std::uint64_t identity, WallTime now) {
  ServiceStatus own{.service = identity, .process = static_cast<std::uint32_t>(getpid()), .since = now};
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
  void sync() { saved.sync(); }
};

}  // namespace

std::optional<Journal> open_journal(const std::string& folder, bool serves) {
  auto journal = journal_in(folder, "planner_service", serves ? room_for_orders : no_room);
  if (journal && !journal->complete())
    throw InputError(
        journal->file().string() +
        (serves ? ": the disk was full when it was written, so that the run cannot go on from it. Stop all "
                  "agents, remove it, and say where the robots stand (--start-at)"
                : ": the disk was full when it was written, so that the run cannot go on from it. Stop all "
                  "agents, stand the robots at the starts of the scenario, and remove it: a new run takes "
                  "every robot to be there"));
  return journal;
}

ServiceLoop::ServiceLoop(DdsBus& bus, Heartbeat& heart, ProcessClock& clock, std::uint64_t identity,
                         const std::vector<RobotName>& robots, int domain)
    : bus_(bus),
      heart_(heart),
      clock_(clock),
      domain_(domain),
      robots_(robots.size()),
      assignment_(robots, clock.now()),
      sole_(status_of(identity, clock.now()), clock.now()),
      roll_(robots, clock.now()) {}

/// The deadline of an order is by the clock of the system of whoever gives it.
std::vector<Arrival> ServiceLoop::take() {
  std::vector<Arrival> arrivals = coppice::take(bus_, clock_);
  for (Arrival& arrival : arrivals) {
    const auto* const order = std::get_if<OrderMessage>(arrival.message.get());
    if (order == nullptr || order->deadline == 0) continue;
    OrderMessage by_own_clock = *order;
    by_own_clock.deadline = std::max(0.0, clock_.from_system(order->deadline));
    arrival.message = std::make_shared<const Message>(std::move(by_own_clock));
  }
  return arrivals;
}

void ServiceLoop::check_precedence() const {
  if (const auto other = sole_.superior())
    throw std::runtime_error(fmt::format(
        "another planner service has the fleet on domain {}: {}: end that one, or name another --domain",
        domain_, description_of(*other, clock_.now())));
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
  step_role(bus_, sole_, keeper, clock_);
  if (sole_.may_begin(clock_.now())) step_role(bus_, assignment_, keeper, clock_);
  for (const ServiceStatus& other : sole_.take_inferiors())
    spdlog::warn("another planner service is on this domain, and is to end: {}",
                 description_of(other, clock_.now()));
}

/// Returns what arrives until no other service can have the fleet and `done(heard)` holds.
template <class Done>
StartupBarrier ServiceLoop::listen(Done&& done) {
  StartupBarrier heard;
  while ((!sole_.may_begin(clock_.now()) || !done(heard)) && !stop_requested()) {
    bus_.wait(longest_wait);
    for (Arrival& arrival : take()) {
      on(arrival);
      heard.add(std::move(arrival));
    }
    check_precedence();
    step();
    heart_.beat(clock_.now());
  }
  return heard;
}

StartupBarrier ServiceLoop::wait_for_agents() {
  const WallTime begin = clock_.now();
  const WallTime latest =
      begin + service_timing.startup_base + service_timing.startup_per_robot * static_cast<double>(robots_);
  StartupBarrier all = listen([&](const StartupBarrier& heard) {
    const bool discovered =
        std::cmp_less(robots_, large_fleet) || heard.agents_that_discovered(robots_ - 1) >= robots_;
    return (discovered && bus_.matched_readers<Mission>() >= robots_ + 1) || clock_.now() >= latest;
  });
  const double waited = clock_.now() - begin;
  if (waited > service_timing.startup_worth_logging)
    spdlog::info("after {:.1f} s {} of {} processes have come, and {} agents have found all others", waited,
                 bus_.matched_readers<Mission>(), robots_ + 1, all.agents_that_discovered(robots_ - 1));
  return all;
}

StartupBarrier ServiceLoop::wait_for_other_services() {
  return listen([](const StartupBarrier&) { return true; });
}

void ServiceLoop::resume(PlannerService& service, const Journal& journal, RunKeeper& saved) {
  const auto expect = [&](bool is_of_this_run) {
    if (!is_of_this_run)
      throw InputError(journal.file().string() +
                       ": is of another run: end that one, remove the file, or name another folder");
  };
  const auto recall_message = [&](const Message& message) {
    heart_.beat(clock_.now());
    expect(service.recall({&message, 1}, clock_.now()));
    saved.recall({&message, 1});
    assignment_.recall({&message, 1}, clock_.now());
  };
  const auto recall_figures = [&](const std::string& note) {
    proto::SavedRun figures;
    expect(figures.ParseFromString(note) && service.recall(figures));
  };
  journal.for_each(recall_message, recall_figures);
}

/// Logs once for each robot that it gets no new goal.
void ServiceLoop::log_missing_goals(const PlannerService& service) {
  std::vector<std::string> lines = service.robots_without_goal();
  for (const std::string& line : lines) {
    if (std::ranges::count(without_goal_, line) == 0) spdlog::warn("{}", line);
  }
  without_goal_ = std::move(lines);
}

/// Rewrites a long journal, and looks whether its disk has room for more orders.
void ServiceLoop::tend(Journal& journal, PlannerService& service) {
  const WallTime now = clock_.now();
  const bool is_due = now >= next_look_at_disk_;
  if (!is_due && (!journal.complete() || !journal.wants_rewriting())) return;
  if (service.run() && journal.wants_rewriting()) {
    const PlannerService::Snapshot whole = service.snapshot();
    journal.rewrite(whole.messages, whole.figures.SerializeAsString());
  }
  if (!is_due) return;
  next_look_at_disk_ = now + between_looks_at_disk;
  const std::string folder = journal.file().parent_path().string();
  const std::optional<std::size_t> room = free_room(folder);
  const bool has_room = journal.complete() && room >= least_free_room;
  std::string problem;
  if (!has_room) {
    problem = room ? fmt::format("{}the disk of {} is full", cannot_be_saved, folder)
                   : fmt::format("{}{} is gone", cannot_be_saved, folder);
    problem.resize(std::min(problem.size(), longest_reason));
  }
  if (problem == problem_) return;
  if (has_room) {
    spdlog::info("{} has room again: new orders are taken up", folder);
  } else {
    spdlog::error("new orders are refused, and all others go on: {}", problem);
  }
  problem_ = problem;
  service.refuse_orders(problem);
  sole_.tell(std::move(problem));
}

void ServiceLoop::serve(PlannerService& service, Keeper<RunKeeper, Journal>& keeper, OrderHistory* history,
                        DdsRosFleet* ros, ProgressDisplay* display) {
  Record record{keeper, history};
  while (!service.finished()) {
    if (stop_requested()) service.interrupt();
    bus_.wait(std::clamp(std::min(service.next_wake(), next_wake()) - clock_.now(), 0.0, longest_wait));
    for (const Arrival& arrival : take()) {
      keeper.heard(*arrival.message);
      service.on(arrival);
      on(arrival);
    }
    if (sole_.superior()) {
      if (!service.run()) check_precedence();  // no agent has heard of this service
      service.interrupt();
    }
    if (ros != nullptr) take_goals(*ros, service);
    step_role(bus_, service, record, clock_);
    if (Journal* const journal = keeper.store()) tend(*journal, service);
    log_missing_goals(service);
    if (service.run()) sole_.begin(*service.run());
    step();
    for (const std::string& line : roll_.step(clock_.now())) spdlog::warn("{}", line);
    heart_.beat(clock_.now());
    if (display != nullptr) display->show(service.progress(clock_.now()), clock_.now());
  }
  if (display != nullptr) display->finish(service.progress(clock_.now()));
}

}  // namespace coppice
