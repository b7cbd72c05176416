#include "coppice/orders/order_options.h"

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "coppice/run/watching_options.h"
#include "files/number_check.h"
#include "messages/validation.h"
#include "planning/number_text.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

/// "30,8" or "30,8,1.57".
std::optional<Visit> visit_of(const std::string& text) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (std::string word; std::getline(words, word, ',');) {
    const auto number = decimal_number(word);
    if (!number || !is_sane(*number)) return std::nullopt;
    numbers.push_back(*number);
  }
  if (text.ends_with(',') || numbers.size() < 2 || numbers.size() > 3) return std::nullopt;
  Visit visit{.position = {numbers[0], numbers[1]}};
  visit.has_yaw = numbers.size() == 3;
  if (visit.has_yaw) visit.yaw = numbers[2];
  return visit;
}

std::string user() {
  const char* const name = std::getenv("USER");
  return name != nullptr ? std::string(name).substr(0, longest_name) : "";
}

/// Options of every command that gives an order.
void add_giving_options(CLI::App& command, OrderOptions& options, const char* until) {
  command.option_defaults()->group("Answer");
  command.add_flag("--wait", options.wait, until);
  command.add_option("--patience", options.patience, "seconds in which the fleet has to answer")
      ->check(number_above_zero());
  command.add_flag("--json", options.as_json, "prints each change of the order as a line of JSON");
  command.add_option("--by", options.order.by, "who gives the order; the history tells it")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return name.size() <= longest_name ? "" : fmt::format("expected at most {} bytes", longest_name);
          },
          ""))
      ->type_name("NAME")
      ->default_str("the user");
  add_network_options(command, options.network, "dispatcher", domain_of_fleet);
}

void give(CLI::App& command, OrderOptions& options, Action action, ChosenCommand& chosen) {
  command.callback([&options, &chosen, &command, action] {
    options.order.action = action;
    if (action == Action::go && options.order.robots.empty() && !options.any)
      throw CLI::RequiredError("a robot, or --any");
    if (options.order.by.empty()) options.order.by = user();
    for (Visit& visit : options.order.visits) visit.wait = options.stay;
    chosen = [&options, &command] {
      find_fleet(command, options.network);
      return give_order_command(options);
    };
  });
}

void add_send(CLI::App& app, OrderOptions& options, ChosenCommand& chosen) {
  auto* send = app.add_subcommand("send", "sends a robot to places");
  auto* robot =
      send->add_option("robot", options.order.robots, "the robot")->expected(0, 1)->type_name("NAME");
  auto* any =
      send->add_flag("--any", options.any, "the free robot with the shortest way goes")->excludes(robot);
  send->add_option_function<std::vector<std::string>>(
          "--to",
          [&options](const std::vector<std::string>& places) {
            for (const std::string& place : places) options.order.visits.push_back(visit_of(place).value());
          },
          "place in the map frame, metres, and a yaw in radians; several are visited in turn")
      ->check(CLI::Validator(
          [](const std::string& place) {
            const auto visit = visit_of(place);
            if (!visit) return fmt::format("{}: expected X,Y or X,Y,YAW", place);
            return is_yaw(visit->yaw)
                       ? std::string()
                       : fmt::format("{}: yaw {:g} is not allowed, expected {}", place, visit->yaw, yaw_rule);
          },
          ""))
      ->type_name("X,Y[,YAW]")
      ->expected(1)
      ->take_all()
      ->required();
  send->add_flag("--each", options.each, "each place is an order of its own, for any robot")->needs(any);
  send->add_option("--stay", options.stay, "seconds that the robot stands at each place")
      ->check(number_between(0, longest_visit));
  send->add_option("--priority", options.order.priority, "orders with a higher one are served first");
  send->add_option("--deadline", options.deadline, "seconds from now; it is reported, and not promised")
      ->check(number_above_zero())
      ->default_str("none");
  add_giving_options(*send, options, "waits until the robot has been there; fails if the order fails");
  give(*send, options, Action::go, chosen);
}

void add_cancel(CLI::App& app, OrderOptions& options, ChosenCommand& chosen) {
  auto* cancel = app.add_subcommand("cancel", "cancels an order; its robot stops");
  cancel->add_option("order", options.order.cancels, "id of the order")->required()->type_name("ID");
  add_giving_options(*cancel, options, "waits until the order is cancelled, or its end has come first");
  give(*cancel, options, Action::cancel, chosen);
}

void add_halt(CLI::App& app, const char* name, const char* what, Action action, OrderOptions& options,
              ChosenCommand& chosen) {
  auto* command = app.add_subcommand(name, what);
  command->add_option("robots", options.order.robots, "the robots")->type_name("NAME")->default_str("all");
  add_giving_options(*command, options, "waits until all these robots have confirmed it");
  give(*command, options, action, chosen);
}

void add_orders(CLI::App& app, OrderOptions& options, ChosenCommand& chosen) {
  auto* orders = app.add_subcommand("orders", "lists the orders of a fleet, and what each robot waits for");
  orders->add_flag("--all", options.all, "ended orders, too");
  orders->add_flag("--json", options.as_json, "prints each order as a line of JSON");
  add_network_options(*orders, options.network, "observer", domain_of_fleet);
  orders->callback([&options, &chosen, orders] {
    chosen = [&options, orders] {
      find_fleet(*orders, options.network);
      return orders_command(options);
    };
  });
}

}  // namespace

void add_order_commands(CLI::App& app, OrderOptions& options, ChosenCommand& chosen) {
  add_send(app, options, chosen);
  add_orders(app, options, chosen);
  add_cancel(app, options, chosen);
  add_halt(app, "pause", "makes robots stand until they are resumed", Action::pause, options, chosen);
  add_halt(app, "resume", "ends a pause", Action::resume, options, chosen);
  add_halt(app, "stop", "makes robots brake at once and stand until they are released", Action::stop, options,
           chosen);
  add_halt(app, "release", "ends a stop", Action::release, options, chosen);
}

}  // namespace coppice
