// One robot: finds its path with what the broker's trees teach, drives, and keeps clear of the others.
//
// A state machine: messages and the time go in, messages come out; no clock, thread or I/O. An agent outlives
// runs. What lasts as long as the process is an AgentProcess; what lasts as long as a run are its Fleet and,
// from the robot's first mission on, its Run.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"
#include "motion/body/driver.h"
#include "robot_agent/agreement/reservations.h"
#include "robot_agent/control/agent_process.h"
#include "robot_agent/control/run.h"
#include "robot_agent/control/tracking.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

class RobotAgent {
 public:
  explicit RobotAgent(RobotName name,
                      std::shared_ptr<MapContexts> map_contexts = std::make_shared<MapContexts>())
      : process_(std::make_unique<AgentProcess>(
            AgentProcess{.name = std::move(name), .map_contexts = std::move(map_contexts)})),
        fleet_(std::make_unique<Fleet>(process_->name)) {}

  /// Restores the state that the process before this one saved (saved_state.h), if that was killed in
  /// mid-run. To be called before anything else. In the same run the agent goes on with it. In the next run
  /// of a standing fleet the robot begins where it stands.
  void restore(std::optional<SavedState> saved);

  /// The robot is elsewhere and follows this body: the track is that of the robot. Before anything else.
  void track_robot(const TrackingSettings& settings) { process_->tracking = settings; }

  /// These will be handed over next. A hint for processes of many agents, which know more than the
  /// processor's caches hold: all of it comes from memory at once.
  void expect(std::span<const Arrival> arrivals) const;
  void on(Arrival arrival);
  /// The robot that follows the body was seen.
  void on(const OdometrySample& robot);
  /// How the robot that follows the body is to drive; to stand without one.
  DriveCommand command(WallTime now) { return run_ ? run_->command(now) : DriveCommand{}; }
  /// One control step if it is due, and some planning if there is something to plan; returns what to publish.
  std::vector<Outgoing> step(WallTime now);
  /// Takes the counters of the process's bus for the status.
  void note(const BusCounts& counts, WallTime now);
  /// When `step` has something to do even if nothing arrives.
  WallTime next_wake() const { return next_wake_; }

  /// The process is to end: the robot brakes and stands, and takes no mission any more.
  void retire();
  bool stands() const { return !run_ || run_->body().stands(); }
  /// The last messages of the process: the rest of the track, and the status.
  std::vector<Outgoing> final_messages(WallTime now);

  /// Null before the robot's first mission in this run.
  const Run* run() const { return run_.get(); }

 private:
  void receive(const MapMessage& message, WallTime arrived);
  void receive(const Mission& mission, WallTime arrived);
  void receive(const InactiveTreesMessage& trees, WallTime arrived);
  void receive(const HaltMessage& message, WallTime arrived);

  Mission as_reference(Mission mission) const;
  void begin_run();
  bool has_map_of(const Mission& mission) const;
  bool knows_where_it_stands(WallTime now) const;
  Mission from_where_it_stands(Mission mission) const;
  void begin_mission(WallTime now);
  std::string why_there_is_no_mission(WallTime now) const;
  AgentStatus status(WallTime now);
  void report(WallTime now, std::vector<Outgoing>& out);

  std::unique_ptr<AgentProcess> process_;
  std::unique_ptr<Fleet> fleet_;          ///< of the run that the agent serves
  Reservations reservations_;             ///< of the other robots
  std::optional<WallTime> run_heard_at_;  ///< the first mission of that run, whichever robot's
  /// A joint plan that came before the mission of its run; null: none.
  std::shared_ptr<const JointPlanMessage> early_plan_;
  std::unique_ptr<Run> run_;       ///< null before the robot's own mission
  std::uint64_t halts_heard_ = 0;  ///< number of the last message about halts
  bool status_is_due_ = true;
  WallTime next_status_ = 0;
  WallTime next_wake_ = 0;
};

}  // namespace coppice
