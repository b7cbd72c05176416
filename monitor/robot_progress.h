// How a robot comes along, by what it says of itself: what is left of its way, how long it has waited, and
// when it last came nearer to its goal.
//
// Metres and fleet seconds. A path's later part that leads past the robot is not taken for where it is: of
// two points of its path that are about as near, the one nearer along the path to where it was counts.
#pragma once

#include <optional>

#include "messages/messages.h"
#include "motion/polyline.h"

namespace coppice {

class RobotProgress {
 public:
  /// Another mission: what was reached in the one before is none of it.
  void begin_mission();
  /// Another way; empty: none.
  void follow(const Path& path);
  /// What the robot says now; later than all that it has said before.
  void on(const RobotState& state);

  /// From there to the path, and along it to its end; none without a path.
  std::optional<double> way_left(const Point2& position) const;
  /// How long it has let another go first, or stood until there is a joint plan, without a break; 0: it does
  /// not.
  double waiting(double time) const;
  /// The same, of all such waits in this run.
  double waited(double time) const { return waited_ + waiting(time); }
  /// Since it last came nearer to the end of its way; 0 for a robot that has nowhere to go.
  double without_progress(double time) const;

 private:
  void note_wait(const RobotState& state);

  std::optional<Polyline> path_;
  std::optional<double> along_;  ///< where on the path it was last; none: not on this one yet
  std::optional<double> least_;  ///< of what was left of this path
  std::optional<double> nearer_at_;
  std::optional<double> waits_since_;
  double waited_ = 0;  ///< in waits that are over
};

}  // namespace coppice
