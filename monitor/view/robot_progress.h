// The progress of a robot, from its states: the rest of its path, how long it has waited, and when it last
// came nearer to its goal.
//
// Metres and fleet seconds. Where a later part of the path leads past the robot, that part does not count: of
// two points of the path at about the same distance, the one nearer along the path to the last point is used.
#pragma once

#include <optional>

#include "messages/messages.h"
#include "motion/trajectory/polyline.h"

namespace coppice {

class RobotProgress {
 public:
  /// Begins another mission, and forgets the progress of the last one.
  void begin_mission();
  /// Takes another path; empty: none.
  void follow(const Path& path);
  /// Takes the robot's next state. States must come in order.
  void on(const RobotState& state);

  /// The distance from `position` to the path and along it to its end; nothing without a path.
  std::optional<double> way_left(const Point2& position) const;
  /// How long the robot has waited without a break, for another robot or for a joint plan; 0 if it does not
  /// wait.
  double waiting(double time) const;
  /// The total of all such waits in this run.
  double waited(double time) const { return waited_ + waiting(time); }
  /// Time since the robot last came nearer to the end of its path; 0 if it has no goal to reach.
  double without_progress(double time) const;

 private:
  void note_wait(const RobotState& state);

  std::optional<Polyline> path_;
  std::optional<double> along_;  ///< last point on the path; none: not yet on this path
  std::optional<double> least_;  ///< least rest of this path so far
  std::optional<double> nearer_at_;
  std::optional<double> waits_since_;
  double waited_ = 0;  ///< in waits that have ended
};

}  // namespace coppice
