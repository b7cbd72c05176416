#include "monitor/recorded_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include <google/protobuf/descriptor.pb.h>

#include "messages/validation.h"
#include "planning/packed_cells.h"
#include "recording.pb.h"

namespace coppice {

namespace {

/// Our enumerations have the same numbers. A number that does not fit an octet becomes 255, which is no
/// enumerator.
template <class E>
E octet(std::uint32_t number) {
  return static_cast<E>(static_cast<std::uint8_t>(std::min<std::uint32_t>(number, 255)));
}
template <class E>
int number(E value) {
  return static_cast<int>(value);
}

void to(const Point2& p, recording::Point* out) {
  out->set_x(p.x());
  out->set_y(p.y());
}
Point2 from(const recording::Point& p) {
  return {p.x(), p.y()};
}
template <class Points>
Path path_in(const Points& points) {
  Path path;
  path.reserve(static_cast<std::size_t>(points.size()));
  for (const auto& p : points) path.push_back(from(p));
  return path;
}

// --- map ---

void to(const MapMessage& m, recording::Map* out) {
  out->set_map_id(m.map_id);
  out->set_width(static_cast<std::uint32_t>(m.map.width));
  out->set_height(static_cast<std::uint32_t>(m.map.height));
  out->set_resolution(m.map.resolution);
  to(m.map.origin, out->mutable_origin());
  out->set_y_up(m.map.y_axis == YAxis::up);
  out->set_occupancy(packed_cells<std::string>(m.map.blocked));
  out->mutable_radii()->Add(m.radii.begin(), m.radii.end());
}
std::optional<Message> from(const recording::Map& m) {
  if (m.width() > largest_map_side || m.height() > largest_map_side) return std::nullopt;
  const std::size_t cells = std::size_t{m.width()} * m.height();
  if (m.occupancy().size() != (cells + 7) / 8) return std::nullopt;
  return MapMessage{.map_id = m.map_id(),
                    .map = {.width = static_cast<int>(m.width()),
                            .height = static_cast<int>(m.height()),
                            .resolution = m.resolution(),
                            .origin = from(m.origin()),
                            .y_axis = m.y_up() ? YAxis::up : YAxis::down,
                            .blocked = unpacked_cells(m.occupancy(), cells)},
                    .radii = {m.radii().begin(), m.radii().end()}};
}

// --- mission, trees ---

void to(const Mission& m, recording::Mission* out) {
  out->set_robot(m.robot);
  out->set_number(m.number);
  out->set_fleet_size(m.fleet_size);
  out->set_map_id(m.map_id);
  to(m.start, out->mutable_start());
  to(m.goal, out->mutable_goal());
  out->set_radius(m.radius);
  out->set_max_speed(m.max_speed);
  out->set_max_acceleration(m.max_acceleration);
  out->set_goal_tolerance(m.goal_tolerance);
  out->set_seed(m.seed);
  out->set_planner(static_cast<recording::Planner>(number(m.planner)));
  out->set_plan_budget(m.plan_budget);
  out->set_cancelled(m.cancelled);
  out->set_clock_epoch(m.clock.epoch);
  out->set_clock_scale(m.clock.scale);
}
std::optional<Message> from(const recording::Mission& m) {
  return Mission{.robot = m.robot(),
                 .number = m.number(),
                 .fleet_size = m.fleet_size(),
                 .map_id = m.map_id(),
                 .start = from(m.start()),
                 .goal = from(m.goal()),
                 .radius = m.radius(),
                 .max_speed = m.max_speed(),
                 .max_acceleration = m.max_acceleration(),
                 .goal_tolerance = m.goal_tolerance(),
                 .seed = m.seed(),
                 .planner = octet<PlannerKind>(static_cast<std::uint32_t>(m.planner())),
                 .plan_budget = m.plan_budget(),
                 .cancelled = m.cancelled(),
                 .clock = {m.clock_epoch(), m.clock_scale()}};
}

void to(const RootNodes& m, recording::RootNodes* out) {
  out->set_robot(m.robot);
  out->set_mission(m.mission);
  out->set_run(m.run.epoch);
  out->set_first_index(m.first_index);
  for (const RootNodes::Node& node : m.nodes) {
    auto* const added = out->add_nodes();
    added->set_side(static_cast<recording::Side>(number(node.side)));
    to(node.position, added->mutable_position());
    added->set_parent(node.parent);
  }
}
std::optional<Message> from(const recording::RootNodes& m) {
  RootNodes all{.robot = m.robot(),
                .mission = m.mission(),
                .first_index = m.first_index(),
                .nodes = {},
                .run = {m.run()}};
  for (const auto& node : m.nodes())
    all.nodes.push_back(
        {octet<Root>(static_cast<std::uint32_t>(node.side())), from(node.position()), node.parent()});
  return all;
}

void to(const InactiveTreeMessage& m, recording::InactiveTree* out) {
  out->set_broker(m.tree.broker);
  out->set_number(m.tree.number);
  out->set_map_id(m.map_id);
  out->set_radius(m.radius);
  for (const InactiveTreeMessage::Node& node : m.nodes) {
    auto* const added = out->add_nodes();
    to(node.position, added->mutable_position());
    added->set_parent(node.parent);
    added->set_edge_clearance(node.edge_clearance);
  }
}
std::optional<Message> from(const recording::InactiveTree& m) {
  InactiveTreeMessage tree{
      .tree = {m.broker(), m.number()}, .map_id = m.map_id(), .radius = m.radius(), .nodes = {}};
  for (const auto& node : m.nodes())
    tree.nodes.push_back({from(node.position()), node.parent(), node.edge_clearance()});
  return tree;
}

void to(const ActiveTreesMessage& m, recording::ActiveTrees* out) {
  out->set_broker(m.broker);
  out->set_map_id(m.map_id);
  for (const ActiveTreesMessage::Edge& edge : m.edges) {
    auto* const added = out->add_edges();
    to(edge.from, added->mutable_from());
    to(edge.to, added->mutable_to());
  }
}
std::optional<Message> from(const recording::ActiveTrees& m) {
  ActiveTreesMessage trees{.broker = m.broker(), .map_id = m.map_id(), .edges = {}};
  for (const auto& edge : m.edges()) trees.edges.push_back({from(edge.from()), from(edge.to())});
  return trees;
}

// --- states and joint plans ---

void to(const RoundId& round, recording::CoordinationRound* out) {
  out->set_epoch(round.epoch);
  out->set_leader(round.leader);
  to(round.centre, out->mutable_centre());
  out->set_reach(round.reach);
}
RoundId from(const recording::CoordinationRound& round) {
  return {round.epoch(), round.leader(), from(round.centre()), round.reach()};
}

void to(const RobotState& m, recording::RobotState* out) {
  out->set_robot(m.robot);
  out->set_sequence(m.sequence);
  out->set_stamp(m.promise.stamp);
  out->set_run(m.run.epoch);
  to(m.promise.position, out->mutable_position());
  to(m.promise.velocity, out->mutable_velocity());
  out->set_radius(m.radius);
  out->set_max_speed(m.max_speed);
  out->set_max_acceleration(m.max_acceleration);
  out->set_phase(static_cast<recording::Phase>(number(m.phase)));
  out->set_promise_turn(m.promise.turn);
  to(m.promise.next_velocity, out->mutable_promise_velocity());
  out->set_promise_expiry(m.promise.expiry);
  to(m.round, out->mutable_round());
  out->set_stage(static_cast<recording::Stage>(number(m.stage)));
  out->set_progress(m.progress);
  out->set_waits_for(m.waits_for);
  out->set_copies(m.copies);
  out->set_copy(m.copy);
  out->set_passed_on(m.passed_on);
  out->set_counts_as_failed(m.counts_as_failed);
  out->set_is_new(m.is_new);
  out->set_wants_echo(m.wants_echo);
  for (const RobotName& robot : m.misses) out->add_misses(robot);
  for (const Echo& echo : m.echoes) {
    auto* const added = out->add_echoes();
    added->set_robot(echo.robot);
    added->set_stamp(echo.stamp);
    added->set_received(echo.received);
  }
}
std::optional<Message> from(const recording::RobotState& m) {
  RobotState state{.robot = m.robot(),
                   .sequence = m.sequence(),
                   .promise = {.stamp = m.stamp(),
                               .position = from(m.position()),
                               .velocity = from(m.velocity()),
                               .turn = m.promise_turn(),
                               .next_velocity = from(m.promise_velocity()),
                               .expiry = m.promise_expiry()},
                   .radius = m.radius(),
                   .max_speed = m.max_speed(),
                   .max_acceleration = m.max_acceleration(),
                   .phase = octet<Phase>(static_cast<std::uint32_t>(m.phase())),
                   .round = from(m.round()),
                   .stage = octet<Stage>(static_cast<std::uint32_t>(m.stage())),
                   .progress = m.progress(),
                   .waits_for = m.waits_for(),
                   .copies = octet<std::uint8_t>(m.copies()),
                   .copy = octet<std::uint8_t>(m.copy()),
                   .passed_on = m.passed_on(),
                   .counts_as_failed = m.counts_as_failed(),
                   .is_new = m.is_new(),
                   .wants_echo = m.wants_echo(),
                   .misses = {m.misses().begin(), m.misses().end()},
                   .run = {m.run()}};
  for (const auto& echo : m.echoes()) state.echoes.push_back({echo.robot(), echo.stamp(), echo.received()});
  return state;
}

void to(const JointPlanMessage& m, recording::JointPlan* out) {
  to(m.round, out->mutable_round());
  out->set_run(m.run.epoch);
  for (const JointPlanMessage::Member& member : m.members) {
    auto* const added = out->add_members();
    added->set_robot(member.robot);
    added->set_radius(member.radius);
    added->set_stranded(member.stranded);
  }
  for (const Move& move : m.moves) {
    auto* const added = out->add_moves();
    added->set_member(static_cast<std::uint32_t>(move.robot));
    for (const Point2& p : move.path) to(p, added->add_path());
  }
}
std::optional<Message> from(const recording::JointPlan& m) {
  JointPlanMessage plan{.round = from(m.round()), .members = {}, .moves = {}, .run = {m.run()}};
  for (const auto& member : m.members())
    plan.members.push_back({member.robot(), member.radius(), member.stranded()});
  for (const auto& move : m.moves()) plan.moves.push_back({move.member(), path_in(move.path())});
  return plan;
}

void to(const PathMessage& m, recording::Path* out) {
  out->set_robot(m.robot);
  out->set_mission(m.mission);
  out->set_run(m.run.epoch);
  for (const Point2& p : m.waypoints) to(p, out->add_waypoints());
}
std::optional<Message> from(const recording::Path& m) {
  return PathMessage{m.robot(), m.mission(), path_in(m.waypoints()), {m.run()}};
}

void to(const TrackMessage& m, recording::Track* out) {
  out->set_robot(m.robot);
  out->set_mission(m.mission);
  out->set_run(m.run.epoch);
  out->set_first_index(m.first_index);
  for (const TrackMessage::Point& point : m.points) {
    auto* const added = out->add_points();
    added->set_time(point.time);
    to(point.position, added->mutable_position());
    to(point.velocity, added->mutable_velocity());
  }
}
std::optional<Message> from(const recording::Track& m) {
  TrackMessage track{.robot = m.robot(),
                     .mission = m.mission(),
                     .first_index = m.first_index(),
                     .points = {},
                     .run = {m.run()}};
  for (const auto& point : m.points())
    track.points.push_back({point.time(), from(point.position()), from(point.velocity())});
  return track;
}

// --- statuses and claims ---

void to(const AgentLoad& load, recording::AgentStatus::Load* out) {
  out->set_samples_received(load.samples_received);
  out->set_states_received(load.states_received);
  out->set_periods(load.periods);
  out->set_periods_missed(load.periods_missed);
  out->set_agents_matched(load.agents_matched);
  out->set_matched_at(load.matched_at);
  out->set_bytes_sent(load.bytes_sent);
  out->set_bytes_received(load.bytes_received);
  out->set_state_age_p50(load.state_age_p50);
  out->set_state_age_p99(load.state_age_p99);
  out->set_state_age_max(load.state_age_max);
  out->set_processor_seconds(load.processor_seconds);
}
AgentLoad from(const recording::AgentStatus::Load& load) {
  return {.samples_received = load.samples_received(),
          .states_received = load.states_received(),
          .periods = load.periods(),
          .periods_missed = load.periods_missed(),
          .agents_matched = load.agents_matched(),
          .matched_at = load.matched_at(),
          .bytes_sent = load.bytes_sent(),
          .bytes_received = load.bytes_received(),
          .state_age_p50 = load.state_age_p50(),
          .state_age_p99 = load.state_age_p99(),
          .state_age_max = load.state_age_max(),
          .processor_seconds = load.processor_seconds()};
}

void to(const AgentStatus& m, recording::AgentStatus* out) {
  out->set_robot(m.robot);
  out->set_mission(m.mission);
  out->set_run(m.run.epoch);
  out->set_phase(static_cast<recording::Phase>(number(m.phase)));
  out->set_reason(m.reason);
  out->set_mission_time(m.mission_time);
  out->set_path_time(m.path_time);
  out->set_arrival_time(m.arrival_time);
  out->set_plan_seconds(m.plan_seconds);
  out->set_improve_seconds(m.improve_seconds);
  out->set_driven_length(m.driven_length);
  out->set_nodes_valid(m.nodes_valid);
  out->set_nodes_invalid(m.nodes_invalid);
  out->set_trees_received(m.trees_received);
  out->set_trees_grafted(m.trees_grafted);
  out->set_track_points(m.track_points);
  out->set_rejected(m.rejected);
  to(m.load, out->mutable_load());
  out->set_way_left(m.way_left);
  out->set_wait_cause(m.wait_cause);
  out->set_came_on_at(m.came_on_at);
  out->set_waited(m.waited);
}
std::optional<Message> from(const recording::AgentStatus& m) {
  return AgentStatus{.robot = m.robot(),
                     .mission = m.mission(),
                     .phase = octet<Phase>(static_cast<std::uint32_t>(m.phase())),
                     .reason = m.reason(),
                     .mission_time = m.mission_time(),
                     .path_time = m.path_time(),
                     .arrival_time = m.arrival_time(),
                     .plan_seconds = m.plan_seconds(),
                     .improve_seconds = m.improve_seconds(),
                     .driven_length = m.driven_length(),
                     .nodes_valid = m.nodes_valid(),
                     .nodes_invalid = m.nodes_invalid(),
                     .trees_received = m.trees_received(),
                     .trees_grafted = m.trees_grafted(),
                     .track_points = m.track_points(),
                     .rejected = m.rejected(),
                     .load = from(m.load()),
                     .run = {m.run()},
                     .way_left = m.has_way_left() ? m.way_left() : AgentStatus{}.way_left,
                     .wait_cause = m.wait_cause(),
                     .came_on_at = m.came_on_at(),
                     .waited = m.waited()};
}

void to(const BrokerStatus& m, recording::BrokerStatus* out) {
  out->set_broker(m.broker);
  out->set_leads(m.leads);
  out->set_leading_since(m.leading_since);
  out->set_nodes_valid(m.nodes_valid);
  out->set_nodes_invalid(m.nodes_invalid);
  out->set_trees_active(m.trees_active);
  out->set_trees_published(m.trees_published);
  out->set_covered_map(m.covered_map);
  out->set_rejected(m.rejected);
  out->set_processor_seconds(m.processor_seconds);
}
std::optional<Message> from(const recording::BrokerStatus& m) {
  return BrokerStatus{.broker = m.broker(),
                      .leads = m.leads(),
                      .leading_since = m.leading_since(),
                      .nodes_valid = m.nodes_valid(),
                      .nodes_invalid = m.nodes_invalid(),
                      .trees_active = m.trees_active(),
                      .trees_published = m.trees_published(),
                      .covered_map = m.covered_map(),
                      .rejected = m.rejected(),
                      .processor_seconds = m.processor_seconds()};
}

void to(const Claim& m, recording::Claim* out) {
  out->set_claimant(m.claimant);
  out->set_number(m.number);
  out->set_robot(m.robot);
}
std::optional<Message> from(const recording::Claim& m) {
  return Claim{m.claimant(), m.number(), m.robot()};
}

void to(const Assignment& m, recording::Assignment* out) {
  out->set_robot(m.robot);
  out->set_claimant(m.claimant);
  out->set_number(m.number);
}
std::optional<Message> from(const recording::Assignment& m) {
  return Assignment{m.robot(), m.claimant(), m.number()};
}

void to(const ServiceStatus& m, recording::ServiceStatus* out) {
  out->set_service(m.service);
  out->set_host(m.host);
  out->set_process(m.process);
  out->set_since(m.since);
  out->set_run(m.run.epoch);
}
std::optional<Message> from(const recording::ServiceStatus& m) {
  return ServiceStatus{m.service(), m.host(), m.process(), m.since(), {m.run()}};
}

// --- by topic ---

template <class M>
struct Recorded;
#define COPPICE_RECORDED(MESSAGE, PROTO) \
  template <>                            \
  struct Recorded<MESSAGE> {             \
    using Type = recording::PROTO;       \
  }
COPPICE_RECORDED(MapMessage, Map);
COPPICE_RECORDED(Mission, Mission);
COPPICE_RECORDED(RootNodes, RootNodes);
COPPICE_RECORDED(InactiveTreeMessage, InactiveTree);
COPPICE_RECORDED(RobotState, RobotState);
COPPICE_RECORDED(JointPlanMessage, JointPlan);
COPPICE_RECORDED(PathMessage, Path);
COPPICE_RECORDED(TrackMessage, Track);
COPPICE_RECORDED(AgentStatus, AgentStatus);
COPPICE_RECORDED(BrokerStatus, BrokerStatus);
COPPICE_RECORDED(Claim, Claim);
COPPICE_RECORDED(Assignment, Assignment);
COPPICE_RECORDED(ActiveTreesMessage, ActiveTrees);
COPPICE_RECORDED(ServiceStatus, ServiceStatus);
#undef COPPICE_RECORDED

template <class M>
std::optional<Message> parsed(std::string_view bytes) {
  typename Recorded<M>::Type message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return std::nullopt;
  return from(message);
}

template <class... Ms>
const google::protobuf::Descriptor* descriptor_of(TopicNumber topic, const std::variant<Ms...>*) {
  const std::array all{Recorded<Ms>::Type::descriptor()...};
  return all.at(topic);
}
const google::protobuf::Descriptor* descriptor_of(TopicNumber topic) {
  return descriptor_of(topic, static_cast<const Message*>(nullptr));
}

/// Adds a file after all files that it depends on.
void add_file(const google::protobuf::FileDescriptor& file, std::set<std::string>& added,
              google::protobuf::FileDescriptorSet& all) {
  if (!added.insert(file.name()).second) return;
  for (int k = 0; k < file.dependency_count(); ++k) add_file(*file.dependency(k), added, all);
  file.CopyTo(all.add_file());
}

}  // namespace

std::string channel_name(TopicNumber topic) {
  return "/coppice/" + std::string(topic_infos.at(topic).name);
}

std::string schema_name(TopicNumber topic) {
  return descriptor_of(topic)->full_name();
}

std::string schema_of(TopicNumber topic) {
  google::protobuf::FileDescriptorSet all;
  std::set<std::string> added;
  add_file(*descriptor_of(topic)->file(), added, all);
  return all.SerializeAsString();
}

std::uint64_t nanoseconds(WallTime at) {
  constexpr double latest = 9e18;
  return static_cast<std::uint64_t>(std::llround(std::clamp(1e9 * at, 0.0, latest)));
}
WallTime wall_time(std::uint64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

std::string recorded(const Message& message) {
  return std::visit(
      []<class M>(const M& m) {
        typename Recorded<M>::Type out;
        to(m, &out);
        return out.SerializeAsString();
      },
      message);
}

std::optional<Message> message_in(TopicNumber topic, std::string_view bytes) {
  if (bytes.size() > largest_recorded(topic)) return std::nullopt;
  return []<class... Ms>(TopicNumber number, std::string_view data, const std::variant<Ms...>*) {
    constexpr std::array<std::optional<Message> (*)(std::string_view), topic_count> parsers{parsed<Ms>...};
    return parsers.at(number)(data);
  }(topic, bytes, static_cast<const Message*>(nullptr));
}

}  // namespace coppice
