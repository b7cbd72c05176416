// What a service hears before it begins its run: of the statuses, which come twice a second, the last of each
// agent.
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
  /// Agents that say to have found so many others.
  std::size_t is_synchronised(std::size_t others) const {
    return static_cast<std::size_t>(std::ranges::count_if(statuses_, [&](const auto& entry) {
      return std::get<AgentStatus>(*entry.second.message).load.agents_matched >= others;
    }));
  }
  /// Calls fn(arrival) for each that counts.
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
