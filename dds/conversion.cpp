#include "dds/conversion.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "planning/packed_cells.h"

namespace coppice {

namespace {

idl::Position to_dds(const Point2& p) {
  idl::Position q;
  q.x(p.x());
  q.y(p.y());
  return q;
}

Point2 from_dds(const idl::Position& p) {
  return {p.x(), p.y()};
}

template <class E>
std::uint8_t octet(E value) {
  return static_cast<std::uint8_t>(value);
}

std::string text(const auto& fixed) {
  return fixed.to_string();
}

/// Returns the cells that the bits hold, at most as many as the size requires. Validation refuses a map with
/// too few.
std::vector<std::uint8_t> unpacked(const std::vector<std::uint8_t>& bits, std::int32_t width,
                                   std::int32_t height) {
  const auto said =
      static_cast<std::size_t>(std::max(width, 0)) * static_cast<std::size_t>(std::max(height, 0));
  return unpacked_cells(bits, said);
}

}  // namespace

idl::OccupancyMap to_dds(const MapMessage& m) {
  idl::OccupancyMap d;
  d.map_id(m.map_id);
  d.width(m.map.width);
  d.height(m.map.height);
  d.resolution(m.map.resolution);
  d.origin(to_dds(m.map.origin));
  d.y_axis(octet(m.map.y_axis));
  d.packed_occupancy(packed_cells<std::vector<std::uint8_t>>(m.map.blocked));
  d.radii(m.radii);
  return d;
}

MapMessage from_dds(const idl::OccupancyMap& d) {
  return {text(d.map_id()),
          {d.width(), d.height(), d.resolution(), from_dds(d.origin()), static_cast<YAxis>(d.y_axis()),
           unpacked(d.packed_occupancy(), d.width(), d.height())},
          d.radii()};
}

idl::Mission to_dds(const Mission& m) {
  idl::Mission d;
  d.robot(m.robot);
  d.number(m.number);
  d.fleet_size(m.fleet_size);
  d.map_id(m.map_id);
  d.start(to_dds(m.start));
  d.goal(to_dds(m.goal));
  d.radius(m.radius);
  d.max_speed(m.max_speed);
  d.max_acceleration(m.max_acceleration);
  d.goal_tolerance(m.goal_tolerance);
  d.seed(m.seed);
  d.planner(octet(m.planner));
  d.plan_budget(m.plan_budget);
  d.cancelled(m.cancelled);
  d.clock_epoch(m.clock.epoch);
  d.clock_scale(m.clock.scale);
  return d;
}

Mission from_dds(const idl::Mission& d) {
  return {.robot = text(d.robot()),
          .number = d.number(),
          .fleet_size = d.fleet_size(),
          .map_id = text(d.map_id()),
          .start = from_dds(d.start()),
          .goal = from_dds(d.goal()),
          .radius = d.radius(),
          .max_speed = d.max_speed(),
          .max_acceleration = d.max_acceleration(),
          .goal_tolerance = d.goal_tolerance(),
          .seed = d.seed(),
          .planner = static_cast<PlannerKind>(d.planner()),
          .plan_budget = d.plan_budget(),
          .cancelled = d.cancelled(),
          .clock = {d.clock_epoch(), d.clock_scale()}};
}

idl::RootNodes to_dds(const RootNodes& m) {
  idl::RootNodes d;
  d.robot(m.robot);
  d.mission(m.mission);
  d.run(m.run.epoch);
  d.first_index(m.first_index);
  for (const RootNodes::Node& node : m.nodes) {
    idl::RootNode& n = d.nodes().emplace_back();
    n.side(octet(node.side));
    n.position(to_dds(node.position));
    n.parent(node.parent);
  }
  return d;
}

RootNodes from_dds(const idl::RootNodes& d) {
  RootNodes m{.robot = text(d.robot()),
              .mission = d.mission(),
              .first_index = d.first_index(),
              .nodes = {},
              .run = {d.run()}};
  for (const idl::RootNode& n : d.nodes()) {
    m.nodes.push_back({static_cast<Root>(n.side()), from_dds(n.position()), n.parent()});
  }
  return m;
}

idl::InactiveTree to_dds(const InactiveTreeMessage& m) {
  idl::InactiveTree d;
  d.broker(m.tree.broker);
  d.number(m.tree.number);
  d.map_id(m.map_id);
  d.radius(m.radius);
  for (const InactiveTreeMessage::Node& node : m.nodes) {
    idl::TreeNode& n = d.nodes().emplace_back();
    n.position(to_dds(node.position));
    n.parent(node.parent);
    n.edge_clearance(node.edge_clearance);
  }
  return d;
}

InactiveTreeMessage from_dds(const idl::InactiveTree& d) {
  InactiveTreeMessage m{
      .tree = {d.broker(), d.number()}, .map_id = text(d.map_id()), .radius = d.radius(), .nodes = {}};
  for (const idl::TreeNode& n : d.nodes()) {
    m.nodes.push_back({from_dds(n.position()), n.parent(), n.edge_clearance()});
  }
  return m;
}

idl::ActiveTrees to_dds(const ActiveTreesMessage& m) {
  idl::ActiveTrees d;
  d.broker(m.broker);
  d.map_id(m.map_id);
  for (const ActiveTreesMessage::Edge& edge : m.edges) {
    idl::TreeEdge& e = d.edges().emplace_back();
    e.from(to_dds(edge.from));
    e.to(to_dds(edge.to));
  }
  return d;
}

ActiveTreesMessage from_dds(const idl::ActiveTrees& d) {
  ActiveTreesMessage m{.broker = d.broker(), .map_id = text(d.map_id()), .edges = {}};
  for (const idl::TreeEdge& e : d.edges()) m.edges.push_back({from_dds(e.from()), from_dds(e.to())});
  return m;
}

idl::RobotState to_dds(const RobotState& m) {
  idl::RobotState d;
  d.robot(m.robot);
  d.sequence_number(m.sequence);
  d.stamp(m.promise.stamp);
  d.run(m.run.epoch);
  d.position(to_dds(m.promise.position));
  d.velocity(to_dds(m.promise.velocity));
  d.radius(m.radius);
  d.max_speed(m.max_speed);
  d.max_acceleration(m.max_acceleration);
  d.phase(octet(m.phase));
  d.promise_turn(m.promise.turn);
  d.promise_velocity(to_dds(m.promise.next_velocity));
  d.promise_expiry(m.promise.expiry);
  d.round_epoch(m.round.epoch);
  d.round_leader(m.round.leader);
  d.round_centre(to_dds(m.round.centre));
  d.round_reach(m.round.reach);
  d.stage(octet(m.stage));
  d.progress(m.progress);
  d.waits_for(m.waits_for);
  d.copies(m.copies);
  d.copy(m.copy);
  d.passed_on(m.passed_on);
  d.counts_as_failed(m.counts_as_failed);
  d.is_new(m.is_new);
  d.wants_echo(m.wants_echo);
  for (const RobotName& robot : m.misses) d.misses().emplace_back().robot(robot);
  for (const Echo& echo : m.echoes) {
    idl::Echo& to = d.echoes().emplace_back();
    to.robot(echo.robot);
    to.stamp(echo.stamp);
    to.received(echo.received);
  }
  return d;
}

RobotState from_dds(const idl::RobotState& d) {
  std::vector<RobotName> misses;
  for (const idl::Missed& missed : d.misses()) misses.push_back(text(missed.robot()));
  std::vector<Echo> echoes;
  for (const idl::Echo& echo : d.echoes())
    echoes.push_back({text(echo.robot()), echo.stamp(), echo.received()});
  return {.robot = text(d.robot()),
          .sequence = d.sequence_number(),
          .promise = {.stamp = d.stamp(),
                      .position = from_dds(d.position()),
                      .velocity = from_dds(d.velocity()),
                      .turn = d.promise_turn(),
                      .next_velocity = from_dds(d.promise_velocity()),
                      .expiry = d.promise_expiry()},
          .radius = d.radius(),
          .max_speed = d.max_speed(),
          .max_acceleration = d.max_acceleration(),
          .phase = static_cast<Phase>(d.phase()),
          .round = {d.round_epoch(), text(d.round_leader()), from_dds(d.round_centre()), d.round_reach()},
          .stage = static_cast<Stage>(d.stage()),
          .progress = d.progress(),
          .waits_for = text(d.waits_for()),
          .copies = d.copies(),
          .copy = d.copy(),
          .passed_on = d.passed_on(),
          .counts_as_failed = d.counts_as_failed(),
          .is_new = d.is_new(),
          .wants_echo = d.wants_echo(),
          .misses = std::move(misses),
          .echoes = std::move(echoes),
          .run = {d.run()}};
}

idl::JointPlan to_dds(const JointPlanMessage& m) {
  idl::JointPlan d;
  d.leader(m.round.leader);
  d.epoch(m.round.epoch);
  d.centre(to_dds(m.round.centre));
  d.reach(m.round.reach);
  d.run(m.run.epoch);
  for (const JointPlanMessage::Member& member : m.members) {
    idl::JointPlanMember& to = d.members().emplace_back();
    to.robot(member.robot);
    to.radius(member.radius);
    to.stranded(member.stranded);
  }
  for (const Move& move : m.moves) {
    idl::JointPlanMove& to = d.moves().emplace_back();
    to.member(static_cast<std::uint32_t>(move.robot));
    to.points(static_cast<std::uint32_t>(move.path.size()));
    for (const Point2& p : move.path) d.points().push_back(to_dds(p));
  }
  return d;
}

JointPlanMessage from_dds(const idl::JointPlan& d) {
  JointPlanMessage m{.round = {d.epoch(), text(d.leader()), from_dds(d.centre()), d.reach()},
                     .members = {},
                     .moves = {},
                     .run = {d.run()}};
  for (const idl::JointPlanMember& member : d.members())
    m.members.push_back({text(member.robot()), member.radius(), member.stranded()});
  // A move that claims more points than there are left gets fewer. Validation refuses a move without points.
  auto next = d.points().begin();
  for (const idl::JointPlanMove& move : d.moves()) {
    Move& to = m.moves.emplace_back();
    to.robot = move.member();
    for (std::uint32_t k = 0; k < move.points() && next != d.points().end(); ++k)
      to.path.push_back(from_dds(*next++));
  }
  return m;
}

idl::Path to_dds(const PathMessage& m) {
  idl::Path d;
  d.robot(m.robot);
  d.mission(m.mission);
  d.run(m.run.epoch);
  for (const Point2& p : m.waypoints) d.waypoints().push_back(to_dds(p));
  return d;
}

PathMessage from_dds(const idl::Path& d) {
  PathMessage m{.robot = text(d.robot()), .mission = d.mission(), .waypoints = {}, .run = {d.run()}};
  for (const idl::Position& p : d.waypoints()) m.waypoints.push_back(from_dds(p));
  return m;
}

idl::Track to_dds(const TrackMessage& m) {
  idl::Track d;
  d.robot(m.robot);
  d.mission(m.mission);
  d.run(m.run.epoch);
  d.first_index(m.first_index);
  for (const TrackMessage::Point& point : m.points) {
    idl::TrackPoint& p = d.points().emplace_back();
    p.time(point.time);
    p.position(to_dds(point.position));
    p.velocity(to_dds(point.velocity));
  }
  return d;
}

TrackMessage from_dds(const idl::Track& d) {
  TrackMessage m{.robot = text(d.robot()),
                 .mission = d.mission(),
                 .first_index = d.first_index(),
                 .points = {},
                 .run = {d.run()}};
  for (const idl::TrackPoint& p : d.points()) {
    m.points.push_back({p.time(), from_dds(p.position()), from_dds(p.velocity())});
  }
  return m;
}

idl::AgentStatus to_dds(const AgentStatus& m) {
  idl::AgentStatus d;
  d.robot(m.robot);
  d.mission(m.mission);
  d.run(m.run.epoch);
  d.phase(octet(m.phase));
  d.reason(m.reason);
  d.mission_time(m.mission_time);
  d.path_time(m.path_time);
  d.arrival_time(m.arrival_time);
  d.plan_seconds(m.plan_seconds);
  d.improve_seconds(m.improve_seconds);
  d.driven_length(m.driven_length);
  d.way_left(m.way_left);
  d.wait_cause(m.wait_cause);
  d.came_on_at(m.came_on_at);
  d.waited(m.waited);
  d.nodes_valid(m.nodes_valid);
  d.nodes_invalid(m.nodes_invalid);
  d.trees_received(m.trees_received);
  d.trees_grafted(m.trees_grafted);
  d.track_points(m.track_points);
  d.rejected(m.rejected);
  d.samples_received(m.load.samples_received);
  d.states_received(m.load.states_received);
  d.periods(m.load.periods);
  d.periods_missed(m.load.periods_missed);
  d.agents_matched(m.load.agents_matched);
  d.matched_at(m.load.matched_at);
  d.bytes_sent(m.load.bytes_sent);
  d.bytes_received(m.load.bytes_received);
  d.state_age_p50(m.load.state_age_p50);
  d.state_age_p99(m.load.state_age_p99);
  d.state_age_max(m.load.state_age_max);
  d.processor_seconds(m.load.processor_seconds);
  return d;
}

AgentStatus from_dds(const idl::AgentStatus& d) {
  return {.robot = text(d.robot()),
          .mission = d.mission(),
          .phase = static_cast<Phase>(d.phase()),
          .reason = text(d.reason()),
          .mission_time = d.mission_time(),
          .path_time = d.path_time(),
          .arrival_time = d.arrival_time(),
          .plan_seconds = d.plan_seconds(),
          .improve_seconds = d.improve_seconds(),
          .driven_length = d.driven_length(),
          .nodes_valid = d.nodes_valid(),
          .nodes_invalid = d.nodes_invalid(),
          .trees_received = d.trees_received(),
          .trees_grafted = d.trees_grafted(),
          .track_points = d.track_points(),
          .rejected = d.rejected(),
          .load = {.samples_received = d.samples_received(),
                   .states_received = d.states_received(),
                   .periods = d.periods(),
                   .periods_missed = d.periods_missed(),
                   .agents_matched = d.agents_matched(),
                   .matched_at = d.matched_at(),
                   .bytes_sent = d.bytes_sent(),
                   .bytes_received = d.bytes_received(),
                   .state_age_p50 = d.state_age_p50(),
                   .state_age_p99 = d.state_age_p99(),
                   .state_age_max = d.state_age_max(),
                   .processor_seconds = d.processor_seconds()},
          .run = {d.run()},
          .way_left = d.way_left(),
          .wait_cause = text(d.wait_cause()),
          .came_on_at = d.came_on_at(),
          .waited = d.waited()};
}

idl::BrokerStatus to_dds(const BrokerStatus& m) {
  idl::BrokerStatus d;
  d.broker(m.broker);
  d.leads(m.leads);
  d.leading_since(m.leading_since);
  d.nodes_valid(m.nodes_valid);
  d.nodes_invalid(m.nodes_invalid);
  d.trees_active(m.trees_active);
  d.trees_published(m.trees_published);
  d.covered_map(m.covered_map);
  d.rejected(m.rejected);
  d.processor_seconds(m.processor_seconds);
  return d;
}

BrokerStatus from_dds(const idl::BrokerStatus& d) {
  return {.broker = d.broker(),
          .leads = d.leads(),
          .leading_since = d.leading_since(),
          .nodes_valid = d.nodes_valid(),
          .nodes_invalid = d.nodes_invalid(),
          .trees_active = d.trees_active(),
          .trees_published = d.trees_published(),
          .covered_map = text(d.covered_map()),
          .rejected = d.rejected(),
          .processor_seconds = d.processor_seconds()};
}

idl::ServiceStatus to_dds(const ServiceStatus& m) {
  idl::ServiceStatus d;
  d.service(m.service);
  d.host(m.host);
  d.process(m.process);
  d.since(m.since);
  d.run(m.run.epoch);
  return d;
}

ServiceStatus from_dds(const idl::ServiceStatus& d) {
  return {.service = d.service(),
          .host = text(d.host()),
          .process = d.process(),
          .since = d.since(),
          .run = {d.run()}};
}

idl::Claim to_dds(const Claim& m) {
  idl::Claim d;
  d.claimant(m.claimant);
  d.number(m.number);
  d.robot(m.robot);
  return d;
}

Claim from_dds(const idl::Claim& d) {
  return {.claimant = d.claimant(), .number = d.number(), .robot = text(d.robot())};
}

idl::Assignment to_dds(const Assignment& m) {
  idl::Assignment d;
  d.robot(m.robot);
  d.claimant(m.claimant);
  d.number(m.number);
  return d;
}

Assignment from_dds(const idl::Assignment& d) {
  return {.robot = text(d.robot()), .claimant = d.claimant(), .number = d.number()};
}

}  // namespace coppice
