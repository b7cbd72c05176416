// One moment of a robot in sentences: see explanation.h.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "monitor/recording/explanation.h"
#include "monitor/recording/words.h"
#include "monitor/view/fleet_table.h"
#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr double same_time = 1e-6;       // seconds: rounding of wall clock
constexpr double in_time = 0.2;          // seconds: a robot that is less late is in time
constexpr std::size_t most_named = 8;    // robots in a list
constexpr double heard_recently = 5;     // seconds
constexpr std::size_t most_failed = 10;  // failed robots that are named

/// The moment, and the robot in it.
struct Moment {
  double time;
  const Stories& stories;
  const FleetMoment& fleet;
  const SeenRobot& robot;  ///< it has said a state
  WallTime now;            ///< of the last message before
};

FleetMoment fleet_at(const Recording& recording, const RobotName& listener, double time, WallTime& now) {
  FleetMoment moment(listener);
  Playback playback(recording, recording.begin(), topics_of_stories());
  now = recording.begin();
  while (const auto next = playback.next()) {
    const auto at = moment.time_at(next->at);
    if (at && *at > time + same_time) break;
    moment.on(*next);
    now = next->at;
  }
  return moment;
}

std::string where_it_was(const Moment& m) {
  const RobotState& state = *m.robot.state;
  const double fleet_now = m.fleet.view().fleet_time(m.now).value_or(state.promise.stamp);
  const std::string at = place(position_at(state, fleet_now));
  if (is_lost(m.robot, m.now))
    return fmt::format("Place: not known. It was last heard at {}, {:.1f} s before.",
                       place(state.promise.position), fleet_now - state.promise.stamp);
  const bool turned = fleet_now >= state.promise.decision_time;
  const Point2 v = turned ? state.promise.next_velocity : state.promise.velocity;
  if (v.isZero(0)) return fmt::format("Place: {}. It stood.", at);
  return fmt::format("Place: {}. It drove with {:.2f} m/s (at most {:.2f}), velocity ({:.2f}, {:.2f}).", at,
                     v.norm(), state.max_speed, v.x(), v.y());
}

std::string task_of(const Moment& m) {
  const SeenRobot& robot = m.robot;
  if (!robot.mission) return "Task: none that the recording tells.";
  std::string task =
      fmt::format("Task: mission {}, to {}", robot.mission->number, place(robot.mission->goal));
  if (const OrderMessage* const order = m.fleet.order_of(robot))
    task += fmt::format(", for order {}", order->id);
  task += fmt::format(". Phase: {}", name_of(robot.state->phase));
  if (robot.status && robot.status->way_left > 0)
    task += fmt::format(", with {} to go", metres(robot.status->way_left));
  return task + ".";
}

/// The robot for which another one waits; empty: none.
RobotName awaited_by(const RobotName& robot, const Episode& e, const FleetMoment& fleet) {
  if (e.doing.act == Act::gate || e.doing.act == Act::joint_plan)
    return e.doing.other == robot ? RobotName() : e.doing.other;
  const SeenRobot* const seen = fleet.robot(robot);
  if (e.doing.act != Act::blocked || seen == nullptr || !seen->state) return {};
  const SeenRobot* const other = in_the_way(fleet, *seen->state);
  return other != nullptr ? other->name : RobotName();
}

/// What each robot of the chain of waits did, from the one that this robot waits for to the last one.
void add_chain(const Moment& m, const Episode& first, std::vector<std::string>& lines) {
  std::set<RobotName> known{m.robot.name};
  RobotName next = awaited_by(m.robot.name, first, m.fleet);
  while (!next.empty()) {
    if (!known.insert(next).second) {
      lines.push_back(fmt::format("  {} again: these robots waited for each other.", next));
      return;
    }
    const auto story = m.stories.robots.find(next);
    const Episode* const e = story == m.stories.robots.end() ? nullptr : episode_at(story->second, m.time);
    if (e == nullptr) return;
    lines.push_back("  " + sentence_of(next, *e));
    next = awaited_by(next, *e, m.fleet);
  }
}

