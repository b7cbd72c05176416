#include "planner_service/run/fleet_memory.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <google/protobuf/util/json_util.h>

#include "coppice/files/input_error.h"
#include "files/json_file.h"
#include "files/text_file.h"
#include "fleet_memory.pb.h"
#include "messages/validation.h"

namespace coppice {

namespace {

constexpr std::array<std::string_view, 4> halt_names{"none", "paused", "stopped", "paused and stopped"};

std::filesystem::path orders_file(const std::filesystem::path& folder) {
  return folder / "fleet.json";
}
std::filesystem::path poses_file(const std::filesystem::path& folder) {
  return folder / "poses.json";
}

template <class Enum>
std::string name_of(Enum value, std::span<const std::string_view> names) {
  return std::string(names[static_cast<std::size_t>(value)]);
}

template <class Enum>
Enum value_of(const std::string& name, std::span<const std::string_view> names) {
  const auto known = std::ranges::find(names, name);
  if (known == names.end())
    throw InputError(fmt::format("\"{}\" is none of {}", name, fmt::join(names, ", ")));
  return static_cast<Enum>(known - names.begin());
}

proto::FleetMemory::Order file_form(const OrderStatus& status) {
  const OrderMessage& order = status.order;
  proto::FleetMemory::Order saved;
  saved.set_id(order.id);
  saved.set_action(name_of(order.action, action_names));
  saved.set_state(name_of(status.state, order_state_names));
  for (const RobotName& robot : order.robots) saved.add_robots(robot);
  for (const Visit& visit : order.visits) {
    proto::FleetMemory::Visit* const own = saved.add_visits();
    own->set_x(visit.position.x());
    own->set_y(visit.position.y());
    if (visit.has_yaw) own->set_yaw(visit.yaw);
    own->set_wait(visit.wait);
  }
  saved.set_cancels(order.cancels);
  saved.set_priority(order.priority);
  saved.set_deadline(order.deadline);
  saved.set_by(order.by);
  saved.set_replaces(order.replaces);
  saved.set_robot(status.robot);
  saved.set_reason(status.reason);
  saved.set_visited(status.visited);
  saved.set_accepted_at(status.accepted_at);
  saved.set_begun_at(status.begun_at);
  saved.set_ended_at(status.ended_at);
  return saved;
}

OrderStatus from_file_form(const proto::FleetMemory::Order& saved) {
  OrderStatus status{.order = {.id = saved.id(),
                               .action = value_of<Action>(saved.action(), action_names),
                               .robots = {saved.robots().begin(), saved.robots().end()},
                               .cancels = saved.cancels(),
                               .priority = saved.priority(),
                               .deadline = saved.deadline(),
                               .by = saved.by(),
                               .replaces = saved.replaces()},
                     .state = value_of<OrderState>(saved.state(), order_state_names),
                     .robot = saved.robot(),
                     .reason = saved.reason(),
                     .visited = saved.visited(),
                     .accepted_at = saved.accepted_at(),
                     .begun_at = saved.begun_at(),
                     .ended_at = saved.ended_at()};
  for (const proto::FleetMemory::Visit& visit : saved.visits())
    status.order.visits.push_back({.position = {visit.x(), visit.y()},
                                   .has_yaw = visit.has_yaw(),
                                   .yaw = visit.yaw(),
                                   .wait = visit.wait()});
  if (const auto problem = problem_with(Message(status)))
    throw InputError(fmt::format("order {}: {}", saved.id(), *problem));
  return status;
}

HaltMessage halts_in(const proto::FleetMemory& saved) {
  HaltMessage halts{.number = static_cast<std::uint64_t>(std::clamp(saved.halts_number(), 0.0, 1e15)),
                    .everybody = value_of<Halt>(saved.everybody(), halt_names)};
  for (const proto::FleetMemory::Halted& own : saved.halts())
    halts.robots.push_back({own.robot(), value_of<Halt>(own.halt(), halt_names)});
  if (const auto problem = problem_with(Message(halts))) throw InputError(*problem);
  return halts;
}

std::string text_of(const FleetMemory& memory) {
  proto::FleetMemory saved;
  saved.set_halts_number(static_cast<double>(memory.halts.number));
  saved.set_everybody(name_of(memory.halts.everybody, halt_names));
  for (const HaltMessage::Robot& own : memory.halts.robots) {
    proto::FleetMemory::Halted* const halted = saved.add_halts();
    halted->set_robot(own.robot);
    halted->set_halt(name_of(own.halt, halt_names));
  }
  for (const OrderStatus& status : memory.orders) *saved.add_orders() = file_form(status);
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.preserve_proto_field_names = true;
  std::string json;
  if (!google::protobuf::util::MessageToJsonString(saved, &json, options).ok())
    throw InputError("halts and orders cannot be written as JSON");
  return json;
}

}  // namespace

FleetMemory remembered_in(const std::filesystem::path& folder) {
  FleetMemory memory;
  if (std::filesystem::exists(poses_file(folder))) memory.poses = read_saved_poses(poses_file(folder));
  const std::filesystem::path file = orders_file(folder);
  if (!std::filesystem::exists(file)) return memory;
  proto::FleetMemory saved;
  read_json(file, saved);
  try {
    memory.halts = halts_in(saved);
    for (const proto::FleetMemory::Order& order : saved.orders())
      memory.orders.push_back(from_file_form(order));
  } catch (const InputError& problem) {
    throw InputError(fmt::format("{}: {}", file.string(), problem.what()));
  }
  return memory;
}

void remember(const std::filesystem::path& folder, const FleetMemory& memory, const Scenario& site) {
  write_poses(poses_file(folder), memory.poses, site);
  write_file(orders_file(folder), text_of(memory));
}

}  // namespace coppice
