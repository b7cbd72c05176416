// The interface of a bus to the loop that runs a role. DdsBus and SimulatedBus::Port implement it.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "messages/messages.h"

namespace coppice {

/// The role of a participant. It decides which topics the participant writes and reads (topics.h). A claimant
/// is an agent that does not know yet which robot it has. A replayer sends recorded messages to observers and
/// viewers. An observer receives all messages. A viewer receives those that show the present: no tracks, for
/// a viewer that joins late would receive all of them. A dispatcher is a viewer that gives orders.
enum class Role : unsigned char { broker, agent, service, observer, claimant, replayer, viewer, dispatcher };

/// A received message. Other readers may share it.
struct Arrival {
  std::shared_ptr<const Message> message;
  WallTime at = 0;  ///< when it arrived, not when it was taken
  /// When it was sent, by the clock of its sender. A late reader receives some messages long after that. 0:
  /// not known.
  WallTime sent = 0;
};

inline Arrival arrival_of(Message message, WallTime at, WallTime sent = 0) {
  return {std::make_shared<const Message>(std::move(message)), at, sent};
}

/// A message and the agents that receive it. Readers of other roles receive every message.
struct Outgoing {
  template <class M>
  // NOLINTNEXTLINE(google-explicit-constructor)
  requires std::constructible_from<Message, M> Outgoing(M what) : message(std::move(what)) {}
  Outgoing(Message what, std::vector<RobotName> to) : message(std::move(what)), agents(std::move(to)) {}

  Message message;
  std::optional<std::vector<RobotName>> agents{};  ///< none: all of them
};

/// The counters of a bus since it was opened.
struct BusCounts {
  std::size_t rejected = 0;  ///< samples that failed validation
  std::size_t agents = 0;    ///< readers of robot states that are matched, of others
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
  double processor_seconds = 0;  ///< of the process, since it began
};

template <class B>
concept Bus = requires(B bus, const Outgoing& message, double seconds) {
  /// Hands a message to the bus; never blocks on a reader.
  bus.publish(message);
  /// All that arrived since the last call, checked (validation.h), in order for each sender and topic.
  { bus.take() } -> std::same_as<std::vector<Arrival>>;
};

}  // namespace coppice
