// Which fleets are alive on this machine: by the UDP ports that DDS gives to a domain
// (DDS-RTPS 2.2, 9.6.1.1). So fleets are found however they were started, and none is that has ended.
// Processes of other network namespaces, as of containers, are not seen.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dds/dds_bus.h"

namespace coppice {

/// A process of this machine that may be looked into.
struct LocalProcess {
  std::vector<std::string> arguments;  ///< with the program's name
  std::set<std::uint64_t> sockets;     ///< as the kernel numbers them
};

struct LocalFleet {
  int domain = 0;
  int agents = 0;
  int others = 0;  ///< further roles, and replays
  bool is_seen =
      false;  ///< its processes can be looked into; else these are another user's, and may be other DDS
  bool is_secured = false;  ///< by --security
  std::string discovery{};  ///< as its processes were told
};

/// By domain. `sockets`: what /proc/net/udp says. Who only looks on is no fleet.
std::vector<LocalFleet> fleets_among(std::string_view sockets, std::span<const LocalProcess> processes);

/// "domain 7: 8 robot agents, 2 other roles".
std::string in_words(const LocalFleet& fleet);

/// Where to look on if no domain was named: at the fleet that is alive on this machine, of which `network`
/// gets what it lacks. `command`: "coppice top", for what is told. Returns a line for the user. Throws
/// InputError, which lists the commands to choose from, if there are several.
std::string choose_fleet(DdsSettings& network, std::span<const LocalFleet> fleets,
                         const std::string& command);

/// Those of this machine.
std::vector<LocalFleet> local_fleets();

/// Words as one types them in a shell.
std::string shell_words(std::span<const std::string> words);

}  // namespace coppice
