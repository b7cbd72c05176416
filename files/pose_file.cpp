#include "files/pose_file.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>

#include "coppice/files/input_error.h"
#include "coppice/planning/clearance_field.h"
#include "files/json_file.h"
#include "files/text_file.h"
#include "planning/quantities.h"
#include "scenario.pb.h"

namespace coppice {

namespace {

[[noreturn]] void fail_in(const std::filesystem::path& path, const std::string& problem) {
  throw InputError(fmt::format("{}: {}", path.string(), problem));
}

proto::Poses parse_poses(const std::filesystem::path& path) {
  proto::Poses file;
  read_json_text(read_text(path), path.string(), file);  // the API says null of what a robot has not
  std::set<std::string> names;
  for (int k = 0; k < file.robots_size(); ++k) {
    const proto::Poses::Robot& robot = file.robots(k);
    const std::string at = fmt::format("robots[{}]", k);
    if (robot.name().empty()) fail_in(path, at + ".name: is missing, expected the name of a robot");
    if (!names.insert(robot.name()).second)
      fail_in(path, fmt::format("{}.name: {} has a pose already", at, robot.name()));
    if (!robot.has_x() || !robot.has_y())
      fail_in(path, fmt::format("{}.{}: is missing, expected a number", at, robot.has_x() ? "y" : "x"));
    for (const double value : {robot.x(), robot.y(), robot.yaw()}) {
      if (!is_sane(value)) fail_in(path, fmt::format("{}: {:g} is too large", at, value));
    }
  }
  return file;
}

RobotPose pose_in(const proto::Poses::Robot& robot) {
  return {robot.name(), {robot.x(), robot.y()}, robot.yaw()};
}

const RobotTask* find_task(const Scenario& site, const std::string& robot) {
  const auto task = std::ranges::find(site.robots, robot, &RobotTask::name);
  return task == site.robots.end() ? nullptr : &*task;
}

void check_pose(const RobotTask& task, const proto::Poses::Robot& pose, const ClearanceField& field,
                const std::string& at) {
  const bool turns = is_differential(limits_of(task));
  if (turns != pose.has_yaw())
    throw InputError(
        fmt::format("{}.yaw: {}", at,
                    turns ? fmt::format("is missing, expected the heading of {} in radians", task.name)
                          : fmt::format("{} is holonomic, only a differential robot has that", task.name)));
  const Point2 place(pose.x(), pose.y());
  const double radius = driving_radius(task);
  if (!field.is_free(place, radius))
    throw InputError(
        fmt::format("{}: {} would stand in an obstacle, off the map, or too near to an obstacle at "
                    "({:g}, {:g}): clearance {:.3f}, radius {:g}",
                    at, task.name, place.x(), place.y(), field.clearance(place), radius));
}

}  // namespace

const RobotPose* pose_of(std::span<const RobotPose> poses, const std::string& robot) {
  const auto pose = std::ranges::find(poses, robot, &RobotPose::robot);
  return pose == poses.end() ? nullptr : &*pose;
}

std::vector<RobotPose> read_poses(const std::filesystem::path& path, const Scenario& site) {
  const proto::Poses file = parse_poses(path);
  const ClearanceField field(site.map, site.margin);
  std::vector<RobotPose> poses;
  for (int k = 0; k < file.robots_size(); ++k) {
    const std::string at = fmt::format("robots[{}]", k);
    const RobotTask* const task = find_task(site, file.robots(k).name());
    if (task == nullptr)
      fail_in(path, fmt::format("{}.name: {} is no robot of this site", at, file.robots(k).name()));
    try {
      check_pose(*task, file.robots(k), field, at);
    } catch (const InputError& problem) {
      fail_in(path, problem.what());
    }
    for (const RobotPose& other : poses) {
      const double distance = (other.position - Point2(file.robots(k).x(), file.robots(k).y())).norm();
      if (distance < reference_radius(*task) + reference_radius(*find_task(site, other.robot)))
        fail_in(path, fmt::format("{}: {} and {} would overlap: distance {:.3f}", at, task->name, other.robot,
                                  distance));
    }
    poses.push_back(pose_in(file.robots(k)));
  }
  for (const RobotTask& task : site.robots) {
    if (pose_of(poses, task.name) == nullptr)
      fail_in(path, fmt::format("{} is missing, expected a pose for each robot of the site", task.name));
  }
  return poses;
}

std::vector<RobotPose> read_saved_poses(const std::filesystem::path& path) {
  const proto::Poses file = parse_poses(path);
  std::vector<RobotPose> poses;
  for (const proto::Poses::Robot& robot : file.robots()) poses.push_back(pose_in(robot));
  return poses;
}

void write_poses(const std::filesystem::path& path, std::span<const RobotPose> poses, const Scenario& site) {
  proto::Poses file;
  for (const RobotPose& pose : poses) {
    proto::Poses::Robot* const robot = file.add_robots();
    robot->set_name(pose.robot);
    robot->set_x(pose.position.x());
    robot->set_y(pose.position.y());
    const RobotTask* const task = find_task(site, pose.robot);
    if (task != nullptr && is_differential(limits_of(*task))) robot->set_yaw(pose.yaw);
  }
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  std::string json;
  if (!google::protobuf::util::MessageToJsonString(file, &json, options).ok())
    fail_in(path, "the poses cannot be written as JSON");
  write_file(path, json);
}

void check_new_robots(const Scenario& site, std::span<const RobotPose> poses) {
  for (const RobotTask& task : site.robots) {
    if (pose_of(poses, task.name) != nullptr) continue;
    for (const RobotPose& other : poses) {
      const RobotTask* const standing = find_task(site, other.robot);
      if (standing == nullptr ||
          (other.position - task.start).norm() >= reference_radius(task) + reference_radius(*standing))
        continue;
      throw InputError(
          fmt::format("{} is new to this fleet and starts at ({:g}, {:g}), where {} stands: move its start, "
                      "or name a file "
                      "of poses (--start-at)",
                      task.name, task.start.x(), task.start.y(), other.robot));
    }
  }
}

}  // namespace coppice
