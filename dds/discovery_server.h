// A Fast DDS discovery server: knows all participants and endpoints, and tells each only of those that it can
// match. It takes part in nothing else, and any one that speaks the protocol will do in its place (fastdds
// discovery, of Debian's fastdds-tools).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace coppice {

/// Who knew a server that was killed takes the next one at its address to be the same, and ignores what that
/// says anew: agents that are started in the meantime would never be heard of. For so many
/// seconds after its last word it is remembered.
inline constexpr double server_lease = 5;
/// It, and who knows it, say at least so often that they are there, seconds.
inline constexpr double between_words = 1;

/// A UDP port on which nobody listens yet, at all addresses of this host.
class PortWatch {
 public:
  explicit PortWatch(std::uint16_t port);
  ~PortWatch();
  PortWatch(const PortWatch&) = delete;
  PortWatch& operator=(const PortWatch&) = delete;
  /// Since it was asked last, or began. Never blocks.
  bool heard_rtps();

 private:
  int socket_;
};

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
