// A fleet has one service: two services on one DDS domain would halt each other's robots. Each service
// publishes its identity and the run that it has begun. A service that hears of another one with precedence
// ends, and the other one goes on.
//
// The newer run has precedence, for agents follow it. So a paused service that was replaced ends when it
// wakes. Of services without a run, the one that started first has precedence. A service begins no run before
// it has listened for one second, or for five seconds where agents drive for a run that it does not know:
// their service may still exist. A service that was killed publishes nothing, and its place is free.
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

/// "process 123 on host c3 (its run began 12 s ago)"
std::string description_of(const ServiceStatus& service, WallTime now);

class SoleService {
 public:
  SoleService(ServiceStatus self, WallTime now) : self_(std::move(self)), listens_since_(now) {}

  void on(const Arrival& arrival);
  /// This service has published the missions of that run.
  void begin(RunId run);
  /// Tells everybody of a problem of this service; empty: it has none.
  void tell(std::string problem);
  std::vector<Message> step(WallTime now);
  WallTime next_wake() const { return next_wake_; }

  /// It has listened for long enough to begin a run.
  bool may_begin(WallTime now) const;
  /// The service that has precedence over this one and all others, if it is not this one.
  std::optional<ServiceStatus> superior() const;
  /// The services that came since the last call and must end, because this one has precedence.
  std::vector<ServiceStatus> take_inferiors();

 private:
  void receive(const ServiceStatus& other, WallTime now);
  void receive(const AgentStatus& status, WallTime now);

  ServiceStatus self_;
  WallTime listens_since_;
  bool agents_have_another_run_ = false;
  std::map<std::uint64_t, ServiceStatus> others_;
  std::vector<ServiceStatus> inferiors_;  ///< that take_inferiors() has not returned
  WallTime next_wake_ = 0;
};

}  // namespace coppice
