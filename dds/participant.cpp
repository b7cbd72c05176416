#include "dds/participant.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dds/discovery_server.h"
#include "dds/qos.h"
#include "dds/security.h"
#include "dds/server_list.h"
#include "dds/static_endpoints.h"
#include "dds/discovery.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;

namespace {

constexpr std::uint32_t first_announcements = 100;  // a tenth of a second after each other
// Seconds until a silent process counts as gone. Not how the fleet notices that: its roles have leases of
// their own. A process that was only paused, or cut off, and is dropped by DDS may never find all others
// again (with 20 s, tests/process/pause_test.cpp). Likely because only some drop it, and those who do not
// take the acknowledgments of its new beginning, which count from one, for old ones.
constexpr int lease = 120;
constexpr int datagram_for_credentials = 8192;  // bytes
constexpr int datagram_for_endpoints = 4096;    // likewise

/// Each process announces which endpoints it has, of those that all know.
void find_others_by_table(Role role, dds::DomainParticipantQos& qos) {
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.use_SIMPLE_EndpointDiscoveryProtocol = false;
  discovery.use_STATIC_EndpointDiscoveryProtocol = true;
  discovery.static_edp_xml_config(("data://" + static_endpoints(role)).c_str());
  qos.name(static_participant);
}

/// Through these servers instead of by multicast.
void find_others_through(const std::string& servers, dds::DomainParticipantQos& qos) {
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.discoveryProtocol = eprosima::fastrtps::rtps::DiscoveryProtocol_t::CLIENT;
  discovery.leaseDuration_announcementperiod = Duration_t(between_words);
  ServerList list = look_up_servers(servers);
  if (!list.is_usable())
    throw std::runtime_error(
        fmt::format("\"{}\" names no discovery servers, expected {}", servers, discovery_rule));
  for (const std::string& host : list.unknown)
    spdlog::warn("discovery server {} has no address: goes on without it", host);
  discovery.m_DiscoveryServers = std::move(list.found);
}

/// DDS does not cut these, so they must fit: a step of an authentication, which holds certificates; and the
/// announcement of those who read or write nearly all topics, which names each endpoint that all know.
int largest_datagram_of(const DdsSettings& settings, Role role) {
  int largest = settings.largest_datagram;
  if (!settings.security.empty()) largest = std::max(largest, datagram_for_credentials);
  const bool has_most_endpoints = role == Role::observer || role == Role::replayer;
  if (has_most_endpoints && discovery_of(settings) == static_discovery)
    largest = std::max(largest, datagram_for_endpoints);
  return largest;
}

}  // namespace

std::string discovery_of(const DdsSettings& settings) {
  if (!settings.discovery.empty()) return settings.discovery;
  if (const std::string servers = usual_discovery_servers(); !servers.empty()) return servers;
  return settings.security.empty() ? multicast_discovery : static_discovery;
}

dds::DomainParticipantQos participant_qos(const DdsSettings& settings, Role role, const std::string& sender,
                                          Recipients& recipients, Announcements& announcements,
                                          Traffic& traffic) {
  dds::DomainParticipantQos qos;
  qos.name(sender);
  qos.user_data().data_vec(role == Role::replayer ? user_data_of_replayer() : user_data_of(settings.robot));
  qos.transport().use_builtin_transports = false;
  const std::string discovery = discovery_of(settings);
  const bool by_servers = are_servers(discovery);
  qos.transport().user_transports.push_back(
      sparing_udp_transport({.recipients = recipients,
                             .announcements = by_servers ? nullptr : &announcements,
                             .traffic = traffic,
                             .largest_datagram = largest_datagram_of(settings, role),
                             .is_secure = !settings.security.empty()}));
  // Otherwise ten from the beginning, each as long as a datagram.
  qos.allocation().send_buffers = {.preallocated_number = 1, .dynamic = true};
  qos.allocation().locators.max_unicast_locators = most_addresses;
  auto& builtin = qos.wire_protocol().builtin;
  builtin.mutation_tries = most_participants;
  // The transport leaves out most of these: it takes long to set up hundreds of participants at once.
  builtin.discovery_config.initial_announcements.count = first_announcements;
  builtin.discovery_config.leaseDuration = Duration_t(lease, 0);
  builtin.use_WriterLivelinessProtocol = false;  // no topic asks for it
  if (discovery == static_discovery) find_others_by_table(role, qos);
  if (by_servers && !settings.security.empty())
    throw std::runtime_error(
        fmt::format("with --security processes find each other by multicast or static discovery, and not "
                    "through servers (\"{}\"): those of this Fast DDS authenticate nobody",
                    discovery));
  if (by_servers) find_others_through(discovery, qos);
  if (!settings.security.empty()) secure(settings.security, qos);
  return qos;
}

void Discoveries::look_for_a_double(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) const {
  if (!robot_.empty() && senders_.robot_of(participant) == robot_)
    spdlog::warn("another process says to be robot {}, too: end one of them, unless it was killed just now",
                 robot_);
}

ServerExamination examine_servers(const std::string& servers) {
  ServerList list = look_up_servers(servers);
  return {list.is_usable(), std::move(list.unknown)};
}

}  // namespace coppice
