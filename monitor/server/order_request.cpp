#include "monitor/server/order_request.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "files/json_file.h"
#include "messages/validation.h"
#include "orders.pb.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

constexpr const char* body_name = "body";

/// Ids are parts of URLs. These characters need no escape there (RFC 3986, 2.3).
bool is_fine_id(std::string_view id) {
  constexpr std::string_view fine = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  return !id.empty() && id.size() <= longest_name && id.find_first_not_of(fine) == std::string_view::npos;
}

[[noreturn]] void fail(const std::string& problem) {
  throw InputError(fmt::format("{}: {}", body_name, problem));
}

Visit visit_of(const proto::OrderRequest::Goal& goal, const std::string& field) {
  if (!goal.has_x() || !goal.has_y()) fail(field + ": expected x and y");
  for (const double value : {goal.x(), goal.y()}) {
    if (!is_sane(value)) fail(fmt::format("{}: {:g} is too large", field, value));
  }
  if (!is_yaw(goal.yaw()))
    fail(fmt::format("{}.yaw: {:g} is not allowed, expected {}", field, goal.yaw(), yaw_rule));
  if (!(goal.wait() >= 0 && goal.wait() <= longest_visit))
    fail(fmt::format("{}.wait: expected 0 to {:g} seconds, found {:g}", field, longest_visit, goal.wait()));
  return {
      .position = {goal.x(), goal.y()}, .has_yaw = goal.has_yaw(), .yaw = goal.yaw(), .wait = goal.wait()};
}

std::vector<Visit> visits_of(const proto::OrderRequest& request) {
  if (request.has_goal() == (request.goals_size() > 0)) fail("expected either goal or goals");
  if (request.has_goal()) return {visit_of(request.goal(), "goal")};
  if (request.goals_size() > static_cast<int>(most_visits))
    fail(fmt::format("goals: expected at most {}, found {}", most_visits, request.goals_size()));
  std::vector<Visit> visits;
  for (int k = 0; k < request.goals_size(); ++k)
    visits.push_back(visit_of(request.goals(k), fmt::format("goals[{}]", k)));
  return visits;
}

void check_name(const std::string& name, const char* field) {
  if (name.size() > longest_name) fail(fmt::format("{}: expected at most {} bytes", field, longest_name));
}

}  // namespace

OrderMessage order_of(std::string_view body, WallTime now) {
  proto::OrderRequest request;
  read_json_text(body, body_name, request);
  OrderMessage order{.visits = visits_of(request), .priority = request.priority(), .by = request.by()};
  if (request.has_id()) {
    if (!is_fine_id(request.id()))
      fail(fmt::format("id: expected 1 to {} letters, digits and -._~", longest_name));
    order.id = request.id();
  }
  if (request.has_robot()) {
    check_name(request.robot(), "robot");
    order.robots = {request.robot()};
  }
  if (request.has_deadline()) {
    if (!(request.deadline() > 0 && is_sane(request.deadline())))
      fail(fmt::format("deadline: expected a time above 0, found {:g}", request.deadline()));
    order.deadline = now + request.deadline();
  }
  check_name(order.by, "by");
  order.replaces = request.replace();
  if (order.replaces && order.robots.empty()) fail("replace: goes with a robot that is named");
  return order;
}

OrderMessage halt_order_of(std::string_view body, Action action) {
  proto::HaltRequest request;
  if (!body.empty()) read_json_text(body, body_name, request);
  for (const std::string& robot : request.robots()) check_name(robot, "robots");
  check_name(request.by(), "by");
  return {.action = action, .robots = {request.robots().begin(), request.robots().end()}, .by = request.by()};
}

}  // namespace coppice
