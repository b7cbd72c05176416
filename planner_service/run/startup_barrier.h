// Holds the messages that a service hears before it begins its run. Of the statuses, which come twice a
// second, it holds the last of each agent.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

class StartupBarrier {
 public:
  void add(Arrival arrival) {
    if (const auto* status = std::get_if<AgentStatus>(arrival.message.get())) {
      statuses_.insert_or_assign(status->robot, std::move(arrival));
    } else {
      others_.push_back(std::move(arrival));
    }
  }
  /// The number of agents that have discovered `peers` other agents or more.
  std::size_t agents_that_discovered(std::size_t peers) const {
    return static_cast<std::size_t>(std::ranges::count_if(statuses_, [&](const auto& entry) {
      return std::get<AgentStatus>(*entry.second.message).load.agents_matched >= peers;
    }));
  }
  /// Calls fn(arrival) for each message that it holds.
  template <class Fn>
  void for_each(Fn&& fn) const {
    for (const Arrival& arrival : others_) fn(arrival);
    for (const auto& [robot, arrival] : statuses_) fn(arrival);
  }

 private:
  std::vector<Arrival> others_;
  std::map<RobotName, Arrival> statuses_;
};

}  // namespace coppice
