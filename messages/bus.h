// What a role's runner sees of a bus: publish, take, wait. DdsBus and SimulatedBus::Port both are one.
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

/// Who takes part in the bus: decides which topics are written and read (topics.h).
/// A claimant is an agent that does not know yet which robot it is. A replayer says again what was recorded
/// of others, to observers and viewers.
/// An observer hears all that is said; a viewer only what shows the present (no tracks: whoever comes late
/// would be told all of them).
enum class Role : unsigned char { broker, agent, service, observer, claimant, replayer, viewer };

/// A message off the bus. The others that read it may share it.
struct Arrival {
  std::shared_ptr<const Message> message;
  WallTime at = 0;  ///< when it arrived, not when it was taken
};

inline Arrival arrival_of(Message message, WallTime at) {
  return {std::make_shared<const Message>(std::move(message)), at};
}

/// A message and who of the agents is to have it. Readers of other roles have whatever they read.
struct Outgoing {
  template <class M>
  // NOLINTNEXTLINE(google-explicit-constructor)
  requires std::constructible_from<Message, M> Outgoing(M what) : message(std::move(what)) {}
  Outgoing(Message what, std::vector<RobotName> to) : message(std::move(what)), agents(std::move(to)) {}

  Message message;
  std::optional<std::vector<RobotName>> agents{};  ///< none: all of them
};

/// What a bus has counted since it was opened.
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
