#include "coppice/files/scenario_file.h"

#include <algorithm>
#include <limits>
#include <locale>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>
#include <spdlog/spdlog.h>

#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "coppice/planning/clearance_field.h"
#include "files/file_kind.h"
#include "files/json_file.h"
#include "files/robot_starts.h"
#include "files/size_check.h"
#include "files/text_file.h"
#include "planning/quantities.h"
#include "scenario.pb.h"

namespace coppice {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& field,
                       const std::string& problem) {
  throw InputError(fmt::format("{}: {}: {}", path.string(), field, problem));
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
    fields.imbue(std::locale::classic());  // the program's may group digits
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

/// Whether a field of that name says that a robot is differential. Empty: holonomic.
bool is_differential(const std::string& kinematics, const std::string& field) {
  if (kinematics == "differential") return true;
  if (!kinematics.empty() && kinematics != "holonomic")
    throw InputError(
        fmt::format("{}: \"{}\" is unknown, expected holonomic or differential", field, kinematics));
  return false;
}

void check_margin(double margin, const std::string& field) {
  if (margin >= 0 && is_sane(margin)) return;
  throw InputError(
      fmt::format("{}: {} is not allowed, expected a number from 0 to {}", field, margin, largest_quantity));
}

/// Fields of differential robots mean nothing in a file without such a robot.
void check_that_some_turn(const proto::Scenario& file) {
  const auto turns = [](const auto& of) { return of.kinematics() == "differential"; };
  if (turns(file) || std::ranges::any_of(file.robots(), turns)) return;
  const auto refuse = [](bool is_there, const char* name) {
    if (is_there)
      throw InputError(fmt::format("{}: all robots are holonomic, only differential robots have that", name));
  };
  refuse(file.has_max_angular_speed(), "max_angular_speed");
  refuse(file.has_max_angular_acceleration(), "max_angular_acceleration");
  refuse(file.has_goal_yaw_tolerance(), "goal_yaw_tolerance");
}

/// The fields that hold for all robots. Each is checked, also if every robot has its own.
void check_fields_of_all(const proto::Scenario& file) {
  if (file.has_radius()) check_size(file.radius(), "radius");
  if (file.has_max_speed()) check_size(file.max_speed(), "max_speed");
  if (file.has_max_acceleration()) check_size(file.max_acceleration(), "max_acceleration");
  if (file.has_goal_tolerance()) check_size(file.goal_tolerance(), "goal_tolerance");
  if (file.has_goal_yaw_tolerance()) {
    check_size(file.goal_yaw_tolerance(), "goal_yaw_tolerance");
    if (file.goal_yaw_tolerance() > std::numbers::pi)
      throw InputError(
          fmt::format("goal_yaw_tolerance: {:g} is more than half a turn, expected radians, at most 3.142",
                      file.goal_yaw_tolerance()));
  }
  if (file.has_max_angular_speed()) check_size(file.max_angular_speed(), "max_angular_speed");
  if (file.has_max_angular_acceleration())
    check_size(file.max_angular_acceleration(), "max_angular_acceleration");
  is_differential(file.kinematics(), "kinematics");
  if (file.has_margin()) check_margin(file.margin(), "margin");
}

/// A robot with a footprint has the radius of the disc that holds it while the robot turns.
void read_footprint(const google::protobuf::RepeatedPtrField<proto::Corner>& corners, bool has_radius,
                    const std::string& field, RobotTask& task) {
  if (corners.empty()) return;
  if (has_radius) throw InputError(fmt::format("{}: goes without radius, which follows from it", field));
  task.footprint.clear();
  for (const proto::Corner& corner : corners) {
    if (!corner.has_x() || !corner.has_y())
      throw InputError(fmt::format("{}: a corner lacks x or y, expected {{\"x\": ..., \"y\": ...}}", field));
    task.footprint.emplace_back(corner.x(), corner.y());
  }
  task.radius = radius_of_footprint(task.footprint, field);
}

/// Gives the scenario its margin, and robots that follow their tolerances.
void add_room(const proto::Scenario& file, const ScenarioOptions& options, Scenario& scenario) {
  if (options.follow) {
    std::vector<WishedTolerance> tolerances;
    for (const RobotTask& robot : scenario.robots) {
      const double most = options.tracking_tolerance.value_or(usual_tolerance(robot));
      tolerances.push_back({.most = most, .least = least_share_of_tolerance * most});
    }
    fit_tracking_tolerances(scenario, tolerances);
  }
  double least_radius = std::numeric_limits<double>::infinity();
  for (const RobotTask& robot : scenario.robots) least_radius = std::min(least_radius, robot.radius);
  const double usual = options.follow ? 0 : default_margin_radii * least_radius;
  const double margin = options.margin.value_or(file.has_margin() ? file.margin() : usual);
  if (margin > 0) fit_margin(scenario, margin);
}

/// Two wheels at the rim turn a robot so fast, in opposite directions at full speed.
double usual_turning(const RobotTask& task) {
  return std::min(task.max_speed / task.radius, fastest_turning);
}

/// The heading of a differential robot, and how fast it turns.
void read_angles(const proto::Scenario& file, const proto::Scenario::Robot& robot, const std::string& at,
                 RobotTask& task) {
  const std::string& kinematics = robot.kinematics().empty() ? file.kinematics() : robot.kinematics();
  if (!is_differential(kinematics, at + ".kinematics")) {
    const auto refuse = [&](bool is_there, const std::string& name) {
      if (is_there)
        throw InputError(
            fmt::format("{}{}: {} is holonomic, only a differential robot has that", at, name, task.name));
    };
    refuse(robot.has_max_angular_speed(), ".max_angular_speed");
    refuse(robot.has_max_angular_acceleration(), ".max_angular_acceleration");
    refuse(robot.start().has_yaw(), ".start.yaw");
    refuse(robot.goal().has_yaw(), ".goal.yaw");
    return;
  }
  task.max_angular_speed = robot.has_max_angular_speed()  ? robot.max_angular_speed()
                           : file.has_max_angular_speed() ? file.max_angular_speed()
                                                          : usual_turning(task);
  task.max_angular_acceleration = robot.has_max_angular_acceleration() ? robot.max_angular_acceleration()
                                  : file.has_max_angular_acceleration()
                                      ? file.max_angular_acceleration()
                                      : usual_acceleration(task.max_angular_speed);
  check_size(task.max_angular_speed, at + ".max_angular_speed");
  check_size(task.max_angular_acceleration, at + ".max_angular_acceleration");
  task.start_yaw = robot.start().yaw();
  if (!robot.goal().has_yaw()) return;
  task.goal_yaw = robot.goal().yaw();
  task.goal_yaw_tolerance = file.has_goal_yaw_tolerance() ? file.goal_yaw_tolerance() : default_yaw_tolerance;
}

Point2 read_place(bool is_there, const proto::Position& place, const std::filesystem::path& path,
                  const std::string& name) {
  if (!is_there) fail(path, name, "is missing, expected {\"x\": ..., \"y\": ...}");
  if (!place.has_x() || !place.has_y())
    fail(path, name + (place.has_x() ? ".y" : ".x"), "is missing, expected a number");
  return {place.x(), place.y()};
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

/// Takes starts that are a little too near to an obstacle for places that robots leave first.
void take_starts_off_walls(Scenario& scenario) {
  const ClearanceField field(scenario.map);
  for (RobotTask& robot : scenario.robots) begin_at(robot, robot.start, field);
}

void tell_of_starts(const std::filesystem::path& path, const Scenario& scenario) {
  const ClearanceField field(scenario.map);
  for (const RobotTask& robot : scenario.robots) {
    const std::string warning = warning_of_start(robot, field);
    if (!warning.empty()) spdlog::warn("{}: {}", path.string(), warning);
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
  if (!options.kinematics.empty()) {
    file.set_kinematics(options.kinematics);
    for (auto& robot : *file.mutable_robots()) robot.clear_kinematics();
  }
  const OccupancyMap& map = scenario.map;
  if (is_scen && (said_width != map.width || said_height != map.height)) {
    fail(path, "map",
         fmt::format("is {} x {} cells, but this file says {} x {}", map.width, map.height, said_width,
                     said_height));
  }
  const int count = options.robots.value_or(file.robots_size());
  if (count < 1 || count > file.robots_size()) {
    if (file.robots_size() == 0) fail(path, "robots", "is empty, expected at least one robot");
    fail(path, "robots", fmt::format("{} were asked for, expected 1 to {}", count, file.robots_size()));
  }
  try {
    check_fields_of_all(file);
    if (options.kinematics.empty()) check_that_some_turn(file);
  } catch (const InputError& problem) {
    throw InputError(fmt::format("{}: {}", path.string(), problem.what()));
  }
  // Options of the command line apply to all robots.
  const auto radius = options.radius ? options.radius : optional_field(file.has_radius(), file.radius());
  const auto speed =
      options.max_speed ? options.max_speed : optional_field(file.has_max_speed(), file.max_speed());
  for (int i = 0; i < count; ++i) {
    const proto::Scenario::Robot& robot = file.robots(i);
    const std::string at = fmt::format("robots[{}]", i);
    RobotTask task = robot_on(map);
    task.name = robot.name();
    task.start = read_place(robot.has_start(), robot.start(), path, at + ".start");
    task.goal = options.is_site && !robot.has_goal()
                    ? task.start
                    : read_place(robot.has_goal(), robot.goal(), path, at + ".goal");
    task.radius = radius.value_or(task.radius);
    if (robot.has_radius() && !options.radius) task.radius = robot.radius();
    task.max_speed = speed.value_or(task.max_speed);
    if (robot.has_max_speed() && !options.max_speed) task.max_speed = robot.max_speed();
    task.max_acceleration =
        file.has_max_acceleration() ? file.max_acceleration() : usual_acceleration(task.max_speed);
    if (file.has_max_acceleration() && !can_brake(task.max_speed, task.max_acceleration)) {
      fail(path, "max_acceleration",
           fmt::format("{} takes {} longer than {} s to brake from {}, expected at least {}",
                       task.max_acceleration, task.name, longest_braking, task.max_speed,
                       task.max_speed / longest_braking));
    }
    try {
      if (!options.radius) {
        if (!robot.has_radius()) read_footprint(file.footprint(), file.has_radius(), "footprint", task);
        read_footprint(robot.footprint(), robot.has_radius(), at + ".footprint", task);
      }
      if (options.follow) task.goal_tolerance = usual_goal_tolerance(task, map.resolution);
      if (file.has_goal_tolerance()) task.goal_tolerance = file.goal_tolerance();
      if (options.kinematics != "holonomic") read_angles(file, robot, at, task);
    } catch (const InputError& problem) {
      throw InputError(fmt::format("{}: {}", path.string(), problem.what()));
    }
    scenario.robots.push_back(std::move(task));
  }
  try {
    check_map(scenario.map);
    take_starts_off_walls(scenario);
    check_scenario(scenario);
    add_room(file, options, scenario);
  } catch (const InputError& problem) {
    throw InputError(fmt::format("{}: {}", path.string(), problem.what()));
  }
  if (options.warnings == MapWarnings::logged) tell_of_starts(path, scenario);
  return scenario;
}

void write_scenario(const std::filesystem::path& path, const Scenario& scenario) {
  proto::Scenario file;
  file.set_map(scenario.map_name);
  file.set_seed(scenario.seed);
  file.set_margin(scenario.margin);
  for (const RobotTask& task : scenario.robots) {
    file.set_goal_tolerance(task.goal_tolerance);
    auto* robot = file.add_robots();
    robot->set_name(task.name);
    const Point2 start = task.stands_at.value_or(task.start);
    robot->mutable_start()->set_x(start.x());
    robot->mutable_start()->set_y(start.y());
    robot->mutable_goal()->set_x(task.goal.x());
    robot->mutable_goal()->set_y(task.goal.y());
    if (task.footprint.empty()) robot->set_radius(task.radius);
    for (const Point2& corner : task.footprint) {
      auto* const place = robot->add_footprint();
      place->set_x(corner.x());
      place->set_y(corner.y());
    }
    robot->set_max_speed(task.max_speed);
    if (!is_differential(limits_of(task))) continue;
    robot->set_kinematics("differential");
    robot->set_max_angular_speed(task.max_angular_speed);
    robot->set_max_angular_acceleration(task.max_angular_acceleration);
    robot->mutable_start()->set_yaw(task.start_yaw);
    if (task.goal_yaw_tolerance == 0) continue;
    robot->mutable_goal()->set_yaw(task.goal_yaw);
    file.set_goal_yaw_tolerance(task.goal_yaw_tolerance);
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
