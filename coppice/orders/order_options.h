// The commands that give orders to a fleet, and show what became of them.
#pragma once

#include <optional>
#include <vector>

#include "coppice/commands.h"
#include "dds/dds_bus.h"
#include "messages/messages.h"

namespace CLI {
class App;
}

namespace coppice {

struct OrderOptions {
  DdsSettings network;
  OrderMessage order;                ///< without an id
  bool any = false;                  ///< no robot is named
  bool each = false;                 ///< each place is an order of its own
  std::optional<double> deadline{};  ///< seconds from now
  double stay = 0;                   ///< fleet seconds at each place
  bool wait = false;                 ///< until the orders have ended
  double patience = 10;              ///< seconds until the fleet has to answer
  bool as_json = false;
  bool all = false;  ///< lists ended orders, too
};

/// Gives the order. Returns 1 if it is refused or fails, or nobody answers.
int give_order_command(const OrderOptions& options);

/// Lists the orders of a fleet. Returns 1 if nobody takes orders.
int orders_command(const OrderOptions& options);

/// Parsing fills in `options` and `chosen`, which must outlive it.
void add_order_commands(CLI::App& app, OrderOptions& options, ChosenCommand& chosen);

}  // namespace coppice
