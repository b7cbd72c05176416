// What a role's runner sees of a bus: publish, take, wait. DdsBus and SimulatedBus::Port both are one.
#pragma once

#include <concepts>
#include <memory>
#include <utility>
#include <vector>

#include "bus/messages.h"

namespace coppice {

/// Who takes part in the bus: decides which topics are written and read (topics.h).
enum class Role : unsigned char { broker, agent, service, observer };

/// A message off the bus. The others that read it may share it.
struct Arrival {
  std::shared_ptr<const Message> message;
  WallTime at = 0;  ///< when it arrived, not when it was taken
};

inline Arrival arrival_of(Message message, WallTime at) {
  return {std::make_shared<const Message>(std::move(message)), at};
}

template <class B>
concept Bus = requires(B bus, const Message& message, double seconds) {
  /// Hands a message to the bus; never blocks on a reader.
  bus.publish(message);
  /// All that arrived since the last call, checked (validation.h), in order for each sender and topic.
  { bus.take() } -> std::same_as<std::vector<Arrival>>;
};

}  // namespace coppice
