// A fleet as Prometheus reads it: text of its exposition format 0.0.4, made anew for each scrape from what is
// seen.
//
// Names and units by Prometheus's conventions: base units, `_total` for what only grows. docs/metrics.md
// lists them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "monitor/fleet_view.h"

namespace coppice {

/// Of the first so many robots there are time series each; of the others the sums tell alone. So a scrape
/// stays small whatever is on the bus.
inline constexpr std::size_t most_robots_in_detail = 500;

/// What the monitor does itself.
struct MonitorLoad {
  bool has_bus = true;          ///< else it shows a recording: nothing was rejected, or could have been
  std::uint64_t messages = 0;   ///< that came off its bus, or out of its recording
  std::uint64_t rejected = 0;   ///< samples that it dropped as invalid
  std::size_t connections = 0;  ///< WebSockets that are open
  std::uint64_t bytes_sent = 0;
  double processor_seconds = 0;
  std::uint64_t resident_bytes = 0;
};

std::string metrics_text(const FleetView& view, const MonitorLoad& load, WallTime now);

}  // namespace coppice
