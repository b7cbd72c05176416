#include "bus/validation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace coppice {

namespace {

using Problem = std::optional<std::string>;

bool sane(double x) {
  return std::abs(x) <= largest_quantity;
}  // false for NaN
bool sane(const Point2& p) {
  return sane(p.x()) && sane(p.y());
}
bool positive(double x) {
  return x > 0 && x <= largest_quantity;
}
bool not_negative(double x) {
  return x >= 0 && x <= largest_quantity;
}
bool named(const std::string& name) {
  return !name.empty() && name.size() <= longest_name;
}
bool known(Phase phase) {
  return phase <= Phase::stopped;
}

Problem first_of(std::initializer_list<std::pair<bool, const char*>> checks) {
  for (const auto& [holds, text] : checks) {
    if (!holds) return text;
  }
  return std::nullopt;
}

Problem check(const MapMessage& m) {
  const auto in_range = [](int cells) { return cells >= 1 && cells <= largest_map_side; };
  return first_of({{named(m.map_id), "map id is empty or too long"},
                   {in_range(m.map.width) && in_range(m.map.height), "map size is out of range"},
                   {positive(m.map.resolution), "resolution is not positive"},
                   {sane(m.map.origin), "origin is not finite"},
                   {m.map.y_axis <= YAxis::up, "unknown y axis"},
                   {m.map.blocked.size() == static_cast<std::size_t>(std::max(m.map.width, 0)) *
                                                static_cast<std::size_t>(std::max(m.map.height, 0)),
                    "number of cells does not agree with the size"},
                   {std::ranges::all_of(m.radii, positive), "a radius is not positive"}});
}

Problem check(const Mission& m) {
  return first_of({{named(m.robot), "robot name is empty or too long"},
                   {named(m.map_id), "map id is empty or too long"},
                   {m.fleet_size >= 1, "fleet size is 0"},
                   {sane(m.start) && sane(m.goal), "start or goal is not finite"},
                   {positive(m.radius), "radius is not positive"},
                   {positive(m.max_speed), "speed limit is not positive"},
                   {positive(m.max_acceleration), "acceleration limit is not positive"},
                   {positive(m.goal_tolerance), "goal tolerance is not positive"},
                   {m.planner <= PlannerKind::rrt_star, "unknown planner"},
                   {not_negative(m.plan_budget), "plan budget is negative or not finite"},
                   {std::isfinite(m.clock.epoch) && m.clock.epoch >= 0, "clock epoch is not a time"},
                   {positive(m.clock.scale), "clock scale is not positive"}});
}

Problem check(const RootNodes& m) {
  if (!named(m.robot)) return "robot name is empty or too long";
  for (std::size_t i = 0; i < m.nodes.size(); ++i) {
    const RootNodes::Node& node = m.nodes[i];
    if (!sane(node.position)) return "node position is not finite";
    if (node.side > Side::goal) return "node belongs to no root tree";
    const std::int64_t own = static_cast<std::int64_t>(m.first_index) + static_cast<std::int64_t>(i);
    if (node.parent < -1 || node.parent >= own) return "node's parent does not come before it";
  }
  return std::nullopt;
}

Problem check(const InactiveTreeMessage& m) {
  if (!named(m.map_id)) return "map id is empty or too long";
  if (!positive(m.radius)) return "radius is not positive";
  if (m.nodes.empty()) return "tree has no node";
  for (std::size_t i = 0; i < m.nodes.size(); ++i) {
    const InactiveTreeMessage::Node& node = m.nodes[i];
    if (!sane(node.position)) return "node position is not finite";
    if (!not_negative(node.edge_clearance)) return "edge clearance is negative or not finite";
    const bool root = i == 0;
    if (root ? node.parent != -1 : node.parent < 0 || node.parent >= static_cast<std::int64_t>(i)) {
      return "node's parent does not come before it";
    }
  }
  return std::nullopt;
}

Problem check(const RobotState& m) {
  const auto echo_fine = [](const Echo& e) { return named(e.robot) && sane(e.stamp) && sane(e.received); };
  return first_of(
      {{named(m.robot), "robot name is empty or too long"},
       {sane(m.stamp) && sane(m.promise.turn) && sane(m.promise.expiry), "time is not finite"},
       {m.stamp <= m.promise.turn && m.promise.turn <= m.promise.expiry, "promise ends before it begins"},
       {sane(m.position), "position is not finite"},
       {positive(m.radius), "radius is not positive"},
       {positive(m.max_speed), "speed limit is not positive"},
       {positive(m.max_acceleration), "acceleration limit is not positive"},
       {sane(m.velocity) && m.velocity.norm() <= m.max_speed * 1.001, "velocity is above the limit"},
       {sane(m.promise.velocity) && m.promise.velocity.norm() <= m.max_speed * 1.001,
        "promised velocity is above the limit"},
       {known(m.phase), "unknown phase"},
       {m.stage <= Stage::ordered, "unknown stage"},
       {m.knot.leader.size() <= longest_name && (m.knot.epoch == 0) == m.knot.leader.empty(),
        "knot's epoch and leader do not agree"},
       {sane(m.knot.place) && not_negative(m.knot.reach), "knot has no place or reach"},
       {not_negative(m.progress), "progress is negative or not finite"},
       {m.waits_for.size() <= longest_name, "name of the robot waited for is too long"},
       {m.copy < m.copies, "it is a copy that there is not"},
       {m.echoes.size() <= most_echoes && std::ranges::all_of(m.echoes, echo_fine),
        "too many echoes, or one without a name or a finite time"}});
}

Problem check(const JointPlanMessage& m) {
  const auto member_fine = [](const JointPlanMessage::Member& member) {
    return named(member.robot) && positive(member.radius);
  };
  const auto move_fine = [&](const JointPlanMessage::Move& move) {
    return move.member < m.members.size() && !move.path.empty() &&
           std::ranges::all_of(move.path, [](const Point2& p) { return sane(p); });
  };
  return first_of({{m.knot.epoch > 0 && named(m.knot.leader), "knot has no epoch or no leader"},
                   {sane(m.knot.place) && not_negative(m.knot.reach), "knot has no place or reach"},
                   {std::ranges::all_of(m.members, member_fine), "member has no name or no radius"},
                   {std::ranges::all_of(m.moves, move_fine), "move has no known member or no finite path"}});
}

Problem check(const PathMessage& m) {
  return first_of({{named(m.robot), "robot name is empty or too long"},
                   {std::ranges::all_of(m.waypoints, [](const Point2& p) { return sane(p); }),
                    "waypoint is not finite"}});
}

Problem check(const TrackMessage& m) {
  const auto fine = [](const TrackMessage::Point& p) {
    return sane(p.time) && sane(p.position) && sane(p.velocity);
  };
  return first_of(
      {{named(m.robot), "robot name is empty or too long"},
       {std::ranges::all_of(m.points, fine), "point is not finite"},
       {std::ranges::is_sorted(m.points, std::less{}, &TrackMessage::Point::time), "time runs back"}});
}

Problem check(const AgentStatus& m) {
  return first_of({{named(m.robot), "robot name is empty or too long"},
                   {known(m.phase), "unknown phase"},
                   {sane(m.mission_time) && sane(m.path_time) && sane(m.arrival_time) &&
                        sane(m.plan_seconds) && sane(m.improve_seconds),
                    "time is not finite"},
                   {not_negative(m.driven_length), "length is negative or not finite"}});
}

Problem check(const BrokerStatus& m) {
  return first_of({{m.covered_map.size() <= longest_name, "map id is too long"}});
}

Problem check(const Claim& m) {
  return first_of(
      {{m.claimant != 0, "claimant is 0"}, {m.robot.size() <= longest_name, "robot name is too long"}});
}

Problem check(const Assignment& m) {
  return first_of({{named(m.robot), "robot name is empty or too long"}, {m.claimant != 0, "claimant is 0"}});
}

}  // namespace

std::optional<std::string> problem_with(const Message& message) {
  return std::visit([](const auto& m) { return check(m); }, message);
}

}  // namespace coppice
