#include "simulation/fuzz_bodies.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "planning/quantities.h"
#include "simulation/fuzz_random.h"

namespace coppice {

namespace {

constexpr double least_share_of_room = 0.35;
// Shares of a robot's room by which it may be off its reference.
constexpr double least_tolerance = 0.15;
constexpr double largest_tolerance = 0.35;
// Seconds in which a robot crosses the map at full speed: a slower one makes runs long, and tries nothing
// new.
constexpr double longest_crossing = 120;
constexpr double fastest = 25;  // times its room, in a second
// Seconds from full speed to standstill.
constexpr double shortest_usual_braking = 0.05;
constexpr double longest_usual_braking = 60;
constexpr double shortest_braking = 0.02;  // within one control period
constexpr double rounding = 1e-9;
constexpr double longest_stop_of_turning = 10;
// Radians a second. Half a turn takes 15 s, and four control periods.
constexpr double slowest_turning = 0.2;
constexpr std::size_t most_unlike = 12;  // robots
constexpr double largest_margin = 0.4;   // of the least radius

/// The drawn properties of a body. Robots of a fleet may differ in each of them.
struct Body {
  double share_of_room = 1;
  double max_speed = 0;
  double braking = 0;  ///< seconds from full speed
  bool turns = false;  ///< a differential robot
  double max_angular_speed = 0;
  double stop_of_turning = 0;  ///< seconds from full turning
  bool has_footprint = false;
};

/// Among what the bodies of a fleet are drawn.
struct Kinds {
  double slowest = 0;
  double fastest = 0;
  double share_of_differential = 0;
  double share_of_footprints = 0;
};

Kinds draw_kinds(const Scenario& scenario, Random& random) {
  const Box<2> box = scenario.map.frame().bounds();
  const double slowest = (box.upper - box.lower).norm() / longest_crossing;
  const double room = std::ranges::min_element(scenario.robots, {}, &RobotTask::radius)->radius;
  const double drive = random.uniform();
  return {.slowest = slowest,
          .fastest = std::max(2 * slowest, fastest * room),
          .share_of_differential = drive < 0.4   ? 0
                                   : drive < 0.7 ? 1
                                                 : 0.5,
          .share_of_footprints = chance(0.25, random) ? random.uniform(0.3, 1) : 0};
}

double draw_braking(Random& random) {
  if (chance(0.05, random)) return shortest_braking;
  if (chance(0.05, random)) return longest_braking * (1 - rounding);
  return log_uniform(shortest_usual_braking, longest_usual_braking, random);
}

Body draw_body(const Kinds& kinds, Random& random) {
  return {.share_of_room = chance(0.4, random) ? 1 : random.uniform(least_share_of_room, 1),
          .max_speed = log_uniform(kinds.slowest, kinds.fastest, random),
          .braking = draw_braking(random),
          .turns = chance(kinds.share_of_differential, random),
          .max_angular_speed = log_uniform(slowest_turning, fastest_turning, random),
          .stop_of_turning = log_uniform(shortest_usual_braking, longest_stop_of_turning, random),
          .has_footprint = chance(kinds.share_of_footprints, random)};
}

/// In what the robots of a fleet differ.
struct Unlike {
  bool size = false;
  bool speed = false;
  bool braking = false;
  bool turning = false;
};

/// Each robot of an own size has a lattice of its own: large fleets of unlike robots take minutes of
/// processor time.
Unlike draw_differences(std::size_t robots, Random& random) {
  if (chance(0.4, random) || robots > most_unlike) return {};
  return {chance(0.6, random), chance(0.6, random), chance(0.6, random), chance(0.6, random)};
}

Body mixed(const Body& common, const Body& own, const Unlike& unlike) {
  Body body = common;
  body.turns = own.turns;
  body.has_footprint = own.has_footprint;
  if (unlike.size) body.share_of_room = own.share_of_room;
  if (unlike.speed) body.max_speed = own.max_speed;
  if (unlike.braking) body.braking = own.braking;
  if (!unlike.turning) return body;
  body.max_angular_speed = own.max_angular_speed;
  body.stop_of_turning = own.stop_of_turning;
  return body;
}

/// A rectangle whose corners lie on the circle.
std::vector<Point2> draw_footprint(double radius, Random& random) {
  const double half_diagonal = random.uniform(0.2, 0.8);  // radians
  const Point2 corner = radius * Point2(std::cos(half_diagonal), std::sin(half_diagonal));
  return {corner, {-corner.x(), corner.y()}, -corner, {corner.x(), -corner.y()}};
}

void give_turning(RobotTask& robot, const Body& body, Random& random) {
  robot.max_angular_speed = body.max_angular_speed;
  robot.max_angular_acceleration = body.max_angular_speed / body.stop_of_turning;
  robot.start_yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
  if (chance(0.5, random)) return;
  robot.goal_yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
  robot.goal_yaw_tolerance = default_yaw_tolerance;
}

/// The robot takes up no more than its room, with all that its radius does not hold.
void give_body(RobotTask& robot, const Body& body, bool follows, Random& random) {
  const double room = robot.radius;
  robot.max_speed = body.max_speed;
  robot.max_acceleration = std::max(least_quantity, body.max_speed / body.braking);
  if (body.turns) give_turning(robot, body, random);
  if (follows) robot.tracking_tolerance = room * random.uniform(least_tolerance, largest_tolerance);
  const double beyond_radius = driving_radius(robot) - robot.radius;
  robot.radius = std::max(least_share_of_room / 2 * room, body.share_of_room * room - beyond_radius);
  if (!body.has_footprint) return;
  robot.footprint = draw_footprint(robot.radius, random);
  robot.radius = radius_of_footprint(robot.footprint, "footprint");
}

}  // namespace

void draw_bodies(Scenario& scenario, bool follow, std::uint32_t seed) {
  Random random = source_of(FuzzPart::bodies, seed);
  const Kinds kinds = draw_kinds(scenario, random);
  const Unlike unlike = draw_differences(scenario.robots.size(), random);
  const Body common = draw_body(kinds, random);
  for (RobotTask& robot : scenario.robots)
    give_body(robot, mixed(common, draw_body(kinds, random), unlike), follow, random);
  const double radius = std::ranges::min_element(scenario.robots, {}, &RobotTask::radius)->radius;
  if (chance(0.3, random)) fit_margin(scenario, random.uniform(0.05, largest_margin) * radius);
}

}  // namespace coppice
