// The state of a robot that its agent restores after the process was killed in mid-run.
//
// To the robot that looks like a pause. Its body has braked in a straight line meanwhile, as it does whenever
// nothing is decided. Where the body is and what it does next follows from the robot's states. So the states
// are kept, with their mission, before anybody hears them. What they amount to is a state, a mission, a
// status, and the end of the track: a journal that is rewritten with these does not grow.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "messages/keep.h"
#include "messages/messages.h"
#include "motion/body/driver.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

/// Points of a track that a successor sends again: those that were not sent, and those that may have been
/// lost with the process. The service has the ones before. Ten seconds of a robot that drives.
inline constexpr std::size_t track_points_kept = 200;

struct SavedState {
  Mission mission;  ///< the last one
  Driver body;      ///< as it was when the last state was sent
  /// The end of the track, until then. Of a robot that follows the body (tracking.h): as it was sent.
  std::vector<TrackMessage::Point> track;
  std::uint32_t first_index = 0;  ///< of track[0] among all points of this run
  double driven_length = 0;       ///< metres, in this mission
  std::uint32_t sequence = 0;     ///< tick of the last state
  std::uint32_t round_epoch = 0;  ///< of the last state
  Stage stage = Stage::free;      ///< of the last state
  AgentStatus status;             ///< the last one
  /// The last states of peers that fell silent, as this robot relayed them. Peers that were heard again since
  /// are left out.
  std::vector<Heard> silent;
};

/// Builds a saved state from the messages that were kept, one at a time and in order.
class SavedStateBuilder {
 public:
  /// `leads`: a real robot follows the body (tracking.h). Its positions do not follow from the states.
  explicit SavedStateBuilder(bool leads = false) : leads_(leads) {}

  void add(const Message& message);
  /// The saved state of all that was added; none if the robot had no body yet.
  std::optional<SavedState> saved_state() const;
  /// Messages from which another builder makes the same saved state.
  std::vector<Message> messages() const;

 private:
  void receive(const Mission& mission);
  void receive(const RobotState& state);
  void receive(const AgentStatus& status);
  void receive(const TrackMessage& track);
  void drive_on(double until);
  void bound_track();

  bool leads_;
  std::optional<Mission> mission_;
  std::optional<SavedState> saved_;
  std::optional<RobotState> state_;     ///< the last one
  std::optional<RobotState> in_round_;  ///< the last one that names a round
  std::optional<AgentStatus> status_;
  std::vector<TrackMessage::Point> track_;
  std::uint32_t first_index_ = 0;
  std::map<RobotName, Heard> silent_;
};

std::optional<SavedState> saved_state_of(std::span<const Message> kept, bool leads = false);

/// Whether a saved state is of the run and the map of a mission.
bool is_of_run(const std::optional<SavedState>& saved, const Mission& mission);

/// Whether an agent ignores a mission. The agent serves the newest run that it has heard of, with `epoch`. A
/// run that began earlier, because its service's clock is behind, comes next if the agent's own part in the
/// newest run is over. `own`: the agent's mission, of whichever run.
bool passes_over(const Mission& mission, const RunId& run, const std::optional<Mission>& own);

/// Chooses which messages to keep, and knows what they amount to.
class StateKeeper {
 public:
  /// `leads`: as above.
  explicit StateKeeper(RobotName robot, bool leads = false)
      : robot_(std::move(robot)), leads_(leads), kept_(leads) {}

  /// Goes on after the messages that were kept before. They come all at once, or in pieces.
  void restore(std::span<const Message> kept);
  Keep heard(const Message& message);
  Keep said(const Message& message);

  /// The saved state of all that was kept; none if the robot had no body yet.
  std::optional<SavedState> saved_state() const { return kept_.saved_state(); }
  /// Messages that can be kept instead of all that were chosen so far.
  std::vector<Message> snapshot() const { return kept_.messages(); }
  /// The message without what no successor needs of it.
  static Message slim(const Message& message);

 private:
  Keep choose_heard(const Message& message);
  Keep choose_said(const Message& message);
  Keep noted(Keep choice, const Message& message);
  bool end_silence(const RobotState& state);

  RobotName robot_;
  bool leads_;
  SavedStateBuilder kept_;
  std::optional<RunId> run_;  ///< the run that the agent serves, as far as this process knows
  std::optional<Mission> mission_;
  std::optional<AgentStatus> status_;
  bool stands_for_good_ = false;           ///< its mission is cancelled, and a state where it stands was kept
  std::map<RobotName, double> passed_on_;  ///< the newest stamp of each peer that was not heard since
};

}  // namespace coppice
