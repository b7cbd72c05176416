// A fleet's ROS 2 topics, over the bus's own participant. No installation of ROS is needed. The participant
// is shared, because all processes would have to discover a second one, too.
//
// DDS names, types and QoS are those of ROS 2 (ros2/names.h, idl/ros2.idl, ros2/topics.h). Anybody on the
// network can send a message here. Bytes that are no valid sample become a sample with a frame that does not
// exist, which problem_with (ros2/conversion.h) refuses.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "dds/dds_bus.h"
#include "ros2/conversion.h"
#include "ros2/names.h"

namespace coppice {

/// The topics of one robot. The bus must outlive it.
class DdsRosRobot {
 public:
  /// If the pose comes from somewhere, neither odom nor tf is written.
  DdsRosRobot(DdsBus& bus, const RobotName& robot, const RosRobotSettings& settings);
  /// Waits until readers have acknowledged the last command, for 0.5 s at most.
  ~DdsRosRobot();
  DdsRosRobot(const DdsRosRobot&) = delete;
  DdsRosRobot& operator=(const DdsRosRobot&) = delete;

  void publish(const RosMessage& message);
  /// Returns the messages that arrived since the last call, with their times of arrival.
  std::vector<RosOdometry> take();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The topics of the fleet: its map, and goals for its robots. The bus must outlive it.
class DdsRosFleet {
 public:
  DdsRosFleet(DdsBus& bus, const RosNames& names, std::span<const RobotName> robots);
  ~DdsRosFleet();
  DdsRosFleet(const DdsRosFleet&) = delete;
  DdsRosFleet& operator=(const DdsRosFleet&) = delete;

  void publish(const OccupancyMap& map, WallTime now);
  /// Returns the goals that arrived since the last call.
  std::vector<RosGoal> take();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
