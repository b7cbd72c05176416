// The story of each robot in a recording: what it did one after the other, where and when, and why.
//
// Seconds by the clock of the recording's first run; metres in the map frame.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "monitor/recording/gate_ahead.h"
#include "monitor/recording/recording.h"
#include "monitor/recording/robot_act.h"

namespace coppice {

/// What a robot has reserved.
enum class Reserving : std::uint8_t { nothing, given_up, wish, trajectory };

/// A time in which a robot did one thing, for one cause.
struct Episode {
  Doing doing{};
  double from = 0;
  double until = 0;
  Point2 begin = Point2::Zero();  ///< where it was at `from`
  Point2 end = Point2::Zero();    ///< where it was at `until`
  double driven = 0;
  double radius = 0;
  std::vector<RobotName> others{};  ///< that `doing` named, one after the other
  // As it began
  std::uint32_t mission = 0;
  Point2 goal = Point2::Zero();     ///< of the mission
  std::optional<GateAhead> gate{};  ///< where it waits; none: not known
  RobotName behind{};               ///< for whom the robot waited that goes first; empty: for nobody
  Reserving reserving = Reserving::nothing;
  RobotName plan{};  ///< leader of the joint plan that it carries out; empty: none
  // As far as it is known in the end
  std::string order{};                   ///< id of the order that halted it, or that its mission serves
  std::string by{};                      ///< who gave that order
  std::optional<double> failed_since{};  ///< since when others count it as failed
};
using Story = std::vector<Episode>;

struct Stories {
  double begin = 0;  ///< of the recording
  double end = 0;
  /// All robots that the recording names. One that said no state has an empty story.
  std::map<RobotName, Story> robots{};
};

/// The topics that tell what robots do.
Topics topics_of_stories();
/// Throws InputError if the recording holds no fleet, or is damaged.
Stories stories_of(const Recording& recording);

/// The episode at a time, or the last one before it; null: the story begins later.
const Episode* episode_at(const Story& story, double time);

}  // namespace coppice
