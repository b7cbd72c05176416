// The name of a run, and the check whether a message belongs to it. Agents, brokers and recordings outlive
// runs, and late readers receive what was said last in an earlier run. So each message that means something
// in one run alone names that run in a field `run`, and each reader checks it here.
#pragma once

#include <compare>

namespace coppice {

/// Seconds of the machine's clock since the Unix epoch; in the simulation, of the virtual clock since its
/// start.
using WallTime = double;

/// A run is named by the time at which it began.
struct RunId {
  WallTime epoch = 0;  ///< 0: no run

  explicit operator bool() const { return epoch != 0; }
  auto operator<=>(const RunId&) const = default;
};

/// Readers that take part in `run` drop messages of all other runs.
template <class M>
bool is_of_run(const M& message, const RunId& run) {
  return message.run == run;
}

/// Readers that only observe drop messages of earlier runs alone: they may hear of a run before they see its
/// missions. Older recordings name no run.
template <class M>
bool is_of_earlier_run(const M& message, const RunId& run) {
  return message.run && message.run < run;
}

}  // namespace coppice
