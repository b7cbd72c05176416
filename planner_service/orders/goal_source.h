// Where the next goals of robots come from: drawn at random in a lifelong run, or requested over ROS. A run
// that is neither gets no next goals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/random.h"
#include "messages/messages.h"
#include "planning/geometry/random_places.h"
#include "planning/geometry/reachability.h"

namespace coppice {

/// Where a robot is to go next.
struct NextGoal {
  Point2 position = Point2::Zero();
  std::optional<double> yaw{};  ///< none: any
};

/// The room that a robot takes now and later.
struct RoomOfRobot {
  const RobotTask* task;           ///< with its latest goal
  std::optional<Point2> stays_at;  ///< its position, if it drives no further
};

class GoalSource {
 public:
  /// `scenario` outlives it.
  explicit GoalSource(const Scenario& scenario);

  // All robots are given in the order of the scenario.

  /// Requests the next goal of a robot, in the map frame, in place of an earlier request. Returns why it is
  /// refused, if it is.
  std::optional<std::string> request(std::size_t robot, const NextGoal& goal,
                                     std::span<const RoomOfRobot> robots);
  std::optional<NextGoal> take_request(std::size_t robot);
  /// The robot whose goal leaves no room for this one; none: there is room. The first one by name.
  std::optional<std::size_t> in_the_way(std::size_t robot, const Point2& goal,
                                        std::span<const RoomOfRobot> robots) const;

  /// Draws again no sooner than `goal_draw_interval` after a draw without result.
  bool may_draw(std::size_t robot, WallTime now);
  /// A goal at some distance from the robot's last goal, clear of all other robots. If there is none, the
  /// robot goes without, and shortage_of() says why.
  std::optional<Point2> draw(std::size_t robot, std::span<const RoomOfRobot> robots, WallTime now);
  /// Why the robot has no new goal; empty if it has one or needs none.
  const std::string& shortage_of(std::size_t robot) const { return robots_[robot].shortage; }
  /// The robot has a new goal.
  void clear_shortage(std::size_t robot);
  /// Draws from here on other goals than the first `goals`, which a service before this one has drawn.
  void skip(std::uint64_t goals) { random_ = Random(scenario_.seed + goals); }

  /// The clearance field of the map, with the margin.
  const ClearanceField& field();

 private:
  struct Robot {
    std::optional<NextGoal> request;
    std::string shortage;
    WallTime next_draw = 0;
  };

  const ReachablePart& part_of(const RobotTask& task);
  std::vector<KeepOut> taken_by_others(std::size_t robot, std::span<const RoomOfRobot> robots,
                                       double spare) const;
  std::optional<Point2> draw_goal(std::size_t robot, std::span<const RoomOfRobot> robots);

  const Scenario& scenario_;
  Random random_;
  std::optional<ClearanceField> field_;  ///< of the map, once it is needed
  std::vector<ReachablePart> parts_;     ///< that robots reach, once they are needed
  std::vector<Robot> robots_;
};

}  // namespace coppice
