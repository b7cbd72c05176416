// How the processes of a fleet find each other: the ways to choose from, and the ports.
#pragma once

#include <string>
#include <vector>

namespace coppice {

inline constexpr const char* multicast_discovery = "multicast";
/// For large fleets. Processes find each other by multicast, and each announces only which endpoints of the
/// table of topics it has. Processes that use another way are not found.
inline constexpr const char* static_discovery = "static";
/// From this number of robots on, static discovery is better, and the usual buffers of sockets are too small.
inline constexpr int large_fleet = 40;

/// The choices, as text for messages.
inline constexpr const char* discovery_rule = "multicast, static or HOST:PORT (several separated by ;)";
/// True if `discovery` names servers: it is neither empty nor one of the ways above.
bool are_servers(const std::string& discovery);

/// The result of examining discovery servers (dds/dds_bus.h).
struct ServerExamination {
  bool are_usable = false;             ///< at least one has an address, and all entries are well-formed
  std::vector<std::string> unknown{};  ///< hosts without an address
};

/// The servers of ROS_DISCOVERY_SERVER; empty if it names none.
std::string usual_discovery_servers();

/// The domain of ROS_DOMAIN_ID; 0 if it is not set. Throws std::runtime_error if it is not 0 to 232.
int usual_ros_domain();

/// The most participants of a domain on one host that try for ports; fewer where the port numbers end. Fast
/// DDS's default is 100.
inline constexpr int most_participants = 1000;
/// DDS-RTPS 2.2, 9.6.1.1: the domain's multicast port, and the first of a participant's two ports.
constexpr int domain_port(int domain) {
  return 7400 + 250 * domain;
}
constexpr int participant_port(int domain, int participant) {
  return domain_port(domain) + 10 + 2 * participant;
}

}  // namespace coppice
