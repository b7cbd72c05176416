#include "bus/dds_discovery_server.h"

#include <memory>
#include <stdexcept>
#include <utility>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/attributes/ServerAttributes.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>

#include "bus/dds_bus.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

struct DdsDiscoveryServer::Implementation {
  dds::DomainParticipant* participant = nullptr;
};

DdsDiscoveryServer::DdsDiscoveryServer(const std::string& address, std::uint16_t port, int place)
    : implementation_(std::make_unique<Implementation>()) {
  dds::DomainParticipantQos qos;
  qos.name("discovery_server");
  qos.transport().use_builtin_transports = false;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->maxMessageSize = datagram_for_networks;
  qos.transport().user_transports.push_back(std::move(udp));
  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
  rtps::Locator_t locator;
  if (!rtps::get_server_client_default_guidPrefix(place, qos.wire_protocol().prefix) ||
      !rtps::IPLocator::setIPv4(locator, address) || !rtps::IPLocator::setPhysicalPort(locator, port))
    throw std::runtime_error(fmt::format("{}:{} is no address for a discovery server", address, port));
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
