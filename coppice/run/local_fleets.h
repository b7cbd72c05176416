// Finds the fleets on this machine by the UDP ports that DDS gives to a domain (DDS-RTPS 2.2, 9.6.1.1). So
// fleets are found however they were started, and fleets that have ended are not. Processes in other network
// namespaces, as in containers, are not found.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dds/dds_bus.h"

namespace coppice {

/// A process of this machine that this user may inspect.
struct LocalProcess {
  std::vector<std::string> arguments;  ///< with the program's name
  std::set<std::uint64_t> sockets;     ///< as the kernel numbers them
  std::string servers{};               ///< ROS_DISCOVERY_SERVER of its environment; empty: none
};

struct LocalFleet {
  int domain = 0;
  int agents = 0;
  int others = 0;  ///< further roles, and replays
  /// Its processes can be inspected. Else they are another user's, and may be other DDS programs.
  bool is_seen = false;
  bool is_secured = false;  ///< uses --security
  std::string discovery{};  ///< the --discovery of its processes
};

/// The fleets by domain. `sockets`: the content of /proc/net/udp. Processes that only observe are no fleet.
std::vector<LocalFleet> fleets_among(std::string_view sockets, std::span<const LocalProcess> processes);

/// "domain 7: 8 robot agents, 2 other roles".
std::string in_words(const LocalFleet& fleet);

/// Chooses the fleet to observe if no domain was named: the fleet that is alive on this machine. Fills in
/// what `network` lacks. `command`: the command for messages, as "coppice top". Returns a line for the user.
/// Throws InputError, which lists the commands to choose from, if there are several fleets.
std::string choose_fleet(DdsSettings& network, std::span<const LocalFleet> fleets,
                         const std::string& command);

/// The fleets of this machine.
std::vector<LocalFleet> local_fleets();

/// The words as they are typed in a shell.
std::string shell_words(std::span<const std::string> words);

}  // namespace coppice
