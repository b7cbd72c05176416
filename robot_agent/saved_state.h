// The state of a robot that its agent restores after the process was killed in mid-run.
//
// To the robot that looks like a pause. Its body has braked in a straight line meanwhile, as it does whenever
// nothing is decided. Where the body is and what it does next follows from the robot's states. So the states
// are kept, with their mission, before anybody hears them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "messages/keep.h"
#include "messages/messages.h"
#include "motion/driver.h"
#include "robot_agent/fleet.h"

namespace coppice {

struct SavedState {
  Mission mission;                         ///< the last one
  Driver body;                             ///< as it was when the last state was sent
  std::vector<TrackMessage::Point> track;  ///< from the first mission of the run until then
  std::vector<TrackMessage::Point> seen;   ///< of a robot that follows the body (tracking.h): as it was sent
  double driven_length = 0;                ///< metres, along the track
  std::uint32_t sequence = 0;              ///< tick of the last state
  std::uint32_t round_epoch = 0;           ///< of the last state
  Stage stage = Stage::free;               ///< of the last state
  AgentStatus status;                      ///< the last one
  /// The last states of peers that fell silent, as this robot relayed them. Peers that were heard again since
  /// are left out.
  std::vector<Heard> silent;
};

/// Builds a saved state from the messages that were kept, one at a time and in order. The messages of a long
/// run do not fit into the process all at once.
class SavedStateBuilder {
 public:
  void add(const Message& message);
  /// The saved state of all that was added; none if the robot had no body yet.
  std::optional<SavedState> saved_state() &&;

 private:
  void receive(const Mission& mission) { mission_ = mission; }
  void receive(const RobotState& state);
  void receive(const AgentStatus& status);
  void receive(const TrackMessage& track);

  std::optional<Mission> mission_;
  std::optional<SavedState> saved_;
  std::vector<TrackMessage::Point> seen_;
  std::map<RobotName, Heard> silent_;
};

std::optional<SavedState> saved_state_of(std::span<const Message> kept);

/// Whether a saved state is of the run and the map of a mission.
bool is_of_run(const std::optional<SavedState>& saved, const Mission& mission);

/// Whether an agent ignores a mission. The agent serves the newest run that it has heard of, with `epoch`. A
/// run that began earlier, because its service's clock is behind, comes next if the agent's own part in the
/// newest run is over. `own`: the agent's mission, of whichever run.
bool passes_over(const Mission& mission, const RunId& run, const std::optional<Mission>& own);

/// Chooses which messages to keep.
class StateKeeper {
 public:
  /// `leads`: a real robot follows the body (tracking.h). Its positions do not follow from the states.
  explicit StateKeeper(RobotName robot, bool leads = false) : robot_(std::move(robot)), leads_(leads) {}

  /// Goes on after the messages that were kept before. They come all at once, or in pieces.
  void restore(std::span<const Message> kept);
  Keep heard(const Message& message);
  Keep said(const Message& message);

 private:
  bool end_silence(const RobotState& state);

  RobotName robot_;
  bool leads_;
  std::optional<RunId> run_;  ///< the run that the agent serves, as far as this process knows
  std::optional<Mission> mission_;
  std::optional<AgentStatus> status_;
  bool stands_for_good_ = false;           ///< its mission is cancelled, and a state where it stands was kept
  std::map<RobotName, double> passed_on_;  ///< the newest stamp of each peer that was not heard since
};

}  // namespace coppice
