#include "simulation/sentinel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "coppice/motion/separation.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

// Metres and metres per second: positions that add up in another order, and what a journal holds of them.
constexpr double rounding_of_places = 1e-6;
constexpr double rounding_of_times = 1e-6;   // seconds; a Driver allows for as much
constexpr double rounding_of_clocks = 1e-9;  // seconds: they count from other epochs
// Seconds after which nobody counts on a reservation any more that was replaced: agents count on states of
// 2 s. So what is left is never named.
constexpr double forgotten_after = 60;
// Radii by which a robot may be off the point to which it says it has come, beyond its strip: close to the
// end of a leg it counts as being there, and the point on the way may be at the other side of a corner.
constexpr double close_to_an_end = 0.02;

/// The same body at `until`, if nothing more was decided.
Driver driven_on(Driver body, double until) {
  while (body.time() + body.period() / 2 < until && !(body.stands() && !body.turns_on_the_spot()))
    body.advance();
  return body;
}

bool does_the_same_next(const Driver& a, const Driver& b) {
  const Promise next = a.promise();
  const Promise other = b.promise();
  return next.next_velocity == other.next_velocity &&
         next.next_angular_velocity == other.next_angular_velocity;
}

std::array<double, 4> room_of(const CommittedLine& line, double radius) {
  Point2 least = line.points.front();
  Point2 most = least;
  for (const Point2& p : line.points) {
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  return {least.x() - radius, least.y() - radius, most.x() + radius, most.y() + radius};
}

}  // namespace

Sentinel::Sentinel(const Scenario& scenario) {
  for (const RobotTask& task : scenario.robots) {
    names_.insert(task.name);
    robots_.push_back({.name = task.name,
                       .radius = driving_radius(task),
                       .max_speed = task.max_speed,
                       .run = {},
                       .line = {.points = {body_begins_at(task)}}});
    rooms_.push_back(room_of(robots_.back().line, robots_.back().radius));
  }
}

void Sentinel::breaks(std::string what) {
  if (!broken_) broken_ = std::move(what);
}

void Sentinel::Robot::begin(const RunId& next) {
  if (run == next) return;
  run = next;
  body.reset();
  promise.reset();
  reservation = 0;
  strips.clear();
  relies.clear();
}

ReservedStrip* Sentinel::Robot::strip(std::uint32_t number) {
  const auto found = std::ranges::find(strips, number, &ReservedStrip::number);
  return found == strips.end() ? nullptr : &*found;
}

void Sentinel::hear(const Message& message, double now) {
  if (const auto* const state = std::get_if<RobotState>(&message)) {
    if (!state->passed_on && state->copy == 0) hear_state(*state, now);
  } else if (const auto* const reservation = std::get_if<ReservationMessage>(&message)) {
    hear_reservation(*reservation, now);
  }
}

void Sentinel::hear_state(const RobotState& state, double now) {
  const auto number = names_.find(state.robot);
  if (!number) return;
  Robot& robot = robots_[*number];
  robot.begin(state.run);
  if (robot.promise) check_promise(robot, state, now);
  robot.promise = state.promise;
  robot.reservation = state.reservation;
  if (const ReservedStrip* const strip = robot.strip(state.reservation))
    check_progress(robot, *strip, state, now);
}

void Sentinel::hear_reservation(const ReservationMessage& reservation, double now) {
  const auto number = names_.find(reservation.robot);
  if (!number) return;
  Robot& robot = robots_[*number];
  robot.begin(reservation.run);
  std::erase_if(robot.strips,
                [&](const ReservedStrip& strip) { return now > strip.replaced_at + forgotten_after; });
  if (!robot.strips.empty()) robot.strips.back().replaced_at = std::min(robot.strips.back().replaced_at, now);
  if (!reservation.trajectory.empty()) robot.strips.emplace_back(reservation);
}

