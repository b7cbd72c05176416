#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "coppice/files/scenario.h"
#include "coppice/planning/clearance_field.h"
#include "files/robot_starts.h"
#include "planning/geometry/reachability.h"
#include "planning/geometry/room_for_margin.h"

namespace coppice {

namespace {

constexpr double rounding = 1e-6;  // metres
// A robot gets the largest of these shares of what was wished for that fits.
constexpr std::array shares{1.0, 0.75, 0.5, 0.25, 0.1};
constexpr std::array shares_of_tolerance{1.0, 0.75, 0.5, 0.25, 0.1, 0.05, 0.025, 0.01};

bool ends_fit(const std::vector<RobotTask>& robots, const ClearanceField& field, double margin) {
  return std::ranges::all_of(robots, [&](const RobotTask& robot) {
    const double radius = driving_radius(robot) + margin;
    return field.is_free(robot.start, radius) && field.is_free(robot.goal, radius);
  });
}

/// Moves the starts of robots that drive out first to where they have `beyond` metres more than their radii.
/// A start stays where there is no such place.
void drive_out_farther(std::span<RobotTask> robots, const ClearanceField& field, double beyond) {
  for (RobotTask& robot : robots) {
    if (!robot.stands_at) continue;
    const Point2 place = *robot.stands_at;
    if (room_near(robot, place, field, beyond)) begin_at(robot, place, field, beyond);
  }
}

/// Metres that robot k may be off its reference at its start and its goal. Robots that are close share the
/// room.
double room_at_ends(const std::vector<RobotTask>& robots, std::size_t k, const ClearanceField& field) {
  const RobotTask& own = robots[k];
  double room = std::min(field.clearance(own.start), field.clearance(own.goal)) - driving_radius(own);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (i == k) continue;
    const double distance =
        std::min((robots[i].start - own.start).norm(), (robots[i].goal - own.goal).norm());
    room = std::min(room, (distance - driving_radius(robots[i]) - driving_radius(own)) / 2);
  }
  return room - rounding;
}

/// A robot that has a way without its tolerance has one with it.
bool has_way(const RobotTask& robot, const ClearanceField& field) {
  const auto has_way_for = [&](double radius) {
    return ReachablePart::around(field, radius, robot.start).contains(robot.goal);
  };
  return has_way_for(driving_radius(robot)) || !has_way_for(driving_radius(robot) - robot.tracking_tolerance);
}

bool all_passages_stay(const std::vector<RobotTask>& robots, const ClearanceField& field, double margin) {
  std::vector<Point2> places;
  std::set<double> radii;
  for (const RobotTask& robot : robots) {
    places.push_back(robot.start);
    places.push_back(robot.goal);
    radii.insert(driving_radius(robot));
  }
  return std::ranges::all_of(
      radii, [&](double radius) { return leaves_all_passages(field, radius, margin, places); });
}

}  // namespace

void fit_margin(Scenario& scenario, double wished) {
  const ClearanceField field(scenario.map);
  for (const double share : shares) {
    scenario.margin = share * wished;
    std::vector<RobotTask> robots = scenario.robots;
    drive_out_farther(robots, field, scenario.margin);
    if (!ends_fit(robots, field, scenario.margin) || !all_passages_stay(robots, field, scenario.margin))
      continue;
    scenario.robots = std::move(robots);
    return;
  }
  scenario.margin = 0;
}

void fit_tracking_tolerances(Scenario& scenario, const std::vector<WishedTolerance>& wished) {
  const ClearanceField field(scenario.map);
  std::vector<RobotTask>& robots = scenario.robots;
  for (RobotTask& robot : robots) robot.tracking_tolerance = 0;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    const double most = std::min(wished[k].most, robots[k].radius);
    drive_out_farther(std::span(robots).subspan(k, 1), field, most);
  }
  std::vector<double> most;
  for (std::size_t k = 0; k < robots.size(); ++k)
    most.push_back(std::min(wished[k].most, room_at_ends(robots, k, field)));
  for (const double share : shares_of_tolerance) {
    for (std::size_t k = 0; k < robots.size(); ++k) {
      RobotTask& robot = robots[k];
      if (robot.tracking_tolerance > 0) continue;
      robot.tracking_tolerance = share * most[k];
      if (robot.tracking_tolerance >= wished[k].least && has_way(robot, field)) continue;
      robot.tracking_tolerance = 0;
    }
  }
  for (std::size_t k = 0; k < robots.size(); ++k) {
    if (robots[k].tracking_tolerance > 0) continue;
    throw InputError(
        fmt::format("robots[{}]: its start, goal or way leaves {} no room to follow its reference, expected "
                    "{:.3g} m beyond the radius",
                    k, robots[k].name, wished[k].least));
  }
}

}  // namespace coppice
