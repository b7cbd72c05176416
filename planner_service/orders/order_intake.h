// Tells whether an order is meant for this fleet, or was given to one before it.
//
// A writer keeps its last orders for readers that come later. So a new fleet hears of orders that an earlier
// one has done, has cancelled, or never heard of. If its own state does not know such an order, it cannot
// tell which it is. It does not carry it out. A sender that still waits for an answer repeats its order, and
// the order is new then. All others are refused, so that none is lost without a word.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

class OrderIntake {
 public:
  /// Seconds that an order from before the fleet waits to be repeated. Senders repeat it every second.
  static constexpr WallTime patience = 3;

  /// `since`: when the fleet began.
  explicit OrderIntake(WallTime since) : since_(since) {}

  /// The fleet began earlier than that: a service before this one began it. What seems to lie ahead was dated
  /// by a clock that was wrong before this host was started anew, and does not count.
  void fleet_began(WallTime since) { since_ = std::min(since_, since); }

  /// True if the order is for this fleet. Otherwise it is held back. `at`: when it arrived. `sent`: by the
  /// sender's clock; 0: not known, and it is for this fleet.
  bool takes(const OrderMessage& order, WallTime at, WallTime sent);
  /// Orders that nobody has repeated, each once.
  std::vector<OrderMessage> take_outdated(WallTime now);

 private:
  struct Held {
    OrderMessage order;
    WallTime at = 0;
  };

  WallTime since_;
  std::map<std::string, Held> held_;
};

}  // namespace coppice