/// L1: a state says again where its robot is, and what it does until the promise of the last one expires.
void Sentinel::check_promise(const Robot& robot, const RobotState& state, double now) {
  const Promise& next = state.promise;
  const Driver promised =
      driven_on(Driver(*robot.promise, state.radius, limits_of(state), control_period), next.stamp);
  const bool is_elsewhere = (promised.position() - next.position).norm() > rounding_of_places ||
                            (promised.velocity() - next.velocity).norm() > rounding_of_places;
  const bool is_bound = next.decision_time + rounding_of_times < robot.promise->expiry;
  const bool turns_away =
      is_bound && (promised.promise().next_velocity - next.next_velocity).norm() > rounding_of_places;
  if (is_elsewhere || turns_away)
    breaks(fmt::format("L1: {} does not keep the promise of its last state, at {:.3f} s", robot.name, now));
}

/// L14: others open their gates by what a robot says of its progress.
void Sentinel::check_progress(const Robot& robot, const ReservedStrip& strip, const RobotState& state,
                              double now) {
  const Point2 said = strip.way.at(state.reservation_progress);
  const double off = (said - state.promise.position_at_decision()).norm();
  if (off <= strip.stray + close_to_an_end * state.radius) return;
  breaks(
      fmt::format("L14: {} says that it comes {:.3f} m along its way, and is {:.3f} m off that, at {:.3f} s",
                  robot.name, state.reservation_progress, off, now));
}

bool Sentinel::look(std::size_t number, const SeenAgent& agent, double now) {
  Robot& robot = robots_[number];
  const Driver& body = agent.body;
  robot.begin(agent.run);
  if (robot.body && body.time() <= robot.body->time()) return false;
  ++decisions_;
  bool goes_on = false;
  if (robot.body) {
    const Driver expected = driven_on(*robot.body, body.time());
    goes_on = does_the_same_next(expected, body);
    if ((expected.position() - body.position()).norm() > rounding_of_places ||
        (expected.velocity() - body.velocity()).norm() > rounding_of_places)
      breaks(fmt::format("A1: {} is not on the line of its last decision, at {:.3f} s", robot.name, now));
  }
  robot.body = body;
  robot.clock = agent.clock;
  if (goes_on) return true;  // on a line that was checked, and for which it relies on the same robots
  robot.radius = body.radius();
  robot.max_speed = body.limits().max_speed * (1 + agent.clock.drift);
  commit(body, agent.clock, robot.line);
  ++robot.lines;
  rooms_[number] = room_of(robot.line, robot.radius);
  check_obstacles(robot, agent.field, now);
  check_others(number, now);
  check_strips(number, now);
  rely(robot, agent.left_out, now);
  return true;
}

/// L6. A robot that begins in an obstacle drives out: it comes no closer to it.
void Sentinel::check_obstacles(const Robot& robot, const ClearanceField& field, double now) {
  const Path& points = robot.line.points;
  if (points.size() < 2) return;
  const double radius = robot.radius - overlap_tolerance;
  const bool is_straight = robot.body->promise().next_angular_velocity == 0;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const Point2& to = is_straight ? points.back() : points[k + 1];
    if (!field.segment_free(points[k], to, radius) &&
        field.segment_clearance(points[k], to) <
            std::min(radius, field.clearance(points[1]) - overlap_tolerance))
      return breaks(fmt::format("L6: the line of {} leads into an obstacle, at {:.3f} s", robot.name, now));
    if (is_straight) return;
  }
}

/// L6: the lines of all others stay where they are until these decide anew, and then theirs are checked.
void Sentinel::check_others(std::size_t number, double now) {
  const Robot& robot = robots_[number];
  const Room& own = rooms_[number];
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    const Room& room = rooms_[k];
    if (room[0] > own[2] || room[1] > own[3] || room[2] < own[0] || room[3] < own[1] || k == number) continue;
    const Robot& other = robots_[k];
    const double touching = robot.radius + other.radius - overlap_tolerance;
    if (const auto meet = first_closer(robot.line, other.line, touching, now))
      breaks(fmt::format("L6: the line of {}, of {:.3f} s, meets that of {} at {:.3f} s", robot.name, now,
                         other.name, *meet));
  }
}

