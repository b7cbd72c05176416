#include "messages/validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "coppice/motion/trajectory.h"
#include "messages/topics.h"

namespace coppice {

namespace {

using Problem = std::optional<std::string>;

bool sane(const Point2& p) {
  return is_sane(p.x()) && is_sane(p.y());
}
bool not_negative(double x) {
  return x >= 0 && x <= largest_quantity;
}

/// How many of its bytes a character of UTF-8 takes that begins here; 0 if none does, or one that commands a
/// terminal.
std::size_t printable_bytes(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  if (byte(0) < 0x80) return byte(0) >= 0x20 && byte(0) != 0x7f;
  const std::size_t length = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < length) return 0;
  std::uint32_t code = byte(0) & (0xffu >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(k) & 0x3fu);
  }
  constexpr std::array<std::uint32_t, 5> least{0, 0, 0xa0, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code < 0xe000;
  return code >= least[length] && code <= 0x10ffff && !is_surrogate ? length : 0;
}

/// Reports and logs quote it.
bool printable(std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = printable_bytes(text);
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}
bool named_or_empty(const std::string& name) {
  return name.size() <= longest_name && printable(name);
}
bool named(const std::string& name) {
  return !name.empty() && named_or_empty(name);
}
bool known(Phase phase) {
  return phase <= Phase::halted;
}

Problem first_of(std::initializer_list<std::pair<bool, const char*>> checks) {
  for (const auto& [holds, text] : checks) {
    if (!holds) return text;
  }
  return std::nullopt;
}

Problem check(const TreeParameters& trees) {
  const auto fault = fault_of(trees);
  return fault ? Problem("trees: " + std::string(*fault)) : std::nullopt;
}

Problem check(const MapMessage& m) {
  const auto in_range = [](int cells) { return cells >= 1 && cells <= largest_map_side; };
  if (auto problem = check(m.trees)) return problem;
  return first_of({{named(m.map_id), "map id is empty, too long or not printable"},
                   {not_negative(m.margin), "margin is negative or not finite"},
                   {in_range(m.map.width) && in_range(m.map.height), "map size is out of range"},
                   {is_sane_size(m.map.resolution), "resolution is out of range"},
                   {sane(m.map.origin), "origin is not finite"},
                   {m.map.y_axis <= YAxis::up, "unknown y axis"},
                   {m.map.blocked.size() == static_cast<std::size_t>(std::max(m.map.width, 0)) *
                                                static_cast<std::size_t>(std::max(m.map.height, 0)),
                    "number of cells does not agree with the size"},
                   {std::ranges::all_of(m.radii, is_sane_size), "a radius is out of range"}});
}

/// Whether a robot is holonomic, or comes to rest in time when it turns.
template <class M>
bool turns(const M& m) {
  if (m.max_angular_speed == 0 && m.max_angular_acceleration == 0) return true;
  return is_sane_size(m.max_angular_speed) && m.max_angular_speed <= fastest_turning &&
         is_sane_size(m.max_angular_acceleration) &&
         can_brake(m.max_angular_speed, m.max_angular_acceleration);
}

Problem check(const Mission& m) {
  if (auto problem = check(m.trees)) return problem;
  return first_of(
      {{named(m.robot), "robot name is empty, too long or not printable"},
       {named(m.map_id), "map id is empty, too long or not printable"},
       {m.fleet_size >= 1, "fleet size is 0"},
       {sane(m.start) && sane(m.goal), "start or goal is not finite"},
       {is_sane_size(m.radius), "radius is out of range"},
       {is_sane_size(m.max_speed), "speed limit is out of range"},
       {is_sane_size(m.max_acceleration), "acceleration limit is out of range"},
       {can_brake(m.max_speed, m.max_acceleration), "takes too long to brake"},
       {is_sane_size(m.goal_tolerance), "goal tolerance is out of range"},
       {turns(m), "angular limit is out of range"},
       {is_sane(m.start_yaw) && is_sane(m.goal_yaw), "yaw is not finite"},
       {not_negative(m.goal_yaw_tolerance), "yaw tolerance is negative or not finite"},
       {m.tracking_tolerance >= 0 && m.tracking_tolerance < m.radius,
        "tracking tolerance is negative or larger than the radius"},
       {std::ranges::all_of(m.footprint, [&](const Point2& p) { return sane(p) && p.norm() <= m.radius; }),
        "footprint is larger than the radius"},
       {m.footprint.size() <= most_corners, "footprint has too many corners"},
       {m.planner <= PlannerKind::rrt_star, "unknown planner"},
       {m.coordination <= Coordination::rvo_without_rounds, "unknown coordination"},
       {not_negative(m.plan_budget), "plan budget is negative or not finite"},
       {m.clock.epoch >= 0 && m.clock.epoch <= latest_run, "clock epoch is not a time"},
       {m.clock.scale >= least_quantity && m.clock.scale <= largest_time_scale,
        "clock scale is out of range"}});
}

Problem check(const RootNodes& m) {
  if (!named(m.robot)) return "robot name is empty, too long or not printable";
  if (!std::isfinite(m.run.epoch)) return "run has no time";
  for (std::size_t i = 0; i < m.nodes.size(); ++i) {
    const RootNodes::Node& node = m.nodes[i];
    if (!sane(node.position)) return "node position is not finite";
    if (node.side > Root::goal) return "node belongs to no root tree";
    const std::int64_t own = static_cast<std::int64_t>(m.first_index) + static_cast<std::int64_t>(i);
    if (node.parent < -1 || node.parent >= own) return "node's parent does not come before it";
  }
  return std::nullopt;
}

Problem check(const InactiveTreesMessage& m) {
  if (!named(m.map_id)) return "map id is empty, too long or not printable";
  if (!is_sane_size(m.radius)) return "radius is out of range";
  if (m.nodes.empty()) return "tree has no node";
  std::int64_t root = -1;  // index
  for (std::size_t i = 0; i < m.nodes.size(); ++i) {
    const InactiveTreesMessage::Node& node = m.nodes[i];
    if (!sane(node.position)) return "node position is not finite";
    if (!not_negative(node.edge_clearance)) return "edge clearance is negative or not finite";
    if (node.parent == -1) root = static_cast<std::int64_t>(i);
    if (node.parent != -1 && (root < 0 || node.parent < root || node.parent >= static_cast<std::int64_t>(i)))
      return "node's parent is not a node of its tree before it";
  }
  const auto fine = [&](const InactiveTreesMessage::Link& link) {
    return link.node < m.nodes.size() && (link.other != m.id || link.other_node < m.nodes.size());
  };
  if (!std::ranges::all_of(m.links, fine)) return "link is of a node that is not there";
  return std::nullopt;
}

Problem check(const ActiveTreesMessage& m) {
  const auto fine = [](const ActiveTreesMessage::Edge& e) { return sane(e.from) && sane(e.to); };
  return first_of({{m.broker != 0, "broker has no id"},
                   {named(m.map_id), "map id is empty, too long or not printable"},
                   {std::ranges::all_of(m.edges, fine), "edge is not finite"}});
}

Problem check(const RobotState& m) {
  const auto echo_fine = [](const Echo& e) {
    return named(e.robot) && is_sane(e.stamp) && is_sane(e.received);
  };
  return first_of(
      {{named(m.robot), "robot name is empty, too long or not printable"},
       {is_sane(m.promise.stamp) && is_sane(m.promise.decision_time) && is_sane(m.promise.expiry),
        "time is not finite"},
       {std::isfinite(m.run.epoch), "run has no time"},
       {m.promise.stamp <= m.promise.decision_time && m.promise.decision_time <= m.promise.expiry,
        "promise ends before it begins"},
       {m.promise.expiry - m.promise.stamp <= longest_promise, "promise is too long"},
       {sane(m.promise.position), "position is not finite"},
       {is_sane_size(m.radius), "radius is out of range"},
       {is_sane_size(m.max_speed), "speed limit is out of range"},
       {is_sane_size(m.max_acceleration), "acceleration limit is out of range"},
       {can_brake(m.max_speed, m.max_acceleration), "takes too long to brake"},
       {sane(m.promise.velocity) && m.promise.velocity.norm() <= m.max_speed * 1.001,
        "velocity is above the limit"},
       {sane(m.promise.next_velocity) && m.promise.next_velocity.norm() <= m.max_speed * 1.001,
        "promised velocity is above the limit"},
       {turns(m), "angular limit is out of range"},
       {is_sane(m.promise.yaw), "yaw is not finite"},
       {std::abs(m.promise.angular_velocity) <= m.max_angular_speed * 1.001 &&
            std::abs(m.promise.next_angular_velocity) <= m.max_angular_speed * 1.001,
        "angular velocity is above the limit"},
       {known(m.phase), "unknown phase"},
       {m.stage <= Stage::executing, "unknown stage"},
       {named_or_empty(m.round.leader) && (m.round.epoch == 0) == m.round.leader.empty(),
        "round's epoch and leader do not agree"},
       {sane(m.round.centre) && not_negative(m.round.reach), "round has no centre or reach"},
       {not_negative(m.reservation_progress), "progress is negative or not finite"},
       {named_or_empty(m.waits_for), "name of the robot waited for is too long or not printable"},
       {m.misses.size() <= most_missed && std::ranges::all_of(m.misses, named),
        "too many robots that are missed, or one whose name is empty, too long or not printable"},
       {m.knows.size() <= most_known_reservations &&
            std::ranges::all_of(m.knows, named, &ReservationId::robot),
        "too many reservations that are known, or one whose robot's name is empty, too long or not "
        "printable"},
       {m.copies > 0, "it is sent less than once"},
       {m.passed_on || !m.counts_as_failed, "it comes from a robot that counts as failed"},
       {m.echoes.size() <= most_echoes && std::ranges::all_of(m.echoes, echo_fine),
        "too many echoes, or one without a name or a finite time"}});
}

/// Tells what is wrong with a trajectory. A robot without a trajectory sends an empty one, which is valid.
Problem problem_with(const Trajectory& trajectory, double radius) {
  const auto point_fine = [](const TimedPoint& p) { return is_sane(p.time) && sane(p.position); };
  return first_of({{std::ranges::all_of(trajectory, point_fine), "point is not finite"},
                   {std::ranges::is_sorted(trajectory, std::less{}, &TimedPoint::time), "time runs back"},
                   {trajectory.size() <= most_trajectory_points, "trajectory has too many points"},
                   {length_of(path_of(trajectory)) <= most_trajectory_radii * radius,
                    "trajectory is too long for a robot that small"}});
}

Problem problem_with(std::span<const ReservationBasis> basis) {
  const auto fine = [](const ReservationBasis& b) {
    return named(b.robot) && b.number > 0 && is_sane(b.offset);
  };
  return first_of(
      {{basis.size() <= most_robots, "it was planned around too many robots"},
       {std::ranges::all_of(basis, fine), "it was planned around a robot without a name, number or time"}});
}

Problem check(const JointPlanMessage& m) {
  Problem problem =
      first_of({{m.round.epoch > 0 && named(m.round.leader), "round has no epoch or no leader"},
                {sane(m.round.centre) && not_negative(m.round.reach), "round has no centre or reach"},
                {std::isfinite(m.run.epoch), "run has no time"},
                {m.members.size() <= most_robots, "too many members"}});
  if (!problem) problem = problem_with(m.basis);
  for (const JointPlanMessage::Member& member : m.members) {
    if (problem) break;
    problem = named(member.robot) && is_sane_size(member.radius)
                  ? problem_with(member.trajectory, member.radius)
                  : Problem("member has no name or no radius");
  }
  return problem;
}

Problem check(const ReservationMessage& m) {
  const bool of_plan = !m.plan.leader.empty();
  Problem problem = first_of(
      {{named(m.robot), "robot name is empty, too long or not printable"},
       {m.number > 0, "it has no number"},
       {m.first_number > 0 && m.first_number <= m.number, "its trajectory has no number, or a later one"},
       {std::isfinite(m.run.epoch), "run has no time"},
       {is_sane_size(m.radius), "radius is out of range"},
       {not_negative(m.way), "way is negative or not finite"},
       {m.priority <= Priority::last, "unknown priority"},
       {!of_plan || (named(m.plan.leader) && m.plan.epoch > 0 && is_sane(m.plan.shift)),
        "joint plan has no epoch, or an odd leader or time"}});
  if (!problem) problem = problem_with(m.trajectory, m.radius);
  if (!problem) problem = problem_with(m.basis);
  return problem;
}

Problem check(const PathMessage& m) {
  return first_of({{named(m.robot), "robot name is empty, too long or not printable"},
                   {std::isfinite(m.run.epoch), "run has no time"},
                   {std::ranges::all_of(m.waypoints, [](const Point2& p) { return sane(p); }),
                    "waypoint is not finite"}});
}

Problem check(const TrackMessage& m) {
  const auto fine = [](const TrackMessage::Point& p) {
    return is_sane(p.time) && sane(p.position) && sane(p.velocity) && is_sane(p.yaw) &&
           is_sane(p.angular_velocity);
  };
  return first_of(
      {{named(m.robot), "robot name is empty, too long or not printable"},
       {std::isfinite(m.run.epoch), "run has no time"},
       {std::ranges::all_of(m.points, fine), "point is not finite"},
       {std::ranges::is_sorted(m.points, std::less{}, &TrackMessage::Point::time), "time runs back"}});
}

bool none_negative(const WaitTimes& w) {
  return std::ranges::all_of(wait_kinds, [&](const auto kind) { return not_negative(w.*kind); });
}

Problem check(const AgentStatus& m) {
  return first_of(
      {{named(m.robot), "robot name is empty, too long or not printable"},
       {std::isfinite(m.run.epoch), "run has no time"},
       {known(m.phase), "unknown phase"},
       {m.reason.size() <= longest_reason && printable(m.reason), "reason is too long or not printable"},
       {is_sane(m.mission_time) && is_sane(m.path_time) && is_sane(m.arrival_time) &&
            is_sane(m.plan_seconds) && is_sane(m.improve_seconds),
        "time is not finite"},
       {not_negative(m.driven_length) && is_sane(m.way_left), "length is negative or not finite"},
       {m.wait_cause.size() <= longest_reason && printable(m.wait_cause),
        "cause of its waiting is too long or not printable"},
       {is_sane(m.came_on_at) && none_negative(m.waits), "waiting is negative or not finite"},
       {std::isfinite(m.load.matched_at) && not_negative(m.load.state_age_p50) &&
            not_negative(m.load.state_age_p99) && not_negative(m.load.state_age_max) &&
            not_negative(m.load.processor_seconds),
        "load is negative or not finite"}});
}

Problem check(const BrokerStatus& m) {
  return first_of(
      {{m.broker != 0, "broker has no id"},
       {named_or_empty(m.covered_map), "map id is too long or not printable"},
       {std::isfinite(m.leading_since) && m.leading_since >= 0, "time since it leads is not a time"},
       {not_negative(m.processor_seconds), "processor time is negative or not finite"}});
}

Problem check(const ServiceStatus& m) {
  return first_of(
      {{m.service != 0, "service has no id"},
       {named_or_empty(m.host), "host is too long or not printable"},
       {std::isfinite(m.since) && m.since >= 0, "time since it runs is not a time"},
       {m.run.epoch >= 0 && m.run.epoch <= latest_run, "run is not a time"},
       {m.problem.size() <= longest_reason && printable(m.problem), "problem is too long or not printable"}});
}

Problem check(const Claim& m) {
  return first_of({{m.claimant != 0, "claimant is 0"},
                   {named_or_empty(m.robot), "robot name is too long or not printable"}});
}

Problem check(const Assignment& m) {
  return first_of({{named(m.robot), "robot name is empty or too long"}, {m.claimant != 0, "claimant is 0"}});
}

Problem check(const OrderMessage& m) {
  const auto fine = [](const Visit& v) {
    return sane(v.position) && is_sane(v.yaw) && v.wait >= 0 && v.wait <= longest_visit;
  };
  const bool goes = m.action == Action::go;
  return first_of(
      {{named(m.id), "id is empty, too long or not printable"},
       {m.action <= Action::release, "unknown action"},
       {m.robots.size() <= most_robots && std::ranges::all_of(m.robots, named),
        "too many robots, or one whose name is empty, too long or not printable"},
       {m.visits.size() <= most_visits && std::ranges::all_of(m.visits, fine),
        "too many places, or one that is not finite, or where the robot is to stand for more than a day"},
       {goes == !m.visits.empty(), "it says no place to go to, or one that its action does not need"},
       {!goes || m.robots.size() <= 1, "it is for more than one robot"},
       {named_or_empty(m.cancels) && (m.action == Action::cancel) == !m.cancels.empty(),
        "it does not say which order to cancel, or says so and does not cancel"},
       {m.action != Action::cancel || m.robots.empty(), "it cancels an order, and names a robot"},
       {!m.replaces || (goes && m.robots.size() == 1),
        "it replaces the orders of a robot, and sends no robot that it names"},
       {std::isfinite(m.deadline) && m.deadline >= 0 && m.deadline <= latest_run, "deadline is not a time"},
       {named_or_empty(m.by), "name of the sender is too long or not printable"},
       {m.why.size() <= longest_why && printable(m.why) && (m.why.empty() || m.action == Action::cancel),
        "reason is too long or not printable, or it cancels nothing"}});
}

bool is_time(WallTime at) {
  return at >= 0 && at <= latest_run;
}

Problem check(const OrderStatus& m) {
  if (auto problem = check(m.order)) return problem;
  return first_of(
      {{m.state <= OrderState::failed, "unknown state"},
       {named_or_empty(m.robot), "robot name is too long or not printable"},
       {m.reason.size() <= longest_reason && printable(m.reason), "reason is too long or not printable"},
       {m.visited <= m.order.visits.size(), "more places were visited than it has"},
       {is_time(m.accepted_at) && is_time(m.begun_at) && is_time(m.ended_at), "time is not a time"}});
}

Problem check(const HaltMessage& m) {
  const auto fine = [](const HaltMessage::Robot& r) {
    return named(r.robot) && r.halt <= Halt::paused_and_stopped;
  };
  return first_of({{m.everybody <= Halt::paused_and_stopped, "unknown halt"},
                   {m.robots.size() <= most_robots && std::ranges::all_of(m.robots, fine),
                    "too many robots, or one without a name or with an unknown halt"}});
}

}  // namespace

std::optional<std::string> problem_with(const Message& message) {
  return std::visit([](const auto& m) { return check(m); }, message);
}

bool are_free(const InactiveTreesMessage& trees, const ClearanceField& field) {
  // The broker has checked the edge from its other end.
  constexpr double rounding = 1e-6;  // metres
  return std::ranges::all_of(trees.nodes, [&](const InactiveTreesMessage::Node& node) {
    const auto& from = node.parent < 0 ? node : trees.nodes[static_cast<std::size_t>(node.parent)];
    return field.segment_free(from.position, node.position, trees.radius - rounding);
  });
}

const RobotName* sender_of(const Message& message) {
  static const RobotName no_robot;
  return std::visit(
      []<class M>(const M& m) -> const RobotName* {
        if constexpr (std::same_as<M, JointPlanMessage>)
          return m.round.leader == service_as_leader ? &no_robot : &m.round.leader;
        if constexpr (std::same_as<M, RobotState>) return m.passed_on ? nullptr : &m.robot;
        if constexpr (Topic<M>::written_by(Role::agent) && requires { m.robot; }) return &m.robot;
        return nullptr;
      },
      message);
}

}  // namespace coppice
