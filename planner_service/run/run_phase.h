// The phases of a run, as the planner service sees it. Each phase holds what the service needs in it.
//
//   WaitingForTrees --> Running --> CollectingTracks --> Finished
//                  \-> NeverBegan
//
// A restarted service goes from WaitingForTrees to Running or CollectingTracks by the messages that its
// predecessor saved.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "messages/fleet_clock.h"
#include "messages/messages.h"

namespace coppice {

enum class RunEnd : unsigned char {
  all_done,        ///< no robot drives any further
  timed_out,       ///< the time of the run was over
  interrupted,     ///< it was told to stop
  before_restart,  ///< a service before this one ended it, and its reason is not saved
};

/// A run whose missions were handed out.
struct BegunRun {
  FleetClock clock;
  bool missions_due = true;      ///< the next step publishes all missions
  WallTime rediscovered_by = 0;  ///< by then the agents have discovered a restarted service; 0: not restarted
};

/// The map is published, and the agents receive the trees that cover it. Fleet time has not begun.
struct WaitingForTrees {
  WallTime since = 0;
  std::optional<std::uint32_t> trees{};  ///< that cover the map; none: no broker said so yet
  bool interrupted = false;              ///< the next step ends the run
};

struct Running {
  BegunRun run;
  bool interrupted = false;  ///< the next step ends the run
};

/// The run has ended, and its missions are cancelled. Agents send the rest of their tracks.
struct CollectingTracks {
  BegunRun run;
  RunEnd end = RunEnd::all_done;
  WallTime since = 0;
};

struct Finished {
  FleetClock clock;
  RunEnd end = RunEnd::all_done;
};

/// It was interrupted before the missions were handed out. No agent heard of it.
struct NeverBegan {
  WallTime since = 0;
};

using RunPhase = std::variant<WaitingForTrees, Running, CollectingTracks, Finished, NeverBegan>;

/// The run that goes on or is being ended; null: there is none.
BegunRun* run_of(RunPhase& phase);
/// The clock of a run that has begun; null: it has not.
const FleetClock* clock_of(const RunPhase& phase);
/// The run has ended, or it never began.
bool has_ended(const RunPhase& phase);
bool was_interrupted(const RunPhase& phase);
bool timed_out(const RunPhase& phase);
/// Ends the run in the next step. A run that has ended already is reported as interrupted.
void interrupt(RunPhase& phase);

}  // namespace coppice
