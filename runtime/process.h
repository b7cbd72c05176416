// Common to the mains of all processes: the signals to stop, and the loop that runs a role on a bus.
#pragma once

#include <algorithm>
#include <csignal>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "dds/dds_bus.h"
#include "messages/fleet_clock.h"
#include "runtime/process_clock.h"

namespace coppice {

/// Opens closed standard streams on /dev/null. Otherwise the next file to be opened would get the number of a
/// stream, and the log would be written into it. Call this first.
void fill_standard_streams();

/// SIGINT, SIGTERM and SIGHUP (unless ignored, as by nohup) ask the process to stop. Repeated signals change
/// nothing. SIGPIPE and SIGXFSZ are ignored, because a failed write reports that a reader has gone or that a
/// file has reached its size limit. Call this once, before other threads start. The parent may block these
/// signals until then, so that none is lost.
void install_stop_signals();
sigset_t stop_signals();
bool stop_requested();

/// Lowers this process's priority below that of all others, also of the agents of `coppice run`. For
/// processes that only observe. Call before other threads start.
void give_way();

/// Tells supervisors that the loop of this process runs. Once a second it touches a file (for health checks
/// of containers) and notifies systemd, if that started the process with NOTIFY_SOCKET (Type=notify,
/// WatchdogSec=).
class Heartbeat {
 public:
  /// `file`: empty for none. Throws std::runtime_error if it cannot be written.
  explicit Heartbeat(std::string file);
  void beat(WallTime now);

 private:
  std::string file_;
  WallTime next_ = 0;
};

/// Logs to standard error from the named level on (trace ... off). The lines are plain text or JSON:
/// {"time":"...","level":"...","name":"...","message":"..."}.
void set_up_logging(const std::string& name, const std::string& level, bool as_json = false);

/// Runs a program and returns its exit code. If the program throws, this logs the error, whatever the log
/// level is, and returns 2.
int exit_code_of(const std::function<int()>& program);

/// Seconds. The longest sleep of the loop, so that a signal is noticed soon even if nothing arrives.
inline constexpr double longest_wait = 0.1;

/// What has arrived, with its times by the clock of the process.
inline std::vector<Arrival> take(DdsBus& bus, ProcessClock& clock) {
  std::vector<Arrival> arrivals = bus.take();
  clock.now();  // later than all arrivals
  for (Arrival& arrival : arrivals) {
    arrival.at = clock.time_of(arrival.at);
    if (arrival.sent > 0) arrival.sent = clock.from_system(arrival.sent);
  }
  return arrivals;
}

/// Lets the role step if its wake-up time has come.
template <class R, class K>
void step_role(DdsBus& bus, R& role, K& keeper, ProcessClock& clock) {
  const WallTime now = clock.now();
  if (role.next_wake() > now) return;
  if constexpr (requires { role.note(bus.counts(), now); }) role.note(bus.counts(), now);
  std::vector<Outgoing> all;
  for (auto& said : role.step(now)) {
    all.emplace_back(std::move(said));
    keeper.said(all.back().message);
  }
  if constexpr (requires { keeper.sync(); }) keeper.sync();
  for (const Outgoing& outgoing : all) bus.publish(outgoing);
  if constexpr (requires { keeper.tidy(); }) keeper.tidy();
}

/// One turn of the loop: waits until something arrives or the role must wake up, lets the role take the
/// messages and step, and publishes. `keeper` (messages/keep.h) gets each message before it is published.
template <class R, class K>
void run_role_once(DdsBus& bus, R& role, K& keeper, ProcessClock& clock) {
  bus.wait(std::clamp(role.next_wake() - clock.now(), 0.0, longest_wait));
  for (Arrival& arrival : take(bus, clock)) {
    keeper.heard(*arrival.message);
    role.on(std::move(arrival));
  }
  step_role(bus, role, keeper, clock);
}

}  // namespace coppice
