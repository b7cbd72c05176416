// A fleet's topics in ROS 2, over the bus's own participant: no ROS is needed for that. A second participant
// for each process would be found by all others, too.
//
// DDS names, types and QoS are those that ROS 2 uses (ros_names.h, idl/ros2.idl, ros_topics.h). What comes in
// is of anybody who reaches the network: bytes that are no sample come out as one in a frame that there is
// not, and so are refused by problem_with (ros_conversion.h).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "dds/dds_bus.h"
#include "ros2/conversion.h"

namespace coppice {

/// The topics of one robot. The bus outlives it.
class DdsRosRobot {
 public:
  /// `elsewhere`: the robot says itself where it is: odom is read and not written, tf is not written.
  DdsRosRobot(DdsBus& bus, const RobotName& robot, bool elsewhere);
  /// Waits until its last command has reached those who listen, half a second at most.
  ~DdsRosRobot();
  DdsRosRobot(const DdsRosRobot&) = delete;
  DdsRosRobot& operator=(const DdsRosRobot&) = delete;

  void publish(const RosMessage& message);
  /// What came since the last call, stamped with when it came.
  std::vector<RosOdometry> take();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The fleet's: its map, and what others want of its robots. The bus outlives it.
class DdsRosFleet {
 public:
  DdsRosFleet(DdsBus& bus, std::span<const RobotName> robots);
  ~DdsRosFleet();
  DdsRosFleet(const DdsRosFleet&) = delete;
  DdsRosFleet& operator=(const DdsRosFleet&) = delete;

  void publish(const OccupancyMap& map, WallTime now);
  /// What came since the last call.
  std::vector<RosGoal> take();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
