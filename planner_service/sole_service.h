// A fleet has one service: two on one DDS domain would halt each other's robots. Each says who it is and
// which run it has begun; the one that hears of another with more right to the fleet refuses, and the other
// goes on.
//
// The right is that of the newer run, for agents follow that; before any run, of the service that was started
// first; so a paused service that another one has replaced gives up, too. A service begins no run before it
// has listened for a second, and for five where agents drive for a run that it does not know: theirs may
// still be there. One that was killed says nothing, and its place is free.
//
// A state machine, beside the planner service: messages and the time go in, messages come out.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

/// "process 123 on host c3 (run begun 12.3 s ago)"
std::string description_of(const ServiceStatus& service, WallTime now);

class SoleService {
 public:
  SoleService(ServiceStatus self, WallTime now) : self_(std::move(self)), listens_from_(now) {}

  void on(const Arrival& arrival);
  /// The run whose missions this service has handed out.
  void begin(WallTime run);
  std::vector<Message> step(WallTime now);
  WallTime next_wake() const { return next_wake_; }

  /// It has listened for long enough to begin.
  bool may_begin(WallTime now) const;
  /// One that has more right to the fleet, if there is one.
  std::optional<ServiceStatus> superior() const;
  /// Others that have come since the last call, and have less: they are to refuse.
  std::vector<ServiceStatus> take_inferiors();

 private:
  void receive(const ServiceStatus& other, WallTime now);
  void receive(const AgentStatus& status, WallTime now);

  ServiceStatus self_;
  WallTime listens_from_;
  bool agents_have_another_run_ = false;
  std::map<std::uint64_t, ServiceStatus> others_;  ///< that were heard of
  std::vector<ServiceStatus> inferiors_;           ///< not told yet
  WallTime next_wake_ = 0;
};

}  // namespace coppice
