#include "monitor/api.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "coppice/files/input_error.h"
#include "messages/order_json.h"
#include "messages/validation.h"
#include "monitor/api_json.h"
#include "monitor/order_request.h"
#include "monitor/web_problem.h"
#include "monitor/web_rules.h"

namespace coppice {

namespace {

constexpr const char* json_type = "application/json";
constexpr std::string_view orders_path = "/api/orders/";
constexpr WallTime longest_silence = 15;          // seconds: proxies cut off connections that say nothing
constexpr std::size_t enough_events = 256 << 10;  // bytes of events that are sent at a time

std::string_view name_of(Action action) {
  return action_names.at(static_cast<std::size_t>(action));
}
std::string_view name_of(OrderState state) {
  return order_state_names.at(static_cast<std::size_t>(state));
}

WebReply not_allowed(const std::string& allowed) {
  WebReply reply = problem_reply(405, "Allowed here: " + allowed);
  reply.headers = {{"Allow", allowed}};
  return reply;
}

WebReply no_order(const std::string& id) {
  return problem_reply(404, fmt::format("there is no order {}", id));
}

WebReply has_ended(const OrderStatus& status) {
  return problem_reply(409,
                       fmt::format("order {} has ended already: {}", status.order.id, name_of(status.state)));
}

/// The fleet did not begin it.
bool is_refused(const OrderStatus& status) {
  return status.state == OrderState::failed && status.begun_at == 0;
}

WebReply reply_of(const OrderStatus& status, unsigned http_status) {
  if (is_refused(status)) return problem_reply(422, status.reason);
  return {json_type, json_of(status), http_status};
}

WebReply reply_to_go(const OrderStatus& status, unsigned http_status) {
  WebReply reply = reply_of(status, http_status);
  if (!is_refused(status)) reply.headers = {{"Location", std::string(orders_path) + status.order.id}};
  return reply;
}

/// For the log: "r2 to (3, 4) as order 3f21", "stop r1".
std::string sentence_of(const OrderMessage& order) {
  const std::string robots = fmt::format("{}", fmt::join(order.robots, ", "));
  if (order.action == Action::cancel) return "cancel order " + order.cancels;
  if (order.action != Action::go)
    return fmt::format("{} {}", name_of(order.action), robots.empty() ? "all robots" : robots);
  std::vector<std::string> places;
  for (const Visit& visit : order.visits)
    places.push_back(fmt::format("({:g}, {:g})", visit.position.x(), visit.position.y()));
  return fmt::format("send {} to {} as order {}", robots.empty() ? "any robot" : robots,
                     fmt::join(places, ", "), order.id);
}

/// What one client was sent of the events.
struct EventReader {
  std::uint64_t seen = 0;
  WallTime spoke_at = 0;

