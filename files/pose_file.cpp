#include "files/pose_file.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>

#include "coppice/files/input_error.h"
#include "coppice/planning/clearance_field.h"
#include "files/json_file.h"
#include "files/robot_starts.h"
#include "files/text_file.h"
#include "planning/number_text.h"
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

void check_yaw(const RobotTask& task, const proto::Poses::Robot& pose, const std::string& at) {
  const bool turns = is_differential(limits_of(task));
  if (turns != pose.has_yaw())
    throw InputError(
        fmt::format("{}.yaw: {}", at,
                    turns ? fmt::format("is missing, expected the heading of {} in radians", task.name)
                          : fmt::format("{} is holonomic, only a differential robot has that", task.name)));
  if (!is_yaw(pose.yaw()))
    throw InputError(fmt::format("{}.yaw: {:g} is not allowed, expected {}", at, pose.yaw(), yaw_rule));
}

/// The robot as it begins at this pose.
RobotTask posed(RobotTask robot, const Point2& place, const ClearanceField& field, const std::string& at) {
  robot.goal = robot.start;
  begin_at(robot, place, field);
  check_place(robot.start, field, driving_radius(robot), fmt::format("{} ({})", at, robot.name));
  return robot;
}

void check_apart(const RobotTask& robot, const RobotTask& other, const std::string& at) {
  const double distance = distance_at_starts(robot, other);
  const double radii = reference_radius(robot) + reference_radius(other);
  if (distance >= radii) return;
  const auto [apart, needed] = told_apart(distance, radii);
  throw InputError(fmt::format("{}: {} and {} would overlap: distance {}, sum of their radii {}", at,
                               robot.name, other.name, apart, needed));
}

/// Returns the robots as they begin, in the order of the file.
std::vector<RobotTask> robots_at(const proto::Poses& file, const Scenario& site) {
  const ClearanceField field(site.map, site.margin);
  std::vector<RobotTask> robots;
  for (int k = 0; k < file.robots_size(); ++k) {
    const proto::Poses::Robot& pose = file.robots(k);
    const std::string at = fmt::format("robots[{}]", k);
    const RobotTask* const task = find_task(site, pose.name());
    if (task == nullptr)
      throw InputError(fmt::format("{}.name: {} is no robot of this site", at, pose.name()));
    check_yaw(*task, pose, at);
    const RobotTask robot = posed(*task, {pose.x(), pose.y()}, field, at);
    for (const RobotTask& other : robots) check_apart(robot, other, at);
    robots.push_back(robot);
  }
  return robots;
}

}  // namespace

const RobotPose* pose_of(std::span<const RobotPose> poses, const std::string& robot) {
  const auto pose = std::ranges::find(poses, robot, &RobotPose::robot);
  return pose == poses.end() ? nullptr : &*pose;
}

std::vector<RobotPose> read_poses(const std::filesystem::path& path, const Scenario& site) {
  const proto::Poses file = parse_poses(path);
  std::vector<RobotPose> poses;
  try {
    robots_at(file, site);
  } catch (const InputError& problem) {
    fail_in(path, problem.what());
  }
  for (const proto::Poses::Robot& robot : file.robots()) poses.push_back(pose_in(robot));
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

void check_saved_poses(const Scenario& site, std::span<const RobotPose> poses) {
  const ClearanceField field(site.map, site.margin);
  std::vector<RobotTask> standing;
  for (const RobotPose& pose : poses) {
    const RobotTask* const task = find_task(site, pose.robot);
    if (task == nullptr) continue;
    try {
      standing.push_back(posed(*task, pose.position, field, "where a robot stood at last"));
    } catch (const InputError& problem) {
      throw InputError(
          fmt::format("{}: if it is elsewhere, name a file of poses (--start-at)", problem.what()));
    }
  }
  for (const RobotTask& task : site.robots) {
    if (pose_of(poses, task.name) != nullptr) continue;
    for (const RobotTask& other : standing) {
      if (distance_at_starts(task, other) >= reference_radius(task) + reference_radius(other)) continue;
      throw InputError(
          fmt::format("{} is new to this fleet and starts at ({:g}, {:g}), where {} stands: move its start, "
                      "or name a file of poses (--start-at)",
                      task.name, task.start.x(), task.start.y(), other.name));
    }
  }
}

std::vector<std::string> warnings_of_starts(const Scenario& site, std::span<const RobotPose> poses) {
  const ClearanceField in_margin(site.map, site.margin);
  const ClearanceField on_map(site.map);
  std::vector<std::string> warnings;
  for (RobotTask task : site.robots) {
    const RobotPose* const pose = pose_of(poses, task.name);
    if (pose == nullptr) continue;
    begin_at(task, pose->position, in_margin);
    if (std::string warning = warning_of_start(task, on_map); !warning.empty())
      warnings.push_back(std::move(warning));
  }
  return warnings;
}

}  // namespace coppice
