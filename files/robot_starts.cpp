#include "files/robot_starts.h"

#include <algorithm>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "motion/trajectory/segments.h"
#include "planning/geometry/way_out.h"
#include "planning/number_text.h"

namespace coppice {

namespace {

/// The way that a robot drives before it plans: mostly a point.
Path first_way(const RobotTask& robot) {
  return {robot.stands_at.value_or(robot.start), robot.start};
}

}  // namespace

std::optional<Point2> room_near(const RobotTask& robot, const Point2& place, const ClearanceField& field,
                                double beyond) {
  const double overlap = start_tolerance(robot.goal_tolerance, robot.radius) + robot.tracking_tolerance +
                         field.inflation() + beyond;
  return way_out(field, place, driving_radius(robot) + beyond, overlap);
}

void begin_at(RobotTask& robot, Point2 place, const ClearanceField& field, double beyond) {
  const bool stays = robot.goal == robot.start;
  robot.start = room_near(robot, place, field, beyond).value_or(place);
  robot.stands_at = robot.start == place ? std::nullopt : std::optional(place);
  if (stays) robot.goal = robot.start;
}

void check_place(const Point2& place, const ClearanceField& field, double radius, const std::string& name) {
  const Box<2> box = field.bounds();
  if (!(place.array() >= box.lower.array()).all() || !(place.array() <= box.upper.array()).all())
    throw InputError(fmt::format("{}: ({}, {}) is outside of the map, which covers ({}, {}) to ({}, {})",
                                 name, place.x(), place.y(), box.lower.x(), box.lower.y(), box.upper.x(),
                                 box.upper.y()));
  if (field.is_free(place, radius)) return;
  const auto [clearance, needed] = told_apart(field.clearance(place), radius);
  throw InputError(
      fmt::format("{}: ({}, {}) is inside of an obstacle or too near to one: clearance {}, radius {}", name,
                  place.x(), place.y(), clearance, needed));
}

/// Two short ways come closest at an end of one of them.
double distance_at_starts(const RobotTask& one, const RobotTask& other) {
  const Path a = first_way(one);
  const Path b = first_way(other);
  return std::min({point_segment_distance(a[0], b[0], b[1]), point_segment_distance(a[1], b[0], b[1]),
                   point_segment_distance(b[0], a[0], a[1]), point_segment_distance(b[1], a[0], a[1])});
}

std::string warning_of_start(const RobotTask& robot, const ClearanceField& field) {
  if (!robot.stands_at) return {};
  const Point2& place = *robot.stands_at;
  const double overlap = driving_radius(robot.radius, limits_of(robot)) - field.clearance(place);
  if (overlap <= 0) return {};
  return fmt::format("{} starts {:.3g} m too near to an obstacle, at ({:g}, {:g}): it drives out first",
                     robot.name, overlap, place.x(), place.y());
}

}  // namespace coppice
