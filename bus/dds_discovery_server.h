// A Fast DDS discovery server: knows all participants and endpoints, and tells each only of those that it can
// match. It takes part in nothing else, and any one that speaks the protocol will do in its place (fastdds
// discovery, of Debian's fastdds-tools).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace coppice {

class DdsDiscoveryServer {
 public:
  /// Listens for as long as it lives, at an IPv4 address of this host and a UDP port. `place`: in the list of
  /// servers that the participants are given, 0 for the first. Throws std::runtime_error if DDS refuses.
  DdsDiscoveryServer(const std::string& address, std::uint16_t port, int place);
  ~DdsDiscoveryServer();
  DdsDiscoveryServer(const DdsDiscoveryServer&) = delete;
  DdsDiscoveryServer& operator=(const DdsDiscoveryServer&) = delete;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
