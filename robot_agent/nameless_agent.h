// An agent that is not told which robot it is: it asks the service, and then is that one. What it hears
// before is of no use to it: a bus that is opened as that robot's tells it all that it needs.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "robot_agent/claimant.h"
#include "robot_agent/robot_agent.h"

namespace coppice {

class NamelessAgent {
 public:
  explicit NamelessAgent(std::uint64_t id) : claimant_(id) {}

  void on(const Arrival& arrival);
  std::vector<Outgoing> step(WallTime now);
  WallTime next_wake() const;

  /// The same as a RobotAgent's. Who is no robot yet, or no more, stands and has nothing to say.
  void note(const BusCounts& counts, WallTime now);
  void retire();
  bool stands() const { return !agent_ || lost() || agent_->stands(); }
  std::vector<Outgoing> final_messages(WallTime now);

  /// Once it knows which robot it is: begins to be that one, and goes on from what was kept of it before
  /// (memory.h), if anything. `tracking`: of a robot that is elsewhere.
  void begin(std::optional<SavedState> saved, const std::optional<TrackingSettings>& tracking = {});

  /// From then on.
  RobotAgent& agent() { return *agent_; }

  /// Which it is; none: not yet.
  const std::optional<RobotName>& robot() const { return claimant_.robot(); }
  /// It is that robot no more, and says nothing from now on.
  bool lost() const { return claimant_.lost(); }
  /// Says again which robot it is. Who has a long journal to read does so meanwhile, at least every two
  /// seconds: it is not silent then.
  Claim claim(WallTime now) { return claimant_.claim(now); }

 private:
  Claimant claimant_;
  std::optional<RobotAgent> agent_;
};

}  // namespace coppice
