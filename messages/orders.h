// Orders to a fleet, and what became of them.
//
// An order has an id that its sender draws. Sending it again changes nothing, so a sender may repeat an order
// until it hears of its status.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/planning/geometry.h"
#include "messages/run_id.h"

namespace coppice {

/// A place that an order sends a robot to.
struct Visit {
  Point2 position = Point2::Zero();
  bool has_yaw = false;
  double yaw = 0;   ///< radians; if it has one
  double wait = 0;  ///< fleet seconds that the robot stands there
  bool operator==(const Visit&) const = default;
};

enum class Action : std::uint8_t {
  go,       ///< to all visits in turn
  cancel,   ///< the order with the id `cancels`
  pause,    ///< these robots brake and stand until they are resumed
  resume,   ///< ends a pause
  stop,     ///< these robots brake at once and stand until they are released
  release,  ///< ends a stop
};
inline constexpr std::array<std::string_view, 6> action_names{"go",     "cancel", "pause",
                                                              "resume", "stop",   "release"};

/// order: dispatcher -> service. Keyed by its id.
struct OrderMessage {
  std::string id;
  Action action = Action::go;
  /// Go: at most one; none: any robot. Pause, resume, stop, release: none means all.
  std::vector<std::string> robots{};
  std::vector<Visit> visits{};
  std::string cancels{};
  std::int32_t priority = 0;  ///< a higher one is served first
  WallTime deadline = 0;      ///< wall clock; it is reported, and not promised; 0: none
  std::string by{};           ///< the person or program that gave it
  std::string why{};          ///< of a cancellation: its reason, for people; empty: none was given
  bool replaces = false;      ///< go, of one robot: the open orders of that robot are cancelled
  bool operator==(const OrderMessage&) const = default;
};

enum class OrderState : std::uint8_t {
  accepted,   ///< waits for a robot, or for its robot to be free
  assigned,   ///< has a robot, which cannot go to the place yet
  under_way,  ///< its robot drives, or waits at a place
  done,
  cancelled,
  failed,  ///< `reason` tells why
};
inline constexpr std::array<std::string_view, 6> order_state_names{"accepted", "assigned",  "under way",
                                                                   "done",     "cancelled", "failed"};

/// Begins the reason for which an order is refused while the service has no room to save it.
inline constexpr std::string_view cannot_be_saved = "it cannot be saved: ";

constexpr bool is_ended(OrderState state) {
  return state >= OrderState::done;
}

/// order_status: service -> dispatchers, monitors. Keyed by the id of its order. Times are wall clock; 0: not
/// yet.
struct OrderStatus {
  OrderMessage order;
  OrderState state = OrderState::accepted;
  std::string robot{};        ///< that has the order; empty: none yet
  std::string reason{};       ///< why it failed, or what it waits for
  std::uint32_t visited = 0;  ///< places where it was done
  std::uint32_t mission = 0;  ///< of its robot, that serves the next place; 0: none
  WallTime accepted_at = 0;
  WallTime begun_at = 0;  ///< its robot set out
  WallTime ended_at = 0;
  bool operator==(const OrderStatus&) const = default;
};

/// The fleet never took it up. A client may correct it, and give it again.
inline bool is_refused(const OrderStatus& status) {
  return status.state == OrderState::failed && status.begun_at == 0 && status.ended_at == status.accepted_at;
}

/// What an operator has told a robot: to stand. A pause and a stop hold beside each other, and each is ended
/// by its own action.
enum class Halt : std::uint8_t { none, paused, stopped, paused_and_stopped };

constexpr bool is_paused(Halt halt) {
  return halt == Halt::paused || halt == Halt::paused_and_stopped;
}
constexpr bool is_stopped(Halt halt) {
  return halt >= Halt::stopped;
}
constexpr Halt halt_of(bool paused, bool stopped) {
  if (stopped) return paused ? Halt::paused_and_stopped : Halt::stopped;
  return paused ? Halt::paused : Halt::none;
}
/// The stricter one of the two.
constexpr Halt strictest(Halt halt) {
  return is_stopped(halt) ? Halt::stopped : halt;
}

/// halt: service -> agents, monitors. One sample holds for the whole fleet. It outlives the run.
struct HaltMessage {
  std::uint64_t number = 0;  ///< grows with each change
  Halt everybody = Halt::none;
  struct Robot {
    std::string robot;
    Halt halt = Halt::none;
    bool operator==(const Robot&) const = default;
  };
  std::vector<Robot> robots{};  ///< for which `everybody` does not hold
  bool operator==(const HaltMessage&) const = default;
};

/// What a message says to one robot.
inline Halt halt_of(const HaltMessage& message, std::string_view robot) {
  for (const HaltMessage::Robot& own : message.robots) {
    if (own.robot == robot) return own.halt;
  }
  return message.everybody;
}

}  // namespace coppice
