#include <chrono>
#include <thread>

#include <spdlog/spdlog.h>

#include "coppice/commands.h"
#include "dds/discovery_server.h"
#include "runtime/process.h"

namespace coppice {

namespace {

constexpr std::chrono::milliseconds port_poll_period{100};
constexpr double late = 0.5;  // seconds by which an announcement may be late

/// Clients that still remember a killed server must forget it before this one starts.
void wait_until_forgotten(const DiscoveryOptions& options) {
  PortWatch port(options.port);
  const auto begin = std::chrono::steady_clock::now();
  const auto waited = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  bool remembered = false;
  while (!stop_requested() && waited() < (remembered ? server_lease : between_words) + late) {
    std::this_thread::sleep_for(port_poll_period);
    if (!remembered && port.heard_rtps()) {
      remembered = true;
      spdlog::info("waiting until all clients have forgotten the previous server");
    }
  }
}

}  // namespace

int discovery_command(const DiscoveryOptions& options) {
  install_stop_signals();
  wait_until_forgotten(options);
  if (stop_requested()) return 0;
  const DdsDiscoveryServer server(options.address, options.port, options.place);
  spdlog::info("discovery server {} at {}:{}", options.place, options.address, options.port);
  Heartbeat heart(options.alive);
  ProcessClock clock;
  while (!stop_requested()) {
    std::this_thread::sleep_for(port_poll_period);
    heart.beat(clock.now());
  }
  return 0;
}

}  // namespace coppice
