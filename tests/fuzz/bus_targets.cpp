// Targets for what arrives from the network: samples of each topic, from their bytes to what the processes
// make of them; announcements of participants; and addresses of discovery servers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "dds/checked_type.h"
#include "dds/conversion.h"
#include "dds/serialized.h"
#include "dds/server_list.h"
#include "dds/transport.h"
#include "messages/topics.h"
#include "messages/validation.h"
#include "planner_service/run/planner_service.h"
#include "robot_agent/process/robot_agent.h"
#include "tests/fuzz/targets.h"
#include "tree_broker/tree_broker.h"

namespace coppice::fuzz {

namespace {

constexpr std::size_t most_messages = 16;  // in a sequence, so that findings stay understandable

// --- a small driving fleet ---

OccupancyMap room_with_a_door() {
  OccupancyMap map{.width = 24, .height = 16, .blocked = std::vector<std::uint8_t>(384, 0)};
  for (int j = 0; j < 16; ++j) map.blocked[static_cast<std::size_t>(j * 24 + 12)] = j < 6 || j > 9;
  return map;
}

Scenario two_robots() {
  Scenario scenario;
  scenario.map_name = "room";
  scenario.map = room_with_a_door();
  scenario.robots = {{"a", {4, 8}, {20, 8}, 1, 4, 8, 0.5}, {"b", {20, 4}, {4, 4}, 1, 4, 8, 0.5}};
  return scenario;
}

RobotState state_of_b(double stamp) {
  return {.robot = "b",
          .sequence = static_cast<std::uint32_t>(std::lround(20 * stamp)),
          .promise = {.stamp = stamp,
                      .position = {20, 4},
                      .decision_time = stamp + 0.05,
                      .next_velocity = Point2::Zero(),
                      .expiry = stamp + 0.1},
          .radius = 1,
          .max_speed = 4,
          .max_acceleration = 8,
          .phase = Phase::driving,
          .round = {},
          .echoes = {{"a", stamp - 0.05, stamp}}};
}

/// Agent a, a broker and a service. Robot b is only heard of.
class SmallFleet {
 public:
  SmallFleet() : service_(two_robots(), {.plan_budget = 0.01}, 0) {
    for (const Message& m : service_.step(0)) give(m, 0);
    for (const char* robot : {"a", "b"}) give(AgentStatus{.robot = robot, .reason = {}}, 0);
    for (const Message& m : service_.step(3.5)) give(m, 3.5);  // the missions: fleet time is 0
    for (int k = 0; k < 8; ++k) {
      give(state_of_b(now() - 3.5), now());
      step();
    }
  }

  void give(const Message& message, WallTime at) {
    const Arrival arrival = arrival_of(message, at);
    std::visit(
        [&]<class M>(const M&) {
          if constexpr (Topic<M>::read_by(Role::agent)) agent_.on(arrival);
          if constexpr (Topic<M>::read_by(Role::broker)) broker_.on(arrival);
          if constexpr (Topic<M>::read_by(Role::service)) service_.on(arrival);
        },
        message);
  }

  /// One control period for all. Other participants must accept what the agent sends.
  void step() {
    for (const Outgoing& said : agent_.step(now())) {
      if (problem_with(said.message)) std::abort();
    }
    if (steps_ % 4 == 0) {
      for (const Message& said : broker_.step(now())) {
        if (problem_with(said)) std::abort();
      }
      service_.step(now());
    }
    ++steps_;
  }
  WallTime now() const { return 3.5 + 0.05 * steps_; }
  void report() const {
    if (service_.report().robots_size() != 2) std::abort();
    (void)service_.picture();
  }

