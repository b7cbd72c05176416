#include "dds/participant.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dds/discovery.h"
#include "dds/discovery_server.h"
#include "dds/qos.h"
#include "dds/security.h"
#include "dds/server_list.h"
#include "dds/static_endpoints.h"

namespace coppice {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;

namespace {

constexpr std::uint32_t first_announcements = 100;  // one every 0.1 s
// Seconds until DDS drops a silent process. The fleet does not rely on this: its roles have leases of their
// own. It is long because a process that was paused or cut off, and then dropped by DDS, may never find all
// others again (seen with 20 s, tests/process/pause_test.cpp). The likely reason: only some processes drop
// it, and the other ones take the acknowledgments that it numbers from one again for old ones.
constexpr int lease = 120;
constexpr int datagram_for_credentials = 8192;  // bytes

/// Static discovery: each process announces which endpoints of the table of topics it has.
void find_others_by_table(Role role, dds::DomainParticipantQos& qos) {
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.use_SIMPLE_EndpointDiscoveryProtocol = false;
  discovery.use_STATIC_EndpointDiscoveryProtocol = true;
  discovery.static_edp_xml_config(("data://" + static_endpoints(role)).c_str());
  // DDS does not cut the announcement of a participant, which lists its endpoints. In the usual format that
  // of a service, an observer or a replayer would not fit into a datagram.
  qos.properties().properties().emplace_back("dds.discovery.static_edp.exchange_format", "v1_Reduced");
  qos.name(static_participant);
}

/// Discovery through these servers, without multicast.
void find_others_through(const std::string& servers, dds::DomainParticipantQos& qos) {
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.discoveryProtocol = eprosima::fastrtps::rtps::DiscoveryProtocol_t::CLIENT;
  discovery.leaseDuration_announcementperiod = Duration_t(between_words);
  ServerList list = look_up_servers(servers);
  if (!list.is_usable())
    throw std::runtime_error(
        fmt::format("\"{}\" names no discovery servers, expected {}", servers, discovery_rule));
  for (const std::string& host : list.unknown)
    spdlog::warn("discovery server {} has no address: continuing without it", host);
  discovery.m_DiscoveryServers = std::move(list.found);
}

/// Throws std::runtime_error if another program has the domain's multicast port to itself. DDS says nothing
/// of it then, and this process would hear of no other. Participants share the port.
void check_multicast_port(int domain) {
  const int port = domain_port(domain);
  const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (udp < 0) return;
  const int shared = 1;
  setsockopt(udp, SOL_SOCKET, SO_REUSEADDR, &shared, sizeof shared);
  setsockopt(udp, SOL_SOCKET, SO_REUSEPORT, &shared, sizeof shared);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_addr.s_addr = htonl(INADDR_ANY);
  any.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool is_taken =
      bind(udp, reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0 && errno == EADDRINUSE;
  close(udp);
  if (is_taken)
    throw std::runtime_error(
        fmt::format("another program has UDP port {}, by which processes of DDS domain {} find each other: "
                    "end it, or use another domain",
                    port, domain));
}

/// The size of a datagram that DDS may send. DDS does not cut a step of an authentication, which contains
/// certificates.
int largest_datagram_of(const DdsSettings& settings) {
  const int largest = settings.largest_datagram;
  return settings.security.empty() ? largest : std::max(largest, datagram_for_credentials);
}

}  // namespace

std::string discovery_of(const DdsSettings& settings) {
  if (!settings.discovery.empty()) return settings.discovery;
  if (const std::string servers = usual_discovery_servers(); !servers.empty()) return servers;
  return settings.security.empty() ? multicast_discovery : static_discovery;
}

dds::DomainParticipantQos participant_qos(const DdsSettings& settings, Role role, const std::string& sender,
                                          ParticipantParts& parts) {
  dds::DomainParticipantQos qos;
  qos.name(sender);
  qos.user_data().data_vec(role == Role::replayer ? user_data_of_replayer() : user_data_of(settings.robot));
  qos.transport().use_builtin_transports = false;
  const std::string discovery = discovery_of(settings);
  const bool by_servers = are_servers(discovery);
  qos.transport().user_transports.push_back(
      sparing_udp_transport({.recipients = parts.recipients,
                             .announcements = by_servers ? nullptr : &parts.announcements,
                             .traffic = parts.traffic,
                             .networks = parts.networks,
                             .whereabouts = parts.whereabouts,
                             .largest_datagram = largest_datagram_of(settings),
                             .is_secure = !settings.security.empty()}));
  // The default reserves ten buffers, each as long as a datagram.
  qos.allocation().send_buffers = {.preallocated_number = 1, .dynamic = true};
  qos.allocation().locators.max_unicast_locators = most_addresses;
  auto& builtin = qos.wire_protocol().builtin;
  builtin.mutation_tries = most_participants;
  // The transport drops most of these announcements. Many are needed because setting up hundreds of
  // participants at once takes long.
  builtin.discovery_config.initial_announcements.count = first_announcements;
  builtin.discovery_config.leaseDuration = Duration_t(lease, 0);
  builtin.use_WriterLivelinessProtocol = false;  // no topic asks for it
  if (discovery == static_discovery) find_others_by_table(role, qos);
  if (by_servers && !settings.security.empty())
    throw std::runtime_error(
        fmt::format("with --security processes find each other by multicast or static discovery, and not "
                    "through servers (\"{}\"): those of this Fast DDS authenticate nobody",
                    discovery));
  if (by_servers)
    find_others_through(discovery, qos);
  else
    check_multicast_port(settings.domain);
  if (!settings.security.empty()) secure(settings.security, qos);
  return qos;
}

void Discoveries::look_for_a_double(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) const {
  if (!robot_.empty() && senders_.robot_of(participant) == robot_)
    spdlog::warn(
        "another process is the agent of robot {}, too: stop one of them, unless one was killed just now",
        robot_);
}

ServerExamination examine_servers(const std::string& servers) {
  ServerList list = look_up_servers(servers);
  return {list.is_usable(), std::move(list.unknown)};
}

}  // namespace coppice
