#include <chrono>
#include <thread>

#include <spdlog/spdlog.h>

#include "bus/dds_discovery_server.h"
#include "bus/process.h"
#include "coppice/commands.h"

namespace coppice {

namespace {

constexpr std::chrono::milliseconds poll_period{100};

}  // namespace

int discovery_command(const DiscoveryOptions& options) {
  install_stop_signals();
  const DdsDiscoveryServer server(options.address, options.port, options.place);
  spdlog::info("discovery server {} at {}:{}", options.place, options.address, options.port);
  Heartbeat heart(options.alive);
  while (!stop_requested()) {
    std::this_thread::sleep_for(poll_period);
    heart.beat(wall_now());
  }
  return 0;
}

}  // namespace coppice
