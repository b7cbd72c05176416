#include "monitor/recording/replay_clock.h"

#include <variant>

namespace coppice {

namespace {

void shift(Mission& mission, const ReplayClock& clock) {
  mission.clock = {clock.present(mission.clock.epoch), mission.clock.scale * clock.speed};
}
void shift(AgentStatus& status, const ReplayClock& clock) {
  if (status.load.matched_at != 0) status.load.matched_at = clock.present(status.load.matched_at);
  status.load.processor_seconds /= clock.speed;
}
void shift(BrokerStatus& status, const ReplayClock& clock) {
  if (status.leading_since != 0) status.leading_since = clock.present(status.leading_since);
  status.processor_seconds /= clock.speed;
}

}  // namespace

Message at_present(Message message, const ReplayClock& clock) {
  std::visit(
      [&](auto& m) {
        if constexpr (requires { m.run; }) m.run.epoch = m.run ? clock.present(m.run.epoch) : 0;
        if constexpr (requires { shift(m, clock); }) shift(m, clock);
      },
      message);
  return message;
}

}  // namespace coppice