 private:
  PlannerService service_;
  TreeBroker broker_{1, 1};
  RobotAgent agent_{"a"};
  int steps_ = 0;
};

// --- samples ---

/// A message as it comes off the bus, if it passes validation.
template <class M>
std::optional<Message> decoded(Bytes data) {
  CheckedType<typename DdsType<M>::Support> type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(data.size()));
  std::ranges::copy(data, payload.data);
  payload.length = static_cast<std::uint32_t>(data.size());
  typename DdsType<M>::Type sample;
  if (!type.deserialize(&payload, &sample)) return std::nullopt;
  eprosima::fastrtps::rtps::InstanceHandle_t key;
  type.getKey(&sample, &key, false);
  M message = from_dds(sample);
  if (problem_with(message)) return std::nullopt;
  if (from_dds(to_dds(message)) != message) std::abort();  // no NaN passes validation
  return message;
}

template <class M>
Input encoded(const M& message) {
  auto sample = to_dds(message);
  typename DdsType<M>::Support type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  type.serialize(&sample, &payload);
  return {payload.data, payload.data + payload.length};
}

template <class M>
void topic(Bytes data) {
  const auto message = decoded<M>(data);
  if (!message) return;
  SmallFleet fleet;
  fleet.give(*message, fleet.now());
  for (int k = 0; k < 24; ++k) fleet.step();
  fleet.report();
}

std::string map_id() {
  PlannerService service(two_robots(), {}, 0);
  return std::get<MapMessage>(service.step(0).at(0)).map_id;
}

template <class M>
std::vector<Input> topic_seeds();
template <>
std::vector<Input> topic_seeds<MapMessage>() {
  return {encoded(MapMessage{"m", room_with_a_door(), {1, 0.5}})};
}
template <>
std::vector<Input> topic_seeds<Mission>() {
  const Mission mission{.robot = "a",
                        .number = 2,
                        .fleet_size = 2,
                        .map_id = map_id(),
                        .start = {4, 8},
                        .goal = {4, 4},
                        .radius = 1,
                        .max_speed = 4,
                        .max_acceleration = 8,
                        .goal_tolerance = 0.5,
                        .seed = 3,
                        .plan_budget = 0.1,
                        .clock = {3.5, 1}};
  Mission cancelled = mission;
  cancelled.cancelled = true;
  Mission alone = mission;
  alone.planner = PlannerKind::rrdt_star;
  Mission other = mission;
  other.planner = PlannerKind::rrt_star;
  other.robot = "c";
  return {encoded(mission), encoded(cancelled), encoded(alone), encoded(other)};
}
template <>
std::vector<Input> topic_seeds<RootNodes>() {
  return {encoded(RootNodes{
      "a", 1, 0, {{Root::start, {4, 8}, -1}, {Root::start, {6, 8}, 0}, {Root::goal, {20, 8}, -1}}})};
}
template <>
std::vector<Input> topic_seeds<InactiveTreesMessage>() {
  return {encoded(InactiveTreesMessage{.id = {1, 9},
                                       .map_id = map_id(),
                                       .radius = 1,
                                       .nodes = {{{6, 8}, -1, 2}, {{10, 8}, 0, 1}, {{15, 8}, -1, 1}},
                                       .links = {{1, {1, 9}, 2}, {0, {1, 8}, 3}}})};
}
template <>
std::vector<Input> topic_seeds<RobotState>() {
  RobotState calls = state_of_b(0.45);
  calls.stage = Stage::waiting;
  calls.round = {1, "b", {12, 6}, 20};
  RobotState passed_on = state_of_b(0.45);
  passed_on.passed_on = true;
  passed_on.promise.velocity = {1, 1};
  passed_on.promise.next_velocity = {2, 1};
  passed_on.waits_for = "a";
  RobotState stranger = state_of_b(0.45);
  stranger.robot = "c";
  RobotState asks = state_of_b(0.45);
  asks.misses = {"c", "a"};
  return {encoded(state_of_b(0.45)), encoded(calls), encoded(passed_on), encoded(stranger), encoded(asks)};
}
template <>
std::vector<Input> topic_seeds<JointPlanMessage>() {
  return {encoded(JointPlanMessage{{1, "b", {12, 6}, 20},
                                   {{"b", 1, false, {{1, {20, 4}}, {2, {15, 8}}, {3, {10, 8}}}},
                                    {"a", 1, true, {{1, {4, 8}}, {2, {6, 8}}, {5, {6, 8}}, {6, {4, 8}}}}},
                                   {{"c", 2, 0.5}}})};
}
template <>
std::vector<Input> topic_seeds<ReservationMessage>() {
  return {encoded(ReservationMessage{"b", 2, 2, 5, 12, {}}),
          encoded(ReservationMessage{"b", 3, 3, 5, 12, {{1, {12, 6}}, {2, {20, 6}}}, {{"a", 1, 0.5}}}),
          encoded(ReservationMessage{"b", 5, 4, 5, 12, {{1, {12, 6}}, {2, {20, 6}}}, {}, {"a", 1, 0.5}})};
}
template <>
std::vector<Input> topic_seeds<PathMessage>() {
  return {encoded(PathMessage{"a", 1, {{4, 8}, {12, 8}, {20, 8}}})};
}
template <>
std::vector<Input> topic_seeds<TrackMessage>() {
  return {encoded(
      TrackMessage{"b", 1, 0, {{0, {20, 4}, {0, 0}}, {0.05, {20, 4}, {1, 0}}, {0.1, {20.05, 4}, {0, 0}}}})};
}
template <>
std::vector<Input> topic_seeds<AgentStatus>() {
  return {encoded(AgentStatus{"a", 1, Phase::arrived, "why not", 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, {}})};
}
template <>
std::vector<Input> topic_seeds<BrokerStatus>() {
  return {encoded(BrokerStatus{7, true, 1, 1, 2, 3, 4, map_id(), 5})};
}

template <>
std::vector<Input> topic_seeds<Claim>() {
  return {encoded(Claim{7, 2, "a"})};
}
template <>
std::vector<Input> topic_seeds<Assignment>() {
  return {encoded(Assignment{"a", 7, 2})};
}

template <>
std::vector<Input> topic_seeds<ActiveTreesMessage>() {
  return {encoded(ActiveTreesMessage{7, map_id(), {{{6, 8}, {10, 8}}, {{20, 4}, {20, 4}}}})};
}

template <>
std::vector<Input> topic_seeds<ServiceStatus>() {
  return {encoded(ServiceStatus{7, "host", 12, 1, 2})};
}

template <>
std::vector<Input> topic_seeds<OrderMessage>() {
  return {encoded(OrderMessage{"o1", Action::go, {"a"}, {{{6, 8}}, {{20, 4}, true, 1, 2}}}),
          encoded(OrderMessage{.id = "o2", .action = Action::cancel, .cancels = "o1"}),
          encoded(OrderMessage{.id = "o3", .action = Action::stop})};
}

template <>
std::vector<Input> topic_seeds<OrderStatus>() {
  return {encoded(
      OrderStatus{{"o1", Action::go, {"a"}, {{{6, 8}}}}, OrderState::failed, "a", "why", 0, 2, 1, 2, 3})};
}

template <>
std::vector<Input> topic_seeds<HaltMessage>() {
  return {encoded(HaltMessage{3, Halt::stopped, {{"a", Halt::none}, {"b", Halt::paused}}})};
}

/// A record of a journal.
void journal_record(Bytes data) {
  (void)deserialized(data);
}
std::vector<Input> journal_record_seeds() {
  return {serialized(Claim{7, 2, "a"}), serialized(BrokerStatus{7, true, 1, 1, 2, 3, 4, map_id(), 5})};
}

// --- sequences ---

template <std::size_t... K>
std::optional<Message> decoded_of(std::size_t topic, Bytes data, std::index_sequence<K...>) {
  std::optional<Message> message;
  (void)((topic == K && (message = decoded<std::variant_alternative_t<K, Message>>(data), true)) || ...);
  return message;
}

/// Each message begins with the number of its topic, the periods until it arrives, and its length in two
/// bytes.
void sequence(Bytes data) {
  constexpr auto topics = std::make_index_sequence<std::variant_size_v<Message>>();
  SmallFleet fleet;
  for (std::size_t count = 0; count < most_messages && data.size() >= 4; ++count) {
    const std::size_t length = std::min<std::size_t>(data[2] | data[3] << 8, data.size() - 4);
    for (int k = data[1] % 8; k > 0; --k) fleet.step();
    if (const auto message = decoded_of(data[0] % topics.size(), data.subspan(4, length), topics))
      fleet.give(*message, fleet.now());
    data = data.subspan(4 + length);
  }
  for (int k = 0; k < 8; ++k) fleet.step();
  fleet.report();
}

template <std::size_t... K>
std::vector<Input> sequence_seeds(std::index_sequence<K...>) {
  Input all;
  const auto add = [&](std::size_t topic, const Input& sample) {
    all.insert(all.end(),
               {static_cast<std::uint8_t>(topic), 2, static_cast<std::uint8_t>(sample.size() & 0xff),
                static_cast<std::uint8_t>(sample.size() >> 8)});
    all.insert(all.end(), sample.begin(), sample.end());
  };
  // Of the states, the one that calls the round of the plan that follows.
  (add(K, topic_seeds<std::variant_alternative_t<K, Message>>()[K == 4 ? 1 : 0]), ...);
  return {all};
}
std::vector<Input> sequence_seeds() {
  return sequence_seeds(std::make_index_sequence<std::variant_size_v<Message>>());
}

// --- discovery ---

Input text(std::string_view characters) {
  return {characters.begin(), characters.end()};
}

void user_data(Bytes data) {
  const RobotName robot = robot_of(data);
  if (!robot.empty() && robot_of(user_data_of(robot)) != robot) std::abort();
}
std::vector<Input> user_data_seeds() {
  return {user_data_of("r1"), text("robot="), text("enclave=/;")};
}

void announcement(Bytes data) {
  (void)announcement_in(data);
  (void)sender_of(data);
  (void)addresses_in(data);
  (void)endpoint_heartbeat_in(data);
}
std::vector<Input> announcement_seeds() {
  Input message(20, 0);
  const Input timestamp{0x09, 0x01, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8};
  const Input data{0x15, 0x05, 24, 0, 0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1,
                   0,    0xc2, 0,  0, 0, 0, 3,  0, 0, 0, 1, 2,    3, 4};
  message.insert(message.end(), timestamp.begin(), timestamp.end());
  message.insert(message.end(), data.begin(), data.end());
  return {message};
}

void discovery_servers(Bytes data) {
  const std::string servers(data.begin(), data.end());
  (void)look_up_servers(servers);
}
std::vector<Input> discovery_servers_seeds() {
  return {text("127.0.0.1:11811"), text(";10.0.0.1:65535;1.2.3.4"), text("[::1]:11811"),
          text("localhost:11811;host-2")};
}

template <class M>
constexpr Target of_topic() {
  return {Topic<M>::info.name, topic<M>, topic_seeds<M>};
}

constexpr std::array all{of_topic<MapMessage>(),
                         of_topic<Mission>(),
                         of_topic<RootNodes>(),
                         of_topic<InactiveTreesMessage>(),
                         of_topic<RobotState>(),
                         of_topic<JointPlanMessage>(),
                         of_topic<ReservationMessage>(),
                         of_topic<PathMessage>(),
                         of_topic<TrackMessage>(),
                         of_topic<AgentStatus>(),
                         of_topic<BrokerStatus>(),
                         of_topic<Claim>(),
                         of_topic<Assignment>(),
                         of_topic<ActiveTreesMessage>(),
                         of_topic<ServiceStatus>(),
                         of_topic<OrderMessage>(),
                         of_topic<OrderStatus>(),
                         of_topic<HaltMessage>(),
                         Target{"journal_record", journal_record, journal_record_seeds},
                         Target{"sequence", sequence, sequence_seeds},
                         Target{"user_data", user_data, user_data_seeds},
                         Target{"announcement", announcement, announcement_seeds},
                         Target{"discovery_servers", discovery_servers, discovery_servers_seeds}};

}  // namespace

std::span<const Target> bus_targets() {
  return all;
}

}  // namespace coppice::fuzz
