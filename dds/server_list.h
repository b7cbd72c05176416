// Parses a list of discovery servers.
#pragma once

#include <string>
#include <vector>

#include <fastdds/rtps/attributes/ServerAttributes.h>

namespace coppice {

struct ServerList {
  eprosima::fastdds::rtps::RemoteServerList_t found;  ///< each with the identity of its place in the list
  /// Hosts that have no address now, as a container that does not run.
  std::vector<std::string> unknown;
  std::vector<std::string> malformed;  ///< entries that are no server

  bool is_usable() const { return !found.empty() && malformed.empty(); }
};

/// Parses "HOST:PORT" entries, separated by ";". A place may be empty. Looks up the names of hosts, each by
/// itself: Fast DDS would reject the whole list if one host has no address.
ServerList look_up_servers(const std::string& servers);

}  // namespace coppice
