#include "files/scenario_file.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>

#include "files/file_kind.h"
#include "files/input_error.h"
#include "files/json_file.h"
#include "files/map_file.h"
#include "files/text_file.h"
#include "planning/clearance_field.h"
#include "planning/quantities.h"
#include "planning/robot_name.h"
#include "scenario.pb.h"

namespace coppice {

namespace {

// Default acceleration in units of the maximum speed: full speed within 0.5 s.
constexpr double speeds_a_second = 2;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& field,
                       const std::string& problem) {
  throw InputError(fmt::format("{}: {}: {}", path.string(), field, problem));
}

double checked_size(std::optional<double> value, double otherwise, const std::filesystem::path& path,
                    const std::string& field) {
  const double chosen = value.value_or(otherwise);
  if (!is_sane_size(chosen)) {
    fail(path, field,
         fmt::format("{} is not allowed, expected a number above 0, from {} to {}", chosen, least_quantity,
                     largest_quantity));
  }
  return chosen;
}

template <class Message>
std::optional<double> optional_field(bool there, const Message& value) {
  return there ? std::optional<double>(value) : std::nullopt;
}

/// Format of `.scen`: a version line; then lines of bucket, map, width, height, start x y, goal x y, optimal
/// length.
proto::Scenario parse_scen(const std::filesystem::path& path, int& width, int& height) {
  proto::Scenario scenario;
  std::istringstream lines(read_text(path));
  std::string line;
  int number = 1;
  if (!std::getline(lines, line) || !line.starts_with("version")) {
    throw InputError(fmt::format("{}:1: expected \"version 1\"", path.string()));
  }
  while (std::getline(lines, line)) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    std::istringstream fields(line);
    std::string bucket;
    std::string map;
    int w = 0;
    int h = 0;
    int sx = 0;
    int sy = 0;
    int gx = 0;
    int gy = 0;
    if (!(fields >> bucket >> map >> w >> h >> sx >> sy >> gx >> gy)) {
      throw InputError(
          fmt::format("{}:{}: expected bucket, map, width, height, start x, start y, goal x, goal y, length",
                      path.string(), number));
    }
    if (!scenario.map().empty() && (scenario.map() != map || w != width || h != height)) {
      throw InputError(
          fmt::format("{}:{}: names another map or size than the lines before", path.string(), number));
    }
    scenario.set_map(map);
    width = w;
    height = h;
    auto* robot = scenario.add_robots();
    robot->set_name(fmt::format("r{}", scenario.robots_size()));
    robot->mutable_start()->set_x(sx + 0.5);
    robot->mutable_start()->set_y(sy + 0.5);
    robot->mutable_goal()->set_x(gx + 0.5);
    robot->mutable_goal()->set_y(gy + 0.5);
  }
  return scenario;
}

void check_name(const std::string& name, std::set<std::string>& names, const std::filesystem::path& path,
                const std::string& field) {
  if (!is_robot_name(name)) fail(path, field, fmt::format("expected {}", robot_name_rule));
  if (!names.insert(name).second)
    fail(path, field, fmt::format("\"{}\" is also the name of another robot", name));
}

Point2 checked_place(bool there, const proto::Position& place, const ClearanceField& field, double radius,
                     const OccupancyMap& map, const std::filesystem::path& path, const std::string& name) {
  if (!there) fail(path, name, "is missing, expected {\"x\": ..., \"y\": ...}");
  if (!place.has_x() || !place.has_y())
    fail(path, name + (place.has_x() ? ".y" : ".x"), "is missing, expected a number");
  const Point2 p(place.x(), place.y());
  const Box<2> box = map.bounds();
  if ((p.array() < box.lower.array()).any() || (p.array() > box.upper.array()).any()) {
    fail(path, name,
         fmt::format("({}, {}) is outside of the map, which covers ({}, {}) to ({}, {})", p.x(), p.y(),
                     box.lower.x(), box.lower.y(), box.upper.x(), box.upper.y()));
  }
  if (!field.is_free(p, radius)) {
    fail(path, name,
         fmt::format("({}, {}) is inside of an obstacle or too near to one: clearance {:.3f}, radius {}",
                     p.x(), p.y(), field.clearance(p), radius));
  }
  return p;
}

void check_apart(const std::vector<RobotTask>& robots, Point2 RobotTask::*place, const char* what,
                 const std::filesystem::path& path) {
  for (std::size_t i = 0; i < robots.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = (robots[i].*place - robots[j].*place).norm();
      if (distance >= robots[i].radius + robots[j].radius) continue;
      fail(path, fmt::format("robots[{}].{}", i, what),
           fmt::format("{} and {} would overlap there: distance {:.3f}, radii {} and {}", robots[i].name,
                       robots[j].name, distance, robots[i].radius, robots[j].radius));
    }
  }
}

/// The map's file: the command line's, or else `named`, which the scenario gives relative to itself.
std::string map_of(const std::filesystem::path& scenario, const std::string& named,
                   const ScenarioOptions& options) {
  if (!options.map.empty()) return options.map;
  if (named.empty()) fail(scenario, "map", "is missing, expected the path of a map relative to this file");
  const std::filesystem::path file = scenario.parent_path() / named;
  std::error_code too_long;  // set if the name is too long for the file system
  if (!std::filesystem::exists(file, too_long))
    fail(scenario, "map",
         fmt::format("there is no {} (--map FILE names a map that lies elsewhere)", file.string()));
  return file.string();
}