std::string gate_by_now(const Moment& m, const Episode& e) {
  if (e.doing.act != Act::gate) return {};
  const auto gate = gate_ahead(m.fleet, *m.robot.state, e.doing.other);
  if (!gate) return {};
  return fmt::format("  By {:.2f} s {} had {} to go until the gate opens.", m.time, e.doing.other,
                     metres(gate->left));
}

std::string progress_of(const Moment& m, const ReservationMessage& r) {
  const RobotState& state = *m.robot.state;
  if (state.reservation != r.number) return " It had not set out on it.";
  const double leaves = rest_of(r.trajectory, state.reservation_progress).front().time;
  const double late = state.promise.decision_time - leaves;
  return fmt::format(" It had come {} along it; by its times it leaves that place at {:.2f} s{}.",
                     metres(state.reservation_progress), m.fleet.time_of(leaves).value_or(0),
                     late > in_time ? fmt::format(", so it was {:.1f} s late", late) : "");
}

std::string basis_of(const ReservationMessage& r) {
  if (!r.plan.leader.empty()) return fmt::format(" It is its part of the joint plan of {}.", r.plan.leader);
  if (r.basis.empty()) return " It comes near no other reservation.";
  std::vector<RobotName> around;
  for (const ReservationBasis& b : r.basis) around.push_back(b.robot);
  return fmt::format(" It was planned around those of {}.", listed(around, most_named));
}

std::string reservation_of(const Moment& m) {
  const SaidReservation* const said = m.fleet.reservation(m.robot.name);
  if (said == nullptr) return "Reservation: none.";
  if (said->is_wish())
    return fmt::format("Reservation: none. It waited for its turn to reserve the next {}.",
                       metres(said->message.way));
  if (said->is_given_up) return "Reservation: none. It had given up the last one.";
  if (!said->has_trajectory()) return "Reservation: none.";
  const Trajectory& t = said->message.trajectory;
  return fmt::format("Reservation: number {}, from {} at {:.2f} s to {} at {:.2f} s.", said->message.number,
                     place(t.front().position), m.fleet.time_of(t.front().time).value_or(0),
                     place(t.back().position), m.fleet.time_of(t.back().time).value_or(0)) +
         progress_of(m, said->message) + basis_of(said->message);
}

std::string contact_of(const Moment& m) {
  const RobotState& state = *m.robot.state;
  if (is_lost(m.robot, m.now)) return "Contact: none. It was not heard.";
  std::vector<std::string> lacks;
  if (!state.misses.empty()) lacks.push_back("it heard nothing of " + listed(state.misses, most_named));
  if (state.wants_echo) lacks.emplace_back("it asked others to confirm that they hear it");
  if (state.is_new) lacks.emplace_back("it might not know where all others were");
  if (state.may_be_unknown) lacks.emplace_back("somebody might not know it");
  return lacks.empty() ? "Contact: it was connected. Others confirmed its states, and it missed nobody."
                       : fmt::format("Contact: {}.", fmt::join(lacks, "; "));
}

/// Tells what the robot had heard of the one for which it waited, as far as it said so.
std::string heard_of(const Moment& m, const RobotName& other) {
  std::string text;
  const double now = m.robot.state->promise.stamp;
  if (const auto echo = m.fleet.heard().find(other); echo != m.fleet.heard().end())
    text += fmt::format(" Of {} it last confirmed one that came {:.2f} s before.", other,
                        std::max(0.0, now - echo->second.received));
  const auto heeded = m.fleet.heeded().find(other);
  const SaidReservation* const newest = m.fleet.reservation(other);
  if (heeded == m.fleet.heeded().end() || newest == nullptr) return text;
  const bool is_newest = heeded->second >= newest->message.number;
  return text + fmt::format(" It heeded reservation {} of {}, {}.", heeded->second, other,
                            is_newest ? "the newest one"
                                      : fmt::format("and {} was the newest", newest->message.number));
}

