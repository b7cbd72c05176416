#include <algorithm>
#include <iostream>
#include <stdexcept>

#include <fmt/format.h>

#include "coppice/commands.h"
#include "coppice/files/input_error.h"
#include "dds/dds_bus.h"
#include "messages/topics.h"
#include "messages/validation.h"
#include "monitor/recording/recording.h"
#include "monitor/recording/replay_clock.h"
#include "runtime/process.h"

namespace coppice {

namespace {

// Seconds in which a running fleet is heard and observers are discovered.
constexpr WallTime time_to_meet = 3;

/// At another speed, the fleet's clock may become invalid for receivers.
void check_clocks(const Recording& recording, const ReplayClock& clock) {
  Topics missions;
  missions.set(topic_number<Mission>());
  Playback playback(recording, recording.begin(), missions);
  while (const auto next = playback.next()) {
    if (const auto problem = problem_with(at_present(*next->message, clock)))
      throw InputError(fmt::format("--speed {}: makes a mission invalid: {}", clock.speed, *problem));
  }
}

/// Expects that nothing has arrived: messages of a live fleet and of a recording must not mix.
void expect_alone(DdsBus& bus, int domain) {
  const auto heard = bus.take();
  if (heard.empty()) return;
  const std::string_view topic =
      std::visit([]<class M>(const M&) { return Topic<M>::info.name; }, *heard.front().message);
  throw std::runtime_error(fmt::format(
      "domain {}: a fleet or another replay is active ({} was received); expected an unused domain", domain,
      topic));
}

/// False if the process must stop.
bool wait_alone(DdsBus& bus, ProcessClock& clock, int domain, WallTime until) {
  for (WallTime now = clock.now(); now < until && !stop_requested(); now = clock.now()) {
    bus.wait(std::min(longest_wait, until - now));
    expect_alone(bus, domain);
  }
  return !stop_requested();
}

}  // namespace

int replay_command(const ReplayOptions& options) {
  const Recording recording(options.file);
  const double duration = recording.end() - recording.begin();
  if (options.from > duration)
    throw InputError(fmt::format("--from {}: {} lasts {:.1f} s", options.from, options.file, duration));
  const WallTime begin = recording.begin() + options.from;
  ProcessClock clock;
  check_clocks(recording, {begin, clock.now(), options.speed});
  if (!recording.file().ending().empty())
    std::cerr << options.file << ": " << recording.file().ending() << '\n';

  install_stop_signals();
  const int domain = options.network.domain;
  DdsBus bus(options.network, Role::replayer, "replay");
  if (!wait_alone(bus, clock, domain, clock.now() + time_to_meet)) return 0;
  const ReplayClock replay{begin, clock.now(), options.speed};
  Playback playback(recording, begin);
  std::uint64_t said = 0;
  while (const auto next = playback.next()) {
    if (!wait_alone(bus, clock, domain, replay.present(next->at))) break;
    bus.publish(at_present(*next->message, replay));
    ++said;
  }
  std::cout << fmt::format("replayed {} messages in {:.1f} s, {} left out as invalid, {} lost\n", said,
                           clock.now() - replay.start, playback.rejected(), bus.lost());
  return 0;
}

}  // namespace coppice
