// The HTTP API to a fleet: orders, robots and events (docs/api.md).
//
// A state machine without sockets and without a clock. Messages of the fleet and requests of clients go in,
// and orders come out. The reply to an order waits for the planner service's first word on it.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "monitor/server/web_server.h"
#include "monitor/view/alarms.h"
#include "monitor/view/event_board.h"
#include "monitor/view/fleet_view.h"
#include "monitor/view/order_desk.h"
#include "monitor/view/rhythm.h"

namespace coppice {

class Api {
 public:
  /// Seconds that a client waits for the planner service.
  static constexpr WallTime patience = 5;

  /// `draw_id`: returns an id that no other order has.
  explicit Api(std::function<std::string()> draw_id);

  void on(const Message& message) {
    std::visit(
        [this](const auto& m) {
          if constexpr (requires { receive(m); }) receive(m);
        },
        message);
  }
  /// Once a turn: shows robots and alarms to clients that listen, and tells the time.
  void look(const FleetView& view, WallTime now, const AlarmBoard& alarms = AlarmBoard());
  /// The answer refers to this object.
  WebAnswer answer(const WebRequest& request, const FleetView& view);
  /// Returns the orders that are to be published now. One that the planner service has not answered comes
  /// again every second, as long as its client waits: the service may be restarted in between.
  std::vector<OrderMessage> take_orders();

 private:
  void receive(const OrderStatus& status);
  void receive(const ServiceStatus& status);
  void receive(const HaltMessage& halts);
  WebAnswer route(const WebRequest& request, const FleetView& view);
  WebAnswer orders(const WebRequest& request);
  WebAnswer one_order(const WebRequest& request, const std::string& id);
  WebAnswer robots(const WebRequest& request, const FleetView& view) const;
  WebAnswer alarms(const WebRequest& request) const;
  WebAnswer events(const WebRequest& request);

  WebReply list(std::string_view query) const;
  WebAnswer go(const WebRequest& request);
  WebAnswer cancel(const WebRequest& request, const std::string& id);
  WebAnswer halt(const WebRequest& request, Action action);
  /// `settled`: the reply, when it is known.
  WebAnswer give(OrderMessage order, std::string_view client,
                 std::function<std::optional<WebReply>()> settled);
  bool is_late(WallTime asked) const;
  void show_alarms(const std::vector<Alarm>& alarms);
  std::string json_of_robot(const SeenRobot& robot, const FleetView& view) const;

  struct Unanswered {
    OrderMessage order;
    WallTime given = 0;
    std::optional<WallTime> sent{};  ///< last
  };

  std::function<std::string()> draw_id_;
  WallTime now_ = 0;
  OrderDesk desk_;
  EventBoard board_;
  Rhythm robot_rhythm_{0.25};  // seconds between two looks at the robots
  std::vector<std::string> shown_robots_;
  std::string alarms_;                            ///< as JSON
  std::map<std::string, Unanswered> unanswered_;  ///< by id
};

}  // namespace coppice
