#include "dds/own_networks.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

namespace coppice {

namespace {

// Announcements come in bursts, and one look at the news serves them all.
constexpr std::chrono::milliseconds between_looks{200};

bool is_loopback(in_addr address) {
  return ntohl(address.s_addr) >> 24 == 127;
}

/// Those with an IPv4 address that carry multicast now. The loopback is not among them: DDS keeps to that.
std::vector<OwnNetwork> networks_now() {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(all, freeifaddrs);
  constexpr unsigned usable = IFF_UP | IFF_RUNNING;
  std::vector<OwnNetwork> networks;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if ((one->ifa_flags & usable) != usable || (one->ifa_flags & IFF_LOOPBACK) != 0) continue;
    sockaddr_in address{};
    std::memcpy(&address, one->ifa_addr, sizeof address);
    networks.push_back({static_cast<int>(if_nametoindex(one->ifa_name)), address.sin_addr});
  }
  return networks;
}

int open_news() {
  const int news = socket(AF_NETLINK, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, NETLINK_ROUTE);
  sockaddr_nl all_changes{};
  all_changes.nl_family = AF_NETLINK;
  all_changes.nl_groups = RTMGRP_LINK | RTMGRP_IPV4_IFADDR;
  if (news >= 0) (void)bind(news, reinterpret_cast<const sockaddr*>(&all_changes), sizeof all_changes);
  return news;
}

/// Takes all news. True if there were any, also such as were too many for the kernel's buffer.
bool take_news(int news) {
  std::array<char, 8192> buffer{};
  bool any = false;
  while (true) {
    const ssize_t size = recv(news, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (size <= 0 && errno != ENOBUFS && errno != EINTR) return any;
    any = true;
  }
}

/// Closes the socket.
void send_through(int udp, std::span<const std::uint8_t> datagram, in_addr address, std::uint16_t port) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr = address;
  to.sin_port = htons(port);
  (void)sendto(udp, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  close(udp);
}

bool same(const OwnNetwork& a, const OwnNetwork& b) {
  return a.interface == b.interface && a.address.s_addr == b.address.s_addr;
}

}  // namespace

OwnNetworks::OwnNetworks() : news_(open_news()), own_(networks_now()) {}

OwnNetworks::~OwnNetworks() {
  for (const int descriptor : {news_, group_}) {
    if (descriptor >= 0) close(descriptor);
  }
}

void OwnNetworks::follow() {
  const auto now = std::chrono::steady_clock::now();
  if (news_ < 0 || now - looked_at_ < between_looks) return;
  looked_at_ = now;
  if (!take_news(news_)) return;
  std::vector<OwnNetwork> present = networks_now();
  if (std::ranges::equal(present, own_, same)) return;
  own_ = std::move(present);
  ++changes_;
}

bool OwnNetworks::is_own(in_addr address) {
  if (is_loopback(address)) return true;
  const std::scoped_lock lock(mutex_);
  follow();
  return std::ranges::any_of(
      own_, [&](const OwnNetwork& network) { return network.address.s_addr == address.s_addr; });
}

std::uint64_t OwnNetworks::changes() {
  const std::scoped_lock lock(mutex_);
  follow();
  return changes_;
}

std::vector<OwnNetwork> OwnNetworks::networks_of_group(in_addr group) {
  const std::scoped_lock lock(mutex_);
  follow();
  if (changes_ == 0) return {};
  if (joined_as_of_ != changes_) join(group);
  return own_;
}

/// With a new socket: the kernel may have ended memberships of an old one.
void OwnNetworks::join(in_addr group) {
  joined_as_of_ = changes_;
  if (group_ >= 0) close(group_);
  group_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  for (const OwnNetwork& network : own_) {
    ip_mreqn membership{};
    membership.imr_multiaddr = group;
    membership.imr_ifindex = network.interface;
    (void)setsockopt(group_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership);
    spdlog::info("the networks of this host have changed: goes on at {}", inet_ntoa(network.address));
  }
  if (own_.empty()) spdlog::info("the networks of this host have changed: only its loopback is left");
}

/// Sockets are closed at once: messages across networks that have changed are rare.
void OwnNetworks::send(std::span<const std::uint8_t> datagram, const OwnNetwork& network, in_addr group,
                       std::uint16_t port) const {
  ip_mreqn through{};
  through.imr_address = network.address;
  through.imr_ifindex = network.interface;
  const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (udp < 0) return;
  (void)setsockopt(udp, IPPROTO_IP, IP_MULTICAST_IF, &through, sizeof through);
  send_through(udp, datagram, group, port);
}

void OwnNetworks::send(std::span<const std::uint8_t> datagram, in_addr address, std::uint16_t port) {
  const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (udp >= 0) send_through(udp, datagram, address, port);
}

}  // namespace coppice
