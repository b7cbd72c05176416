// The networks of this host, and what becomes of announcements when they change.
//
// Fast DDS 2.9 looks at the networks once, when a participant begins. It announces itself through the
// addresses of then, and the kernel ends its membership in the multicast group when an interface loses its
// last address. So once the networks have changed, a socket of this class joins the group and sends
// announcements on each network that there is now.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include <netinet/in.h>

namespace coppice {

struct OwnNetwork {
  int interface = 0;  ///< index, of the kernel
  in_addr address{};
};

/// Several threads may use it at a time.
class OwnNetworks {
 public:
  OwnNetworks();
  ~OwnNetworks();
  OwnNetworks(const OwnNetworks&) = delete;
  OwnNetworks& operator=(const OwnNetworks&) = delete;

  /// Whether a datagram from there comes from this host: from its loopback or one of its addresses.
  bool is_own(in_addr address);

  /// The networks on which DDS does not announce this process: all that carry multicast, once they have
  /// changed since the beginning. Then this process is a member of the group there.
  std::vector<OwnNetwork> networks_of_group(in_addr group);
  /// Sends a datagram to the group on one of them. A network may be gone by now, and the next announcement is
  /// due anyway, so errors are not reported.
  void send(std::span<const std::uint8_t> datagram, const OwnNetwork& network, in_addr group,
            std::uint16_t port) const;
  /// Sends a datagram to a process. Its host may be gone, and messages that matter are repeated, so errors
  /// are not reported.
  static void send(std::span<const std::uint8_t> datagram, in_addr address, std::uint16_t port);
  /// Counts changes of the networks.
  std::uint64_t changes();

 private:
  void follow();
  void join(in_addr group);

  std::mutex mutex_;
  int news_ = -1;   ///< netlink(7): the kernel tells of changes
  int group_ = -1;  ///< a member of the group on each network; -1: none has changed
  std::chrono::steady_clock::time_point looked_at_{};
  std::vector<OwnNetwork> own_;
  std::uint64_t changes_ = 0;
  std::uint64_t joined_as_of_ = 0;  ///< of `changes_`
};

}  // namespace coppice
