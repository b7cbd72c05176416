// The discovery servers that a list names.
#pragma once

#include <string>
#include <vector>

#include <fastdds/rtps/attributes/ServerAttributes.h>

namespace coppice {

struct ServerList {
  eprosima::fastdds::rtps::RemoteServerList_t found;  ///< each with the identity of its place in the list
  std::vector<std::string>
      unknown;  ///< hosts that have no address, now: a container that does not run has none
  std::vector<std::string> malformed;  ///< what is no server

  bool is_usable() const { return !found.empty() && malformed.empty(); }
};

/// "HOST:PORT", several with ";" between them; a place may be empty. Asks the network where hosts are named.
/// Each is looked up by itself: Fast DDS takes none where one has no address.
ServerList look_up_servers(const std::string& servers);

}  // namespace coppice
