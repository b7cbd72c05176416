// The loop of the planner_service process: it joins the service, and the roles beside it, to the bus.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dds/dds_bus.h"
#include "messages/keep.h"
#include "planner_service/run/planner_service.h"
#include "planner_service/run/progress.h"
#include "planner_service/run/robot_assignment.h"
#include "planner_service/run/roll_call.h"
#include "planner_service/run/saved_run.h"
#include "planner_service/run/sole_service.h"
#include "planner_service/run/startup_barrier.h"
#include "ros2/dds_ros.h"
#include "runtime/journal.h"
#include "runtime/order_history.h"
#include "runtime/process.h"

namespace coppice {

/// The journal of this process, or of the one that was killed before it. None: `folder` is empty. Throws
/// InputError if no run can go on from it. `serves`: the run does not end, so the journal is rewritten when
/// it is long. That of another run grows with its tracks, which its report is made of.
std::optional<Journal> open_journal(const std::string& folder, bool serves);

/// If another service has precedence, the waiting functions throw std::runtime_error. serve() does so as long
/// as no agent has heard of this service. After that it ends the run.
class ServiceLoop {
 public:
  /// `bus`, `heart` and `clock` outlive it. `identity`: of this process among services. `robots`: those of
  /// the scenario. `domain`: for messages to the user.
  ServiceLoop(DdsBus& bus, Heartbeat& heart, ProcessClock& clock, std::uint64_t identity,
              const std::vector<RobotName>& robots, int domain);

  /// Waits until no other service can have the fleet, and a new run can begin: an agent for each robot, and a
  /// broker, can hear of the missions, and the agents of a large fleet have discovered each other. They do so
  /// sooner while none of them drives. An agent that comes too late gets its mission when it comes. Returns
  /// what was heard meanwhile.
  StartupBarrier wait_for_agents();
  /// Recalls the run in the journal. It reads message by message, for an hour of a large fleet is hundreds of
  /// megabytes. Throws InputError if the journal is of another run.
  void resume(PlannerService& service, const Journal& journal, RunKeeper& saved);
  /// The service goes on with this run: agents know it already.
  void goes_on_with(RunId run) { sole_.begin(run); }
  /// Waits until no other service can have the fleet. Returns what was heard meanwhile.
  StartupBarrier wait_for_other_services();
  /// Runs the service until the run has ended, or until another service has precedence. `history`, `ros`,
  /// `display`: null for none.
  void serve(PlannerService& service, Keeper<RunKeeper, Journal>& keeper, OrderHistory* history,
             DdsRosFleet* ros, ProgressDisplay* display);
  /// Throws if another service has precedence.
  void check_precedence() const;

 private:
  std::vector<Arrival> take();
  template <class Done>
  StartupBarrier listen(Done&& done);
  void on(const Arrival& arrival);
  void step();
  WallTime next_wake() const;
  void tend(Journal& journal, PlannerService& service);
  void log_missing_goals(const PlannerService& service);

  DdsBus& bus_;
  Heartbeat& heart_;
  ProcessClock& clock_;
  int domain_;
  std::size_t robots_;
  RobotAssignment assignment_;
  SoleService sole_;
  RollCall roll_;
  std::vector<std::string> without_goal_;  ///< lines that were logged
  std::string problem_;                    ///< with the journal's disk; empty: none
  WallTime next_look_at_disk_ = 0;
};

}  // namespace coppice