/// Reads the map. If the scenario names it, errors name the scenario too.
OccupancyMap read_map_of(const std::filesystem::path& scenario, const std::string& map_file,
                         const ScenarioOptions& options) {
  if (!options.map.empty()) return read_map(map_file, options.warnings);
  try {
    return read_map(map_file, options.warnings);
  } catch (const InputError& problem) {
    fail(scenario, "map", problem.what());
  }
}

}  // namespace

Scenario read_scenario(const std::filesystem::path& path, const ScenarioOptions& options) {
  refuse_other_kinds(path, {FileKind::scenario, FileKind::scen}, "a scenario (.json or .scen)");
  int said_width = 0;
  int said_height = 0;
  const bool is_scen = ending_of(path) == ".scen";
  proto::Scenario file;
  if (is_scen) {
    file = parse_scen(path, said_width, said_height);
  } else {
    read_json(path, file);
  }

  const std::string map_file = map_of(path, file.map(), options);
  Scenario scenario{.map_name = options.map.empty() ? file.map() : options.map,
                    .map_file = map_file,
                    .map = read_map_of(path, map_file, options),
                    .seed = options.seed.value_or(file.has_seed() ? file.seed() : 1),
                    .robots = {}};
  const OccupancyMap& map = scenario.map;
  if (is_scen && (said_width != map.width || said_height != map.height)) {
    fail(path, "map",
         fmt::format("is {} x {} cells, but this file says {} x {}", map.width, map.height, said_width,
                     said_height));
  }
  if (file.robots_size() == 0) fail(path, "robots", "is empty, expected at least one robot");
  const int count = options.robots.value_or(file.robots_size());
  if (count < 1 || count > file.robots_size()) {
    fail(path, "robots", fmt::format("{} were asked for, expected 1 to {}", count, file.robots_size()));
  }
  // An agent has a table of at most `most_robots` robots and would ignore any further ones.
  if (std::cmp_greater(count, most_robots)) {
    fail(path, "robots", fmt::format("{}, expected at most {}", count, most_robots));
  }

  const ClearanceField field(map);
  const double cell = map.resolution;
  const double radius =
      checked_size(options.radius ? options.radius : optional_field(file.has_radius(), file.radius()),
                   default_radius_cells * cell, path, "radius");
  const double speed = checked_size(
      options.max_speed ? options.max_speed : optional_field(file.has_max_speed(), file.max_speed()),
      default_speed_cells * cell, path, "max_speed");
  const double tolerance = checked_size(optional_field(file.has_goal_tolerance(), file.goal_tolerance()),
                                        default_tolerance_cells * cell, path, "goal_tolerance");
  std::set<std::string> names;
  for (int i = 0; i < count; ++i) {
    const proto::Scenario::Robot& robot = file.robots(i);
    const std::string at = fmt::format("robots[{}]", i);
    check_name(robot.name(), names, path, at + ".name");
    RobotTask task;
    task.name = robot.name();
    // Options of the command line apply to all robots.
    task.radius =
        checked_size(options.radius ? options.radius : optional_field(robot.has_radius(), robot.radius()),
                     radius, path, at + ".radius");
    task.max_speed = checked_size(
        options.max_speed ? options.max_speed : optional_field(robot.has_max_speed(), robot.max_speed()),
        speed, path, at + ".max_speed");
    task.max_acceleration = checked_size(optional_field(file.has_max_acceleration(), file.max_acceleration()),
                                         speeds_a_second * task.max_speed, path, "max_acceleration");
    if (!can_brake(task.max_speed, task.max_acceleration)) {
      fail(path, "max_acceleration",
           fmt::format("{} takes {} longer than {} s to brake from {}, expected at least {}",
                       task.max_acceleration, task.name, longest_braking, task.max_speed,
                       task.max_speed / longest_braking));
    }
    task.goal_tolerance = tolerance;
    task.start =
        checked_place(robot.has_start(), robot.start(), field, task.radius, map, path, at + ".start");
    task.goal = checked_place(robot.has_goal(), robot.goal(), field, task.radius, map, path, at + ".goal");
    scenario.robots.push_back(std::move(task));
  }
  check_apart(scenario.robots, &RobotTask::start, "start", path);
  check_apart(scenario.robots, &RobotTask::goal, "goal", path);
  return scenario;
}

void write_scenario(const std::filesystem::path& path, const Scenario& scenario) {
  proto::Scenario file;
  file.set_map(scenario.map_name);
  file.set_seed(scenario.seed);
  for (const RobotTask& task : scenario.robots) {
    file.set_goal_tolerance(task.goal_tolerance);
    auto* robot = file.add_robots();
    robot->set_name(task.name);
    robot->mutable_start()->set_x(task.start.x());
    robot->mutable_start()->set_y(task.start.y());
    robot->mutable_goal()->set_x(task.goal.x());
    robot->mutable_goal()->set_y(task.goal.y());
    robot->set_radius(task.radius);
    robot->set_max_speed(task.max_speed);
  }
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.preserve_proto_field_names = true;
  std::string json;
  if (!google::protobuf::util::MessageToJsonString(file, &json, options).ok()) {
    throw InputError(fmt::format("{}: the scenario cannot be written as JSON", path.string()));
  }
  write_file(path, json);
}

}  // namespace coppice
