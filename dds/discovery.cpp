#include "dds/discovery.h"

#include <charconv>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

namespace coppice {

bool are_servers(const std::string& discovery) {
  return !discovery.empty() && discovery != multicast_discovery && discovery != static_discovery;
}

std::string usual_discovery_servers() {
  const char* const servers = std::getenv("ROS_DISCOVERY_SERVER");
  return servers == nullptr ? "" : servers;
}

int usual_ros_domain() {
  const char* const value = std::getenv("ROS_DOMAIN_ID");
  const std::string_view text = value == nullptr ? "" : value;
  if (text.empty()) return 0;
  int domain = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (error != std::errc() || end != text.data() + text.size() || domain < 0 || domain > 232)
    throw std::runtime_error("ROS_DOMAIN_ID is \"" + std::string(text) + "\", expected 0 to 232");
  return domain;
}

}  // namespace coppice
