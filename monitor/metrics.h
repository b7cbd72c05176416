// A fleet as Prometheus reads it: text of its exposition format 0.0.4, made anew for each scrape from what is
// seen.
//
// Names and units by Prometheus's conventions: base units, `_total` for what only grows. docs/metrics.md
// lists them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "monitor/fleet_view.h"

namespace coppice {

/// Of the first so many robots there are time series each; of the others the sums tell alone. So a scrape
/// stays small whatever is on the bus.
inline constexpr std::size_t most_robots_in_detail = 500;

/// What the monitor does itself. What is not known is left out.
struct MonitorLoad {
  std::uint64_t messages = 0;               ///< that came off its bus, or out of its recording
  std::optional<std::uint64_t> rejected{};  ///< samples that it dropped as invalid; none: it has no bus
  std::size_t connections = 0;              ///< WebSockets that are open
  std::uint64_t bytes_sent = 0;
  std::optional<double> processor_seconds{};
  std::optional<std::uint64_t> resident_bytes{};
};

std::string metrics_text(const FleetView& view, const MonitorLoad& load, WallTime now);

}  // namespace coppice
