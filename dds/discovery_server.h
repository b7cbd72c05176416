// A Fast DDS discovery server: it knows all participants and endpoints, and tells each participant only of
// those that it can match. It does nothing else. Any other server that speaks the protocol can replace it
// (`fastdds discovery`, of Debian's package fastdds-tools).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace coppice {

/// Seconds for which clients remember a server after its last message. A client that remembers a killed
/// server takes the next server at the same address for the same one and ignores its first messages. The
/// client would then never hear of agents that started in the meantime.
inline constexpr double server_lease = 5;
/// Seconds. The server and its clients announce themselves at least this often.
inline constexpr double between_words = 1;

/// Watches a UDP port that no other process uses yet, on all addresses of this host.
class PortWatch {
 public:
  explicit PortWatch(std::uint16_t port);
  ~PortWatch();
  PortWatch(const PortWatch&) = delete;
  PortWatch& operator=(const PortWatch&) = delete;
  /// True if an RTPS message arrived since the last call or the construction. Never blocks.
  bool heard_rtps();

 private:
  int socket_;
};

class DdsDiscoveryServer {
 public:
  /// Serves during its lifetime, at an IPv4 address of this host and a UDP port. `place`: the server's
  /// position in the list of servers that the participants are given, from 0. Throws std::runtime_error if
  /// DDS refuses.
  DdsDiscoveryServer(const std::string& address, std::uint16_t port, int place);
  ~DdsDiscoveryServer();
  DdsDiscoveryServer(const DdsDiscoveryServer&) = delete;
  DdsDiscoveryServer& operator=(const DdsDiscoveryServer&) = delete;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
