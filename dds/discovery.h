// How the processes of a fleet find each other: the ways that can be asked for, and the ports.
#pragma once

#include <string>
#include <vector>

namespace coppice {

inline constexpr const char* multicast_discovery = "multicast";
/// By multicast, and each announces just which of the endpoints in the table of topics it has: for large
/// fleets. Who is set up otherwise, or knows no table, is not found.
inline constexpr const char* static_discovery = "static";
/// From so many robots on the latter suits, and the usual buffers of sockets do not.
inline constexpr int large_fleet = 40;

/// What may be asked for, for people.
inline constexpr const char* discovery_rule = "multicast, static or HOST:PORT, several with ; between them";
/// Whether servers are: it is neither empty nor one of the ways above.
bool are_servers(const std::string& discovery);

/// What has been found of them (dds_bus.h).
struct ServerExamination {
  bool are_usable = false;             ///< one has an address at least, and all that is named may be one
  std::vector<std::string> unknown{};  ///< those that have none
};

/// The servers of ROS_DISCOVERY_SERVER; empty if it names none.
std::string usual_discovery_servers();

/// The domain of ROS_DOMAIN_ID; 0 if it is not set. Throws std::runtime_error if it is none.
int usual_ros_domain();

/// So many participants of a domain try for ports on one host, less where the numbers end; by default Fast
/// DDS gives up after a hundred.
inline constexpr int most_participants = 1000;
/// DDS-RTPS 2.2, 9.6.1.1: the domain's multicast port, and the first of a participant's pair.
constexpr int domain_port(int domain) {
  return 7400 + 250 * domain;
}
constexpr int participant_port(int domain, int participant) {
  return domain_port(domain) + 10 + 2 * participant;
}

}  // namespace coppice
