// A small fleet as a monitor sees it.
#pragma once

#include <memory>
#include <utility>

#include "messages/messages.h"
#include "monitor/view/fleet_view.h"

namespace coppice::test {

/// A fleet on a map of 4 x 3 cells whose y axis points down. Fleet time 0 is at 100.
class SeenFleet {
 public:
  FleetView view;
  WallTime now = 100;

  void hear(Message message) { view.on(std::make_shared<const Message>(std::move(message)), now); }

  void map(YAxis y_axis = YAxis::down, Point2 origin = Point2::Zero()) {
    hear(MapMessage{"m",
                    {.width = 4,
                     .height = 3,
                     .origin = origin,
                     .y_axis = y_axis,
                     .blocked = {1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0}}});
  }
  void mission(const RobotName& robot, std::uint32_t number = 1, WallTime epoch = 100) {
    hear(Mission{.robot = robot,
                 .number = number,
                 .map_id = "m",
                 .start = {0.5, 1.5},
                 .goal = {3.5, 1.5},
                 .radius = 0.25,
                 .max_speed = 2,
                 .max_acceleration = 4,
                 .goal_tolerance = 0.5,
                 .clock = {.epoch = epoch}});
  }
  /// The service ends the run.
  void end_of_run(const RobotName& robot) {
    Mission mission = *view.robots()[*view.find(robot)].mission;
    mission.cancelled = true;
    hear(mission);
  }
  void state(const RobotName& robot, Point2 position, Point2 velocity = Point2::Zero()) {
    const double time = now - 100;
    hear(RobotState{.robot = robot,
                    .promise = {.stamp = time,
                                .position = position,
                                .velocity = velocity,
                                .decision_time = time + 1,
                                .expiry = time + 1},
                    .radius = 0.25,
                    .phase = Phase::driving});
  }
  void status(const RobotName& robot, Phase phase, double driven = 0) {
    hear(AgentStatus{.robot = robot, .mission = 1, .phase = phase, .driven_length = driven});
  }
  void path(const RobotName& robot, Path waypoints) { hear(PathMessage{robot, 1, std::move(waypoints)}); }
  /// A chain of `nodes` nodes to the right.
  void tree(std::uint32_t number, int nodes = 3) {
    InactiveTreesMessage tree{.id = {7, number}, .map_id = "m", .radius = 0.25};
    for (int k = 0; k < nodes; ++k) tree.nodes.push_back({Point2(0.001 * k, 1), k - 1, 1});
    hear(tree);
  }
  void root_nodes(const RobotName& robot, std::uint32_t first, int nodes, std::uint32_t mission_number = 1) {
    RootNodes batch{.robot = robot, .mission = mission_number, .first_index = first};
    for (int k = 0; k < nodes; ++k) {
      const int own = static_cast<int>(first) + k;
      batch.nodes.push_back({Root::start, Point2(0.1 * own, 1), own - 1});
    }
    hear(batch);
  }
};

}  // namespace coppice::test
