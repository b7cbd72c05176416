// What the processes' mains share: the wall's clock, the wish to stop, and the loop that runs a role on a
// bus.
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <utility>

#include "dds/dds_bus.h"
#include "messages/fleet_clock.h"

namespace coppice {

inline WallTime wall_now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Of the standard streams those that are closed lead nowhere from now on: a file that got the number of one
/// would get what is logged. Call first.
void fill_standard_streams();

/// SIGINT, SIGTERM and SIGHUP (unless that is ignored, as by nohup) ask a process to stop; asking again does
/// no more than that. Who reads its output may go, and a file may be as long as it may become: SIGPIPE and
/// SIGXFSZ are ignored, for writing tells. Call once, before other threads. Who starts the process may block
/// these signals until then, so that none is lost.
void install_stop_signals();
sigset_t stop_signals();
bool stop_requested();

/// Lets everybody else on this machine go first, the agents of `coppice run` too: for those who look on. Call
/// before other threads.
void give_way();

/// Shows whoever watches this process that its loop turns: once a second it touches a file (health checks of
/// containers) and tells systemd, if that has started it with NOTIFY_SOCKET (Type=notify, WatchdogSec=).
class Heartbeat {
 public:
  /// `file`: empty for none. Throws std::runtime_error if it cannot be written.
  explicit Heartbeat(std::string file);
  void beat(WallTime now);

 private:
  std::string file_;
  WallTime next_ = 0;
};

/// Logs to standard error at the level that is named (trace ... off). As lines of text, or of JSON:
/// {"time":"...","level":"...","name":"...","message":"..."}.
void set_up_logging(const std::string& name, const std::string& level, bool as_json = false);

/// Runs a program and returns its exit code: 2 if it throws, which is then the last line of its log, whatever
/// the level of that.
int exit_code_of(const std::function<int()>& program);

/// Longest sleep of the loop, so that a signal is seen soon even where nothing arrives, seconds.
inline constexpr double longest_wait = 0.1;

/// Seconds; no role that has something to do sleeps longer. A wake that is further off was chosen before the
/// clock was set back.
inline constexpr double longest_sleep_of_role = 2;

/// Lets a role step if it has something to do.
template <class R, class K>
void step_role(DdsBus& bus, R& role, K& keeper) {
  const WallTime now = wall_now();
  if (role.next_wake() > now && role.next_wake() <= now + longest_sleep_of_role) return;
  if constexpr (requires { role.note(bus.counts(), now); }) role.note(bus.counts(), now);
  for (auto& said : role.step(now)) {
    const Outgoing outgoing(std::move(said));
    keeper.said(outgoing.message);
    bus.publish(outgoing);
  }
}

/// One turn: wait until something arrives or the role has something to do; let it take and step; publish.
/// `keeper` (keep.h) has what is said before anybody else.
template <class R, class K>
void run_role_once(DdsBus& bus, R& role, K& keeper) {
  bus.wait(std::clamp(role.next_wake() - wall_now(), 0.0, longest_wait));
  for (Arrival& arrival : bus.take()) {
    keeper.heard(*arrival.message);
    role.on(std::move(arrival));
  }
  step_role(bus, role, keeper);
}

}  // namespace coppice
