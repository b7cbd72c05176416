#include "bus/discovery.h"

#include <cstdlib>

namespace coppice {

std::string usual_discovery_servers() {
  const char* const servers = std::getenv("ROS_DISCOVERY_SERVER");
  return servers == nullptr ? "" : servers;
}

}  // namespace coppice
