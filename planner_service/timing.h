// All times that the planner service waits, repeats or tolerates, with the reason for each. They are wall
// seconds.
//
// Agents keep robots apart without the service. The times of robot assignment serve what docs/safety.md takes
// for granted: a robot has one agent. A wrong value of the other times ends a run too early or too late.
// Where a value agrees with an assumption of docs/safety.md, its comment says so.
#pragma once

#include "messages/messages.h"

namespace coppice {

struct ServiceTiming {
  // The steps of the service.
  /// Between two steps. It bounds how late the service notices that a run is over.
  WallTime step_interval = 0.1;
  /// A longer time between two steps means that the process was paused. Messages may wait in its bus, so the
  /// pause does not count as silence of the agents.
  WallTime longest_step_gap = 1;

  // The beginning of a run.
  /// The startup barrier opens at the latest after `startup_base`, and `startup_per_robot` for each robot:
  /// processes start one after the other.
  WallTime startup_base = 1;
  WallTime startup_per_robot = 0.2;
  /// A startup barrier that took longer is logged.
  WallTime startup_worth_logging = 3;
  /// Agents that have the trees plan in a fraction of the time, but they plan without a broker too.
  WallTime longest_wait_for_trees = 3;

  /// A joint plan that was made elsewhere begins at this fleet time. Most robots have heard of each other by
  /// then. Later ones are late, and the others keep the plan's order all the same.
  double plans_begin = 0.3;

  // The tracks of a run that does not end. Fleet seconds.
  /// Tracks are counted for the report, and forgotten, when they are older than this. So the points of a
  /// robot that was cut off count if they come within `longest_cut_off`.
  double tracks_held = 60;
  /// Between two counts.
  double counting_interval = 10;

  // Silent agents.
  /// An agent without a status for so long counts as lost.
  WallTime agent_lease = 5;
  /// An agent that is silent for longer is absent. Statuses come twice a second, so this is no lost message.
  WallTime absence = 2;
  /// The lease while several agents are absent. The network may be split, or the machine overloaded, and the
  /// record of the run is worth the wait.
  WallTime agent_lease_in_split = 30;
  /// The lease of an agent that has not taken up its mission. A run waits as long for a lost robot, which may
  /// only be cut off or paused. It is the minute that the assumption on the network in docs/safety.md allows
  /// a robot to be cut off.
  WallTime longest_cut_off = 60;

  // New goals of a lifelong run.
  /// Between two attempts to draw a goal for a robot for which there was none.
  WallTime goal_draw_interval = 1;

  // The end of a run.
  /// For the last points of the tracks, after the slowest robot had time to brake.
  WallTime longest_wait_for_tracks = 3;
  /// Within `rediscovery_base`, and `rediscovery_per_robot` for each robot, the agents have discovered a
  /// service that was restarted.
  WallTime rediscovery_base = 10;
  WallTime rediscovery_per_robot = 0.2;

  // Robot assignment. Service and agents share `claim_lease` (messages/messages.h). These times serve that a
  // robot has one agent.
  /// After its start the service assigns no robot for so long: agents that have one already make themselves
  /// heard.
  WallTime assignment_settling = 2;
  /// Between two steps while an agent waits for a robot.
  WallTime assignment_interval = 0.1;
  /// An agent that waits repeats its claim more often than that. A silent one is forgotten.
  WallTime claim_patience = claim_lease / 2;

  // One service on each domain.
  /// Between two messages in which a service says that it exists.
  WallTime service_status_interval = 0.5;
  /// Another service that exists is heard within this time.
  WallTime listening = 1;
  /// The same where agents drive for a run that this service does not know: their service may be slow.
  WallTime listening_for_unknown_run = 5;

  // Log and terminal.
  /// Agents that have not come after `roll_call_base`, and `roll_call_per_robot` for each robot, are logged.
  WallTime roll_call_base = 5;
  WallTime roll_call_per_robot = 0.2;
  /// Between two pictures of the progress on a terminal.
  WallTime progress_redraw = 0.1;
  /// Between two lines of progress in a file or pipe.
  WallTime progress_line = 1;
};

inline constexpr ServiceTiming service_timing{};

}  // namespace coppice
