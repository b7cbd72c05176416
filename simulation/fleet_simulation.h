// All roles of a fleet in one process, on the simulated bus and a virtual clock: the same seed gives the same
// run, bit for bit.
//
// The roles are the ones that run over DDS, unchanged. Each may step once a millisecond of virtual time,
// about what its planning takes on a real machine, and has all the time that it needs for that.
//
// Agents may be killed or paused, have wrong clocks, and hear of each other late or not at all (faults.h). A
// robot whose agent does not decide brakes in a straight line. The simulation keeps its own record of where
// the bodies were, also of those whose agent can no longer tell.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "files/scenario.h"
#include "messages/keep.h"
#include "planner_service/planner_service.h"
#include "robot_agent/robot_agent.h"
#include "simulation/faults.h"
#include "simulation/simulated_bus.h"
#include "tree_broker/tree_broker.h"

namespace coppice {

struct SimulationSettings {
  double timeout = 3600;  ///< virtual seconds
  PlannerKind planner = PlannerKind::ma_rrdt_star;
  double plan_budget = 1;  ///< virtual seconds
  double lifelong = 0;     ///< virtual seconds in which who arrives gets a new goal
  Faults faults{};
};

class FleetSimulation {
 public:
  FleetSimulation(const Scenario& scenario, const SimulationSettings& settings);
  FleetSimulation(const FleetSimulation&) = delete;
  FleetSimulation& operator=(const FleetSimulation&) = delete;

  /// Before run(): who is told all that is said, lost or not, and at what virtual time.
  void set_listener(std::function<void(const Message&, double)> listener) { listener_ = std::move(listener); }

  /// Runs to the end; `watch` is called about every tenth of a virtual second and may ask to stop by
  /// returning false.
  void run(const std::function<bool(const PlannerService&, double)>& watch);

  const PlannerService& service() const { return service_.role; }

  /// Where the bodies were, in fleet time by the true clock.
  const std::vector<NamedTrack>& tracks() const { return tracks_; }
  /// What went wrong so far.
  SufferedFaults suffered() const;
  /// And not started anew.
  bool killed(const RobotName& robot) const;

 private:
  template <class R>
  struct Participant {
    R role;
    SimulatedBus::Port& port;
    double earliest = 0;  ///< of its next step
    double next_event(double clock_offset = 0) const;
  };

  struct Agent {
    RobotName name;
    std::size_t index = 0;                             ///< of its track
    std::unique_ptr<Participant<RobotAgent>> process;  ///< null: killed
    AgentFaults faults;
    double next_kill = 0;  ///< infinity: none
    std::size_t restarts = 0;
    std::unique_ptr<KeptInMemory> kept;  ///< if it may be started anew
    std::optional<Keeper<StateKeeper, KeptInMemory>> keeper{};
    std::optional<Driver> body{};  ///< as it was when the agent last had its turn
    double next_event() const;
  };

  /// When an agent is to have its turn: most have none at most of the times at which something happens.
  struct Wake {
    std::size_t agent = 0;
    double alone = 0;  ///< its next event, as of its last turn, if nothing is sent to it that wakes it
    double kill = std::numeric_limits<double>::infinity();  ///< of its process
    const SimulatedBus::Port* port = nullptr;               ///< of its process; null: killed
  };

  template <class R, class K>
  void turn(Participant<R>& participant, K&& keeper, double clock_offset = 0);
  void turn(Agent& agent);
  void kill(Agent& agent);
  void start(Agent& agent);
  void record(Agent& agent, double until);
  void set_wake(const Agent& agent);
  double next_event(const Wake& wake) const;
  double next_event() const;

  SimulatedBus bus_;
  std::shared_ptr<MapContexts> map_contexts_ = std::make_shared<MapContexts>();
  std::function<void(const Message&, double)> listener_;  ///< empty: nobody
  double now_ = 0;
  Participant<PlannerService> service_;
  Participant<TreeBroker> broker_;
  std::vector<Agent> agents_;
  std::vector<Wake> wakes_;  ///< of these
  std::vector<NamedTrack> tracks_;
};

}  // namespace coppice
