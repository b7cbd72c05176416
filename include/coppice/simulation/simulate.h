// Simulates a fleet: service, broker and agents in one process, on a virtual clock and a bus with faults.
//
// The same scenario and settings give the same run, bit for bit.
//
// Metres in the map frame, seconds of virtual time, which is fleet time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/motion/coordination.h"
#include "coppice/motion/separation.h"
#include "coppice/motion/trajectory.h"
#include "coppice/planning/planner_kind.h"
#include "coppice/planning/tree_parameters.h"
#include "coppice/simulation/faults.h"

namespace coppice {

struct SimulationSettings {
  double timeout = 3600;  ///< virtual seconds
  PlannerKind planner = PlannerKind::ma_rrdt_star;
  double plan_budget = 1;  ///< virtual seconds for shorter paths
  double lifelong = 0;     ///< virtual seconds in which robots that arrive get new goals
  Faults faults{};
  TreeParameters trees{};
  ForestStart forest = ForestStart::ahead;
  /// A joint plan that was made elsewhere: by robot, from its start at time 0; empty: none. Robots that are
  /// held up keep its order; robots that cannot go on plan for themselves.
  std::vector<Trajectory> plan{};
  Coordination coordination = Coordination::reservations;
  bool takes_orders = false;  ///< the run lasts until it is stopped (simulation/fleet_simulation.h)
};

struct SimulatedRun {
  bool arrived = false;         ///< each robot stands at its goal
  double run_time = 0;          ///< until the last robot stood at its goal
  std::string report{};         ///< JSON; docs/report.md lists its fields
  std::vector<Track> tracks{};  ///< where each body was, in the scenario's order of robots
  /// A line for each broken promise: a lemma of docs/safety.md that a decision broke, which ends the run;
  /// robots that touched, left their limits, or jumped. Empty in every run.
  std::vector<std::string> broken{};
};

/// `stop` is called about every 0.1 virtual seconds with the time; the run ends early if it returns true.
/// Throws InputError, which names the field, if the scenario or the settings make no sense.
SimulatedRun simulate(const Scenario& scenario, const SimulationSettings& settings = {},
                      const std::function<bool(double)>& stop = {});

}  // namespace coppice