  std::string next(const EventBoard& board, WallTime now) {
    std::string text = board.after(seen, enough_events);
    if (text.empty() && now - spoke_at >= longest_silence) text = ": nothing new\n\n";
    if (!text.empty() || now < spoke_at) spoke_at = now;  // the clock may have been set back
    return text;
  }
};

}  // namespace

Api::Api(std::function<std::string()> draw_id) : draw_id_(std::move(draw_id)) {
  board_.post("halt", "", json_of(desk_.halts()));
}

void Api::receive(const OrderStatus& status) {
  for (const std::string& id : desk_.on(status)) board_.remove("order", id);
  if (desk_.find(status.order.id) != nullptr) board_.post("order", status.order.id, json_of(status));
}

void Api::receive(const ServiceStatus& status) {
  for (const std::string& id : desk_.on(status)) board_.remove("order", id);
}

void Api::receive(const HaltMessage& halts) {
  desk_.on(halts);
  board_.post("halt", "", json_of(halts));
}

void Api::look(const FleetView& view, WallTime now) {
  now_ = now;
  if (!robot_rhythm_.due(now)) return;
  for (const std::string& name : std::exchange(shown_robots_, {})) {
    if (!view.find(name)) board_.remove("robot", name);
  }
  for (const SeenRobot& robot : view.robots()) {
    board_.post("robot", robot.name, json_of_robot(robot, view));
    shown_robots_.push_back(robot.name);
  }
}

std::vector<OrderMessage> Api::take_orders() {
  return std::exchange(given_, {});
}

WebAnswer Api::answer(const WebRequest& request, const FleetView& view) {
  try {
    return route(request, view);
  } catch (const InputError& error) {
    return problem_reply(400, error.what());
  }
}

WebAnswer Api::route(const WebRequest& request, const FleetView& view) {
  if (request.path == "/api/orders") return orders(request);
  if (request.path.starts_with(orders_path))
    return one_order(request, decoded(request.path.substr(orders_path.size())));
  if (request.path == "/api/robots") return robots(request, view);
  if (request.path == "/api/events") return events(request);
  for (const Action action : {Action::stop, Action::release, Action::pause, Action::resume}) {
    if (request.path != fmt::format("/api/{}", name_of(action))) continue;
    return request.method == "POST" ? halt(request, action) : not_allowed("POST");
  }
  return problem_reply(404, fmt::format("the API has no {}", request.path));
}

WebAnswer Api::orders(const WebRequest& request) {
  if (request.method == "GET") return list(request.query);
  if (request.method == "POST") return go(request);
  return not_allowed("GET, POST");
}

WebAnswer Api::one_order(const WebRequest& request, const std::string& id) {
  if (request.method == "DELETE") return cancel(request, id);
  if (request.method != "GET") return not_allowed("GET, DELETE");
  const OrderStatus* const status = desk_.find(id);
  return status == nullptr ? no_order(id) : WebReply{json_type, json_of(*status)};
}

WebAnswer Api::robots(const WebRequest& request, const FleetView& view) const {
  if (request.method != "GET") return not_allowed("GET");
  std::vector<std::string> all;
  for (const SeenRobot& robot : view.robots()) all.push_back(json_of_robot(robot, view));
  return WebReply{json_type, fmt::format(R"({{"robots":[{}]}})", fmt::join(all, ","))};
}

WebAnswer Api::events(const WebRequest& request) {
  if (request.method != "GET") return not_allowed("GET");
  spdlog::info("{} listens to events", request.client);
  return WebStream{[this, reader = EventReader()]() mutable { return reader.next(board_, now_); }};
}

WebReply Api::list(std::string_view query) const {
  std::optional<OrderState> state;
  if (const auto wanted = query_value(query, "state")) {
    const auto* const known = std::ranges::find(order_state_names, *wanted);
    if (known == order_state_names.end())
      return problem_reply(400, fmt::format("state: expected one of {}, found {}",
                                            fmt::join(order_state_names, ", "), *wanted));
    state = static_cast<OrderState>(known - order_state_names.begin());
  }
  std::vector<std::string> all;
  for (const OrderStatus* const status : desk_.list(state)) all.push_back(json_of(*status));
  return {json_type, fmt::format(R"({{"orders":[{}]}})", fmt::join(all, ","))};
}

WebAnswer Api::go(const WebRequest& request) {
  OrderMessage order = order_of(request.body, now_);
  if (order.id.empty()) order.id = draw_id_();
  if (const OrderStatus* const known = desk_.find(order.id)) return reply_to_go(*known, 200);
  return give(order, request.client, [this, id = order.id]() -> std::optional<WebReply> {
    const OrderStatus* const status = desk_.find(id);
    return status == nullptr ? std::nullopt : std::optional(reply_to_go(*status, 201));
  });
}

WebAnswer Api::halt(const WebRequest& request, Action action) {
  OrderMessage order = halt_order_of(request.body, action);
  order.id = draw_id_();
  return give(order, request.client, [this, id = order.id]() -> std::optional<WebReply> {
    const OrderStatus* const status = desk_.find(id);
    return status == nullptr ? std::nullopt : std::optional(reply_of(*status, 200));
  });
}

/// The reply tells of the order that is cancelled. Its status may come after that of the cancellation.
WebAnswer Api::cancel(const WebRequest& request, const std::string& id) {
  const OrderStatus* const target = desk_.find(id);
  if (target == nullptr) return no_order(id);
  if (is_ended(target->state)) return has_ended(*target);
  OrderMessage order{.id = draw_id_(), .action = Action::cancel, .cancels = id};
  return give(order, request.client, [this, id, own = order.id]() -> std::optional<WebReply> {
    const OrderStatus* const status = desk_.find(id);
    if (status == nullptr) return no_order(id);
    if (status->state == OrderState::cancelled) return WebReply{json_type, json_of(*status)};
    if (is_ended(status->state)) return has_ended(*status);
    const OrderStatus* const cancellation = desk_.find(own);
    const bool failed = cancellation != nullptr && cancellation->state == OrderState::failed;
    return failed ? std::optional(problem_reply(409, cancellation->reason)) : std::nullopt;
  });
}

WebAnswer Api::give(OrderMessage order, std::string_view client,
                    std::function<std::optional<WebReply>()> settled) {
  if (const auto problem = problem_with(Message(order))) return problem_reply(400, *problem);
  spdlog::info("{} at {}: {}", order.by.empty() ? "somebody" : order.by, client, sentence_of(order));
  const std::string late =
      fmt::format("the planner service has said nothing of order {} for {:g} s; it may still carry it out",
                  order.id, patience);
  given_.push_back(std::move(order));
  return WebWait{[this, asked = now_, late, settled = std::move(settled)]() -> std::optional<WebReply> {
    if (auto reply = settled()) return reply;
    const bool is_late = now_ - asked > patience || asked - now_ > patience;  // the clock was set back
    return is_late ? std::optional(problem_reply(504, late)) : std::nullopt;
  }};
}

std::string Api::json_of_robot(const SeenRobot& robot, const FleetView& view) const {
  return json_of(robot, view.fleet_time(now_).value_or(0), desk_.order_of(robot.name),
                 halt_of(desk_.halts(), robot.name));
}

}  // namespace coppice
