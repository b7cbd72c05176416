// Runs all roles of a fleet in one process, on the simulated bus and a virtual clock. The same seed gives the
// same run, bit for bit.
//
// The roles are those that run over DDS, unchanged. Each may step once per millisecond of virtual time, about
// the time of its planning on a real machine, and takes as much real time as it needs.
//
// Agents may be killed or paused, have wrong clocks, and receive messages late or not at all (faults.h). A
// robot whose agent does not decide brakes in a straight line. The simulation keeps its own record of the
// bodies' positions, also for agents that can no longer report them. A sentinel checks each decision
// (sentinel.h).
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/simulation/simulate.h"
#include "messages/keep.h"
#include "planner_service/run/planner_service.h"
#include "planner_service/run/saved_run.h"
#include "robot_agent/process/robot_agent.h"
#include "simulation/fault_schedule.h"
#include "simulation/following_robot.h"
#include "simulation/sentinel.h"
#include "simulation/simulated_bus.h"
#include "tree_broker/tree_broker.h"

namespace coppice {

class FleetSimulation {
 public:
  /// `scenario` outlives it.
  FleetSimulation(const Scenario& scenario, const SimulationSettings& settings);
  FleetSimulation(const FleetSimulation&) = delete;
  FleetSimulation& operator=(const FleetSimulation&) = delete;

  /// Sets a listener that receives all published messages, lost or not, with their virtual time. Call it
  /// before run().
  void set_listener(std::function<void(const Message&, double)> listener) { listener_ = std::move(listener); }

  /// Runs to the end, or until a lemma is broken. `watch` is called about every 0.1 s of virtual time; it
  /// stops the run by returning false.
  void run(const std::function<bool(const PlannerService&, double)>& watch);

  /// Gives an order, as a dispatcher does. Within run().
  void give(OrderMessage order);
  /// Kills the planner service of a fleet that takes orders. Another one goes on with what it saved.
  void restart_service();

  const PlannerService& service() const { return service_->role; }

  /// Positions and velocities of the bodies, in fleet time by the true clock.
  const std::vector<NamedTrack>& tracks() const { return tracks_; }
  const Sentinel& sentinel() const { return sentinel_; }
  /// The faults that have occurred so far.
  SufferedFaults suffered() const;
  /// Whether the robot's agent is killed and not restarted yet.
  bool killed(const RobotName& robot) const;
  /// Whether a robot was told where another one is, or counts it as failed. Or did before its last restart:
  /// the journal holds that.
  bool knows(const RobotName& robot, const RobotName& other) const;
  /// Whether the robot's agent was killed for good, and nobody who is alive knows where the robot is.
  bool lost(const RobotName& robot) const;
  /// Where failed robots may stand, as far as a living robot knows.
  std::vector<Disc> places_of_failed(const RobotName& robot) const;

 private:
  template <class R>
  struct Participant {
    R role;
    SimulatedBus::Port& port;
    double earliest = 0;  ///< earliest time of its next step
    double next_event(const AgentClock& clock = {}) const;
  };

  /// A robot that follows the body of its agent.
  struct Follower {
    FollowingRobot robot;
    double stops_after = 0;  ///< seconds without a command
    DriveCommand command{};
    double commanded_at = 0;  ///< fleet time
    FleetClock clock;         ///< of the run
  };

  struct Agent {
    RobotName name;
    std::size_t index = 0;                             ///< index of its track
    std::unique_ptr<Participant<RobotAgent>> process;  ///< null: killed
    AgentFaults faults;
    double next_kill = 0;  ///< infinity: none
    std::size_t restarts = 0;
    std::vector<RobotName> knew_failed{};  ///< when it was killed last
    std::unique_ptr<KeptInMemory> kept;    ///< saved state for a restart
    std::optional<Keeper<StateKeeper, KeptInMemory>> keeper{};
    std::optional<Driver> body{};  ///< as it was after the agent's last step
    AgentClock clock_of_run{};     ///< its clock, in fleet time
    std::size_t peer_in_turn = 0;  ///< whose clock the sentinel looks at next
    std::optional<Follower> follower{};
    double next_event() const;
    const Run* run() const { return process ? process->role.run() : nullptr; }
    bool knows(const RobotName& other) const;
  };

  /// The next time at which an agent has something to do. Most agents have nothing to do at most events.
  struct Wake {
    std::size_t agent = 0;
    double alone = 0;  ///< the agent's next event, as of its last step, unless a message wakes it
    double kill = std::numeric_limits<double>::infinity();  ///< the next kill of its process
    const SimulatedBus::Port* port = nullptr;               ///< port of its process; null: killed
  };

  std::unique_ptr<Participant<PlannerService>> started_service();
  template <class R, class K>
  void step(Participant<R>& participant, K&& keeper, const AgentClock& clock = {});
  void step(Agent& agent);
  void kill(Agent& agent);
  void start(Agent& agent);
  const Agent& agent(const RobotName& robot) const;
  void show(Agent& agent, const Run& run);
  void record(Agent& agent, double until);
  void meet_robot(Agent& agent);
  void command_robot(Agent& agent, const Run& run);
  void move_robot(Agent& agent, double until);
  void set_wake(const Agent& agent);
  double next_event(const Wake& wake) const;
  double next_event() const;

  const Scenario& scenario_;
  ServiceSettings settings_of_service_;
  DriveFaults drive_;
  SimulatedBus bus_;
  std::shared_ptr<MapContexts> map_contexts_ = std::make_shared<MapContexts>();
  std::function<void(const Message&, double)> listener_;  ///< empty: no listener
  double now_ = 0;
  KeptInMemory kept_of_service_;
  std::optional<Keeper<RunKeeper, KeptInMemory>> keeper_of_service_{};
  std::unique_ptr<Participant<PlannerService>> service_;
  Participant<TreeBroker> broker_;
  std::vector<Agent> agents_;
  std::vector<Wake> wakes_;  ///< by agent
  std::vector<NamedTrack> tracks_;
  Sentinel sentinel_;
};

}  // namespace coppice
