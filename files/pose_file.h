// Files that say where robots stand: JSON, a pose for each robot (docs/reference.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/planning/geometry.h"

namespace coppice {

/// Where a robot stands. Metres in the map frame; radians, of a differential robot.
struct RobotPose {
  std::string robot;
  Point2 position = Point2::Zero();
  double yaw = 0;
};

/// The pose of a robot; null: there is none.
const RobotPose* pose_of(std::span<const RobotPose> poses, const std::string& robot);

/// Reads a file with a pose for each robot of the site. Throws InputError, which names file and robot, if a
/// pose is missing or wrong, if a robot has no room there (files/robot_starts.h) or would touch another
/// robot, or if a robot is none of the site.
std::vector<RobotPose> read_poses(const std::filesystem::path& path, const Scenario& site);

/// Reads the poses that write_poses() wrote, whatever robots they are of.
std::vector<RobotPose> read_saved_poses(const std::filesystem::path& path);

/// The file is of a form that read_poses() reads. Yaws are written of the differential robots of the site.
void write_poses(const std::filesystem::path& path, std::span<const RobotPose> poses, const Scenario& site);

/// Robots that have no pose are new to a fleet whose other robots stand at `poses`. They begin at their
/// starts. Throws InputError if another robot stands there, or if a robot has no room where it stands
/// (files/robot_starts.h).
void check_saved_poses(const Scenario& site, std::span<const RobotPose> poses);

/// A line for each robot that drives out first if it begins at its pose.
std::vector<std::string> warnings_of_starts(const Scenario& site, std::span<const RobotPose> poses);

}  // namespace coppice