std::string what_it_had_heard(const Moment& m, const Episode& e) {
  const double now = m.robot.state->promise.stamp;
  const auto recent = std::ranges::count_if(
      m.fleet.heard(), [&](const auto& echo) { return now - echo.second.received < heard_recently; });
  const RobotName other = awaited_by(m.robot.name, e, m.fleet);
  return fmt::format("Heard: it confirmed states of {} robots within the last {:g} s.{}", recent,
                     heard_recently, other.empty() ? std::string() : heard_of(m, other));
}

/// What lies before the robot: the rest of its reservation, or its path.
Path way_ahead(const Moment& m) {
  const SaidReservation* const said = m.fleet.reservation(m.robot.name);
  const RobotState& state = *m.robot.state;
  const bool drives = said != nullptr && said->has_trajectory() && state.reservation == said->message.number;
  return drives ? path_of(rest_of(said->message.trajectory, state.reservation_progress)) : m.robot.path;
}

/// Metres along a way to where it comes nearer than `near` to a point; none: it does not.
std::optional<double> metres_to(const Path& way, const Point2& p, double near) {
  double along = 0;
  for (std::size_t k = 1; k < way.size(); ++k) {
    if (const auto chord = chord_in_disc(way[k - 1], way[k], p, near)) return along + chord->begin;
    along += (way[k] - way[k - 1]).norm();
  }
  return std::nullopt;
}

std::string failed_one(const Moment& m, const SeenRobot& failed) {
  const Limits limits{failed.state->max_speed, failed.state->max_acceleration,
                      failed.state->max_angular_speed, failed.state->max_angular_acceleration};
  const Point2 rest = rest_after(failed.state->promise, limits, control_period);
  const auto ahead = metres_to(way_ahead(m), rest, failed.state->radius + m.robot.state->radius);
  const std::string where =
      ahead ? fmt::format("It closes the way of {}, {} ahead.", m.robot.name, metres(*ahead))
            : fmt::format("It does not stand on the way of {}.", m.robot.name);
  return fmt::format("Failed: {} was last heard at {:.2f} s. It rests at about {}. {}", failed.name,
                     m.fleet.time_of(failed.state->promise.stamp).value_or(0), place(rest), where);
}

void add_failed(const Moment& m, std::vector<std::string>& lines) {
  std::size_t named = 0;
  for (const SeenRobot& other : m.fleet.view().robots()) {
    const bool failed = other.state && (is_lost(other, m.now) || m.fleet.failed_since(other.name));
    if (!failed || other.name == m.robot.name || ++named > most_failed) continue;
    lines.push_back(failed_one(m, other));
  }
  if (named == 0) lines.emplace_back("Failed: nobody.");
  if (named > most_failed) lines.push_back(fmt::format("Failed: {} more.", named - most_failed));
}

}  // namespace

std::vector<std::string> explain_moment(const Recording& recording, const Stories& stories,
                                        const RobotName& robot, double time) {
  WallTime now = 0;
  const FleetMoment fleet = fleet_at(recording, robot, time, now);
  const SeenRobot* const seen = fleet.robot(robot);
  const Episode* const e = episode_at(stories.robots.at(robot), time);
  if (seen == nullptr || !seen->state || e == nullptr)
    return {fmt::format("{} at {:.2f} s: it had not said yet where it was.", robot, time)};
  const Moment m{time, stories, fleet, *seen, now};
  std::vector<std::string> lines{fmt::format("{} at {:.2f} s", robot, time), where_it_was(m), task_of(m),
                                 "Decision: " + sentence_of(robot, *e)};
  if (const std::string gate = gate_by_now(m, *e); !gate.empty()) lines.push_back(gate);
  add_chain(m, *e, lines);
  lines.push_back(reservation_of(m));
  lines.push_back(contact_of(m));
  lines.push_back(what_it_had_heard(m, *e));
  add_failed(m, lines);
  return lines;
}

}  // namespace coppice
