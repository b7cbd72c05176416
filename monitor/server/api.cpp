#include "monitor/server/api.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "coppice/files/input_error.h"
#include "messages/order_json.h"
#include "messages/validation.h"
#include "monitor/server/api_json.h"
#include "monitor/server/order_request.h"
#include "monitor/server/web_problem.h"
#include "monitor/server/web_rules.h"

namespace coppice {

namespace {

constexpr const char* json_type = "application/json";
constexpr std::string_view orders_path = "/api/orders/";
constexpr WallTime between_repeats = 1;           // seconds
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

WebReply reply_of(const OrderStatus& status, unsigned http_status) {
  // What the service cannot save now, it may be able to save later.
  if (is_refused(status))
    return problem_reply(status.reason.starts_with(cannot_be_saved) ? 503 : 422, status.reason);
  return {json_type, json_of(status), http_status};
}

/// Robots that a resume was for may be held by a stop.
WebReply reply_to_halt(const OrderStatus& status) {
  const bool has_failed = status.state == OrderState::failed && !is_refused(status);
  return has_failed ? problem_reply(409, status.reason) : reply_of(status, 200);
}

WebReply reply_to_go(const OrderStatus& status, unsigned http_status) {
  WebReply reply = reply_of(status, http_status);
  if (!is_refused(status)) reply.headers = {{"Location", std::string(orders_path) + status.order.id}};
  return reply;
}

/// Throws InputError if the query has another parameter, or one of these twice. A client that misspells a
/// parameter must not get an answer to another question.
void allow_parameters(std::string_view query, std::initializer_list<std::string_view> known) {
  std::vector<std::string> found;
  for (std::string& name : parameter_names(query)) {
    if (std::ranges::find(known, name) == known.end())
      throw InputError(fmt::format("unknown parameter {} in the query: expected {}", name,
                                   known.size() == 0 ? "none" : fmt::format("{}", fmt::join(known, ", "))));
    if (std::ranges::find(found, name) != found.end())
      throw InputError(fmt::format("{}: expected once in the query, found more often", name));
    found.push_back(std::move(name));
  }
}

/// Empty if the query does not have it.
std::string text_parameter(std::string_view query, std::string_view name, std::size_t longest) {
  std::string text = query_value(query, name).value_or("");
  if (text.size() > longest)
    throw InputError(fmt::format("{}: expected at most {} bytes, found {}", name, longest, text.size()));
  return text;
}

/// For the log: "r2 to (3, 4) as order 3f21", "stop r1".
std::string sentence_of(const OrderMessage& order) {
  const std::string robots = fmt::format("{}", fmt::join(order.robots, ", "));
  if (order.action == Action::cancel)
    return fmt::format("cancel order {}{}{}", order.cancels, order.why.empty() ? "" : ": ", order.why);
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
  show_alarms({});
}

void Api::receive(const OrderStatus& status) {
  unanswered_.erase(status.order.id);
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

void Api::look(const FleetView& view, WallTime now, const AlarmBoard& alarms) {
  now_ = now;
  if (!robot_rhythm_.due(now)) return;
  show_alarms(alarms.alarms());
  for (const std::string& name : std::exchange(shown_robots_, {})) {
    if (!view.find(name)) board_.remove("robot", name);
  }
  for (const SeenRobot& robot : view.robots()) {
    board_.post("robot", robot.name, json_of_robot(robot, view));
    shown_robots_.push_back(robot.name);
  }
}

void Api::show_alarms(const std::vector<Alarm>& alarms) {
  alarms_ = json_of(alarms);
  board_.post("alarms", "", alarms_);
}

std::vector<OrderMessage> Api::take_orders() {
  std::erase_if(unanswered_, [&](const auto& entry) { return is_late(entry.second.given); });
  std::vector<OrderMessage> due;
  for (auto& [id, own] : unanswered_) {
    if (own.sent && now_ - *own.sent < between_repeats) continue;
    own.sent = now_;
    due.push_back(own.order);
  }
  return due;
}

/// Also if the clock was set back.
bool Api::is_late(WallTime asked) const {
  return now_ - asked > patience || asked - now_ > patience;
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
  if (request.path == "/api/alarms") return alarms(request);
  if (request.path == "/api/events") return events(request);
  for (const Action action : {Action::stop, Action::release, Action::pause, Action::resume}) {
    if (request.path != fmt::format("/api/{}", name_of(action))) continue;
    if (request.method != "POST") return not_allowed("POST");
    allow_parameters(request.query, {});
    return halt(request, action);
  }
  return problem_reply(404, fmt::format("the API has no {}", request.path));
}

WebAnswer Api::orders(const WebRequest& request) {
  if (request.method == "GET") {
    allow_parameters(request.query, {"state"});
    return list(request.query);
  }
  if (request.method != "POST") return not_allowed("GET, POST");
  allow_parameters(request.query, {});
  return go(request);
}

WebAnswer Api::one_order(const WebRequest& request, const std::string& id) {
  if (request.method == "DELETE") {
    allow_parameters(request.query, {"by", "why"});
    return cancel(request, id);
  }
  if (request.method != "GET") return not_allowed("GET, DELETE");
  allow_parameters(request.query, {});
  const OrderStatus* const status = desk_.find(id);
  return status == nullptr ? no_order(id) : WebReply{json_type, json_of(*status)};
}

WebAnswer Api::robots(const WebRequest& request, const FleetView& view) const {
  if (request.method != "GET") return not_allowed("GET");
  allow_parameters(request.query, {});
  std::vector<std::string> all;
  for (const SeenRobot& robot : view.robots()) all.push_back(json_of_robot(robot, view));
  return WebReply{json_type, fmt::format(R"({{"robots":[{}]}})", fmt::join(all, ","))};
}

WebAnswer Api::alarms(const WebRequest& request) const {
  if (request.method != "GET") return not_allowed("GET");
  allow_parameters(request.query, {});
  return WebReply{json_type, alarms_};
}

WebAnswer Api::events(const WebRequest& request) {
  if (request.method != "GET") return not_allowed("GET");
  allow_parameters(request.query, {});
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
  return {json_type, fmt::format(R"({{"orders":[{}],"problem":{}}})", fmt::join(all, ","),
                                 text_or_null(desk_.problem()))};
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
    return status == nullptr ? std::nullopt : std::optional(reply_to_halt(*status));
  });
}

/// The reply tells of the order that is cancelled. Its status may come after that of the cancellation.
WebAnswer Api::cancel(const WebRequest& request, const std::string& id) {
  const OrderStatus* const target = desk_.find(id);
  if (target == nullptr) return no_order(id);
  if (is_ended(target->state)) return has_ended(*target);
  OrderMessage order{.id = draw_id_(),
                     .action = Action::cancel,
                     .cancels = id,
                     .by = text_parameter(request.query, "by", longest_name),
                     .why = text_parameter(request.query, "why", longest_why)};
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
  const std::string id = order.id;
  unanswered_.insert_or_assign(id, Unanswered{std::move(order), now_});
  return WebWait{[this, asked = now_, late, settled = std::move(settled)]() -> std::optional<WebReply> {
    if (auto reply = settled()) return reply;
    return is_late(asked) ? std::optional(problem_reply(504, late)) : std::nullopt;
  }};
}

std::string Api::json_of_robot(const SeenRobot& robot, const FleetView& view) const {
  return json_of(robot, view.fleet_time(now_).value_or(0), desk_.order_of(robot.name),
                 halt_of(desk_.halts(), robot.name), now_);
}

}  // namespace coppice
