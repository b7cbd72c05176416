#include "dds/discovery_server.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <arpa/inet.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/rtps/attributes/ServerAttributes.h>
#include <fastrtps/utils/IPFinder.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dds/dds_bus.h"
#include "dds/participant.h"
#include "dds/qos.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

constexpr const char* all_addresses = "0.0.0.0";
constexpr const char* loopback = "127.0.0.1";

/// Clients are told the server's address. If it were an address of another host, they would look for the
/// server there.
bool is_of_this_host(const std::string& address) {
  if (address == all_addresses) return true;
  std::vector<eprosima::fastrtps::rtps::IPFinder::info_IP> own;
  eprosima::fastrtps::rtps::IPFinder::getIPs(&own, true);
  return std::ranges::any_of(own, [&](const auto& ip) { return ip.name == address; });
}

/// With no other address than the loopback, DDS refuses a server at all addresses.
bool has_only_the_loopback() {
  std::vector<eprosima::fastrtps::rtps::IPFinder::info_IP> own;
  eprosima::fastrtps::rtps::IPFinder::getIPs(&own, false);
  return std::ranges::none_of(
      own, [](const auto& ip) { return ip.type == eprosima::fastrtps::rtps::IPFinder::IP4; });
}

bool is_taken(std::uint16_t port) {
  const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_port = htons(port);
  any.sin_addr.s_addr = htonl(INADDR_ANY);
  const bool taken =
      bind(udp, reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0 && errno == EADDRINUSE;
  close(udp);
  return taken;
}

}  // namespace

PortWatch::PortWatch(std::uint16_t port)
    : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(port);
  own.sin_addr.s_addr = htonl(INADDR_ANY);  // the server listens on all addresses, too
  // Errors of the port are reported by the server itself.
  (void)bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own);
}

PortWatch::~PortWatch() {
  close(socket_);
}

bool PortWatch::heard_rtps() {
  std::array<char, 4> begin{};
  while (recv(socket_, begin.data(), begin.size(), 0) >= 0) {
    if (std::string_view(begin.data(), begin.size()) == "RTPS") return true;
  }
  return false;
}

struct DdsDiscoveryServer::Implementation {
  /// Clients may be on hosts that get other addresses.
  struct Clients final : dds::DomainParticipantListener {
    explicit Clients(Whereabouts& to) : whereabouts(to) {}
    void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) override {
      whereabouts.discover(info);
    }
    Whereabouts& whereabouts;
  };

  ParticipantParts parts{false};  // no limit: sends to all
  Clients clients{parts.whereabouts};
  dds::DomainParticipant* participant = nullptr;
};

DdsDiscoveryServer::DdsDiscoveryServer(const std::string& address, std::uint16_t port, int place)
    : implementation_(std::make_unique<Implementation>()) {
  dds::DomainParticipantQos qos;
  qos.name("discovery_server");
  qos.transport().use_builtin_transports = false;
  ParticipantParts& parts = implementation_->parts;
  qos.transport().user_transports.push_back(sparing_udp_transport({.recipients = parts.recipients,
                                                                   .announcements = nullptr,
                                                                   .traffic = parts.traffic,
                                                                   .networks = parts.networks,
                                                                   .whereabouts = parts.whereabouts,
                                                                   .largest_datagram = datagram_for_networks,
                                                                   .is_secure = false}));
  qos.allocation().locators.max_unicast_locators = most_addresses;
  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
  builtin.discovery_config.leaseDuration = eprosima::fastrtps::Duration_t(server_lease);
  builtin.discovery_config.leaseDuration_announcementperiod = eprosima::fastrtps::Duration_t(between_words);
  // The server listens at all addresses in any case.
  const bool is_alone = address == all_addresses && has_only_the_loopback();
  rtps::Locator_t locator;
  if (!rtps::get_server_client_default_guidPrefix(place, qos.wire_protocol().prefix) ||
      !rtps::IPLocator::setIPv4(locator, is_alone ? loopback : address) ||
      !rtps::IPLocator::setPhysicalPort(locator, port))
    throw std::runtime_error(
        fmt::format("{}:{} is not a valid address for a discovery server", address, port));
  if (!is_of_this_host(address))
    throw std::runtime_error(
        fmt::format("{} is not an address of this host, expected one of them, or 0.0.0.0 for all", address));
  builtin.metatrafficUnicastLocatorList.push_back(locator);
  implementation_->participant = dds::DomainParticipantFactory::get_instance()->create_participant(
      0, qos, &implementation_->clients, dds::StatusMask::none());
  if (implementation_->participant == nullptr)
    throw std::runtime_error(
        is_taken(port) ? fmt::format("another program has UDP port {}: end it, or name another --port", port)
                       : fmt::format("DDS could not create a discovery server at {}:{}", address, port));
  if (is_alone)
    spdlog::warn(
        "only the loopback of this host is up: serves the processes of this host, and those of others "
        "once there is a network");
}

DdsDiscoveryServer::~DdsDiscoveryServer() {
  dds::DomainParticipantFactory::get_instance()->delete_participant(implementation_->participant);
}

}  // namespace coppice