/// Whether a robot is in a strip, and stays there on its line.
bool Sentinel::keeps_to(const Robot& robot, ReservedStrip& strip, double now) {
  if (strip.checked != robot.lines || robot.lines == 0) {
    strip.checked = robot.lines;
    strip.holds = stays_in(strip, robot.line, now);
  }
  return strip.holds;
}

/// Whether a body on its line may touch another robot before a time, wherever that one drives meanwhile.
bool Sentinel::could_meet(const Robot& robot, const Robot& other, double until, double now) {
  const double gap = (robot.line.at(now) - other.line.at(now)).norm() - robot.radius - other.radius;
  return gap <= robot.line.length_after(now) + other.max_speed * (until - now);
}

/// L14: a robot stays in a strip for as long as somebody counts on that.
void Sentinel::check_strips(std::size_t number, double now) {
  Robot& robot = robots_[number];
  for (ReservedStrip& strip : robot.strips) {
    if (strip.relied_until <= now || keeps_to(robot, strip, now)) continue;
    for (const Robot& other : robots_) {
      for (const Reliance& reliance : other.relies) {
        if (reliance.on != number || reliance.number != strip.number || reliance.until <= now) continue;
        if (could_meet(other, robot, reliance.until, now))
          breaks(
              fmt::format("L14: {} leaves the strip of its reservation {} at {:.3f} s, on which {} relies "
                          "until {:.3f} s",
                          robot.name, strip.number, now, other.name, reliance.until));
      }
    }
  }
}

/// L14: whom a robot left out of a decision is in its strip. The robot is in its own strip, too. Until its
/// turn it is on the line of the decision before.
void Sentinel::rely(Robot& robot, std::span<const ReservationId> left_out, double now) {
  const double decision_time = robot.line.begin + robot.line.period;
  for (Reliance& reliance : robot.relies) reliance.until = std::min(reliance.until, decision_time);
  std::erase_if(robot.relies, [&](const Reliance& reliance) { return reliance.until <= now; });
  const double until = robot.line.end();
  if (left_out.empty() || until <= now) return;
  ReservedStrip* const own = robot.strip(robot.reservation);
  if (own != nullptr && !keeps_to(robot, *own, now))
    breaks(fmt::format("L14: {} leaves its strip at {:.3f} s, and leaves others out", robot.name, now));
  for (const ReservationId& id : left_out) {
    const auto on = names_.find(id.robot);
    if (!on || robots_[*on].run != robot.run) continue;
    Robot& other = robots_[*on];
    ReservedStrip* const strip = other.strip(id.number);
    if (strip == nullptr)
      return breaks(
          fmt::format("L14: {} relies on a reservation {} that {} has not made of late, at {:.3f} s",
                      robot.name, id.number, id.robot, now));
    robot.relies.push_back({*on, id.number, until});
    strip->relied_until = std::max(strip->relied_until, until);
    if (!keeps_to(other, *strip, now) && could_meet(robot, other, until, now))
      breaks(
          fmt::format("L14: {} relies until {:.3f} s on reservation {} of {}, which has left its strip, at "
                      "{:.3f} s",
                      robot.name, until, id.number, id.robot, now));
  }
}

/// L3.
void Sentinel::check_clock(std::size_t number, std::size_t peer, const ClockOffset& believed, double now) {
  const Robot& robot = robots_[number];
  const Robot& other = robots_[peer];
  if (!robot.body || !other.body || robot.run != other.run || !believed.known()) return;
  const double own = robot.clock.local(now);
  const double off = std::abs(believed.estimate() - (own - other.clock.local(now)));
  if (off <= believed.error(own) + rounding_of_clocks) return;
  breaks(fmt::format("L3: {} is {:.6f} s off the clock of {}, and counts on {:.6f} s, at {:.3f} s",
                     robot.name, off, other.name, believed.error(own), now));
}

}  // namespace coppice
