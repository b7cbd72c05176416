// A fleet in Prometheus's text format 0.0.4, made anew for each scrape from the view.
//
// Names and units follow Prometheus's conventions: base units, and `_total` for counters. docs/metrics.md
// lists them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "monitor/view/alarms.h"
#include "monitor/view/fleet_view.h"

namespace coppice {

/// Only the first robots, this many, have their own time series; the other ones count only in the sums. So a
/// scrape stays small, whatever is on the bus.
inline constexpr std::size_t most_robots_in_detail = 500;

/// The monitor's own load.
struct MonitorLoad {
  bool has_bus = true;          ///< false: it shows a recording, of which nothing can be rejected
  std::uint64_t messages = 0;   ///< received from its bus or its recording
  std::uint64_t rejected = 0;   ///< samples that were dropped as invalid
  std::size_t connections = 0;  ///< open WebSockets and event streams
  std::uint64_t bytes_sent = 0;
  std::uint64_t refused_logins = 0;  ///< requests to the API with a wrong token
  double processor_seconds = 0;
  std::uint64_t resident_bytes = 0;
};

std::string metrics_text(const FleetView& view, const MonitorLoad& load, WallTime now,
                         const AlarmBoard& alarms = AlarmBoard());

}  // namespace coppice
