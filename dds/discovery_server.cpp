#include "dds/discovery_server.h"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <arpa/inet.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/attributes/ServerAttributes.h>
#include <fastrtps/utils/IPFinder.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dds/dds_bus.h"
#include "dds/qos.h"
#include "dds/transport.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

/// Clients are told the server's address. If it were an address of another host, they would look for the
/// server there.
bool is_of_this_host(const std::string& address) {
  if (address == "0.0.0.0") return true;
  std::vector<eprosima::fastrtps::rtps::IPFinder::info_IP> own;
  eprosima::fastrtps::rtps::IPFinder::getIPs(&own, true);
  return std::ranges::any_of(own, [&](const auto& ip) { return ip.name == address; });
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
  Recipients recipients{false};  // no limit: sends to all
  Traffic traffic;
  dds::DomainParticipant* participant = nullptr;
};

DdsDiscoveryServer::DdsDiscoveryServer(const std::string& address, std::uint16_t port, int place)
    : implementation_(std::make_unique<Implementation>()) {
  dds::DomainParticipantQos qos;
  qos.name("discovery_server");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(sparing_udp_transport({.recipients = implementation_->recipients,
                                                                   .announcements = nullptr,
                                                                   .traffic = implementation_->traffic,
                                                                   .largest_datagram = datagram_for_networks,
                                                                   .is_secure = false}));
  qos.allocation().locators.max_unicast_locators = most_addresses;
  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
  builtin.discovery_config.leaseDuration = eprosima::fastrtps::Duration_t(server_lease);
  builtin.discovery_config.leaseDuration_announcementperiod = eprosima::fastrtps::Duration_t(between_words);
  rtps::Locator_t locator;
  if (!rtps::get_server_client_default_guidPrefix(place, qos.wire_protocol().prefix) ||
      !rtps::IPLocator::setIPv4(locator, address) || !rtps::IPLocator::setPhysicalPort(locator, port))
    throw std::runtime_error(
        fmt::format("{}:{} is not a valid address for a discovery server", address, port));
  if (!is_of_this_host(address))
    throw std::runtime_error(
        fmt::format("{} is not an address of this host, expected one of them, or 0.0.0.0 for all", address));
  builtin.metatrafficUnicastLocatorList.push_back(locator);
  implementation_->participant = dds::DomainParticipantFactory::get_instance()->create_participant(0, qos);
  if (implementation_->participant == nullptr)
    throw std::runtime_error(
        fmt::format("DDS could not create a discovery server at {}:{} (is the port in use?)", address, port));
}

DdsDiscoveryServer::~DdsDiscoveryServer() {
  dds::DomainParticipantFactory::get_instance()->delete_participant(implementation_->participant);
}

}  // namespace coppice
