#include "dds/transport.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/common/LocatorSelector.hpp>
#include <fastdds/rtps/common/LocatorsIterator.hpp>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "dds/datagram.h"
#include "dds/rtps_message.h"

namespace coppice {

namespace rtps = eprosima::fastrtps::rtps;
namespace transport = eprosima::fastdds::rtps;

using Bytes = std::span<const std::uint8_t>;

namespace {

// A participant that was told directly because it had just appeared is in the multicast group, too. The group
// gets all news and contains all new members.
constexpr std::chrono::milliseconds repeat_to_one{10'000};
// The first announcements may be lost, or come too early for processes that start at the same time. The gaps
// double from this one on: two hundred processes that went on announcing themselves often would do little
// else.
constexpr std::chrono::milliseconds first_repeat_to_group{500};
constexpr std::chrono::milliseconds seldom{30'000};
constexpr int repeats_until_seldom = 10;

constexpr std::chrono::milliseconds between_heartbeats{300};

constexpr std::size_t most_met = 20'000;  // participants

constexpr std::string_view robot_key = "robot=";
constexpr std::string_view replayer_data = "replayer";

}  // namespace

Recipients::Limit::Limit(Recipients& recipients, std::vector<RobotName> agents) : recipients_(recipients) {
  recipients_.agents_ = std::move(agents);
  recipients_.limited_in_ = std::this_thread::get_id();
}

Recipients::Limit::~Limit() {
  recipients_.limited_in_ = std::thread::id();
}

void Recipients::discover(const rtps::ParticipantDiscoveryInfo& info) {
  const bool gone = info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
                    info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT;
  const Guid& participant = info.info.m_guid;
  const auto& addresses = info.info.default_locators.unicast;
  const Announced announced{robot_of(info.info.m_userData), {addresses.begin(), addresses.end()}};
  const std::scoped_lock lock(mutex_);
  ++changes_;
  if (gone) {
    for (auto& [address, there] : at_)
      std::erase_if(there, [&](const Process& p) { return p.participant == participant; });
    std::erase_if(at_, [](const auto& entry) { return entry.second.empty(); });
    unproven_.erase(participant);
    authenticated_.erase(participant);
  } else if (!is_secure_) {
    place(participant, announced);
  } else if (!authenticated_.contains(participant)) {
    unproven_[participant] = announced;
  }
}

void Recipients::authenticate(const Guid& participant) {
  const std::scoped_lock lock(mutex_);
  ++changes_;
  authenticated_.insert(participant);
  const auto announced = unproven_.find(participant);
  if (announced == unproven_.end()) return;
  place(participant, announced->second);
  unproven_.erase(announced);
}

void Recipients::place(const Guid& participant, const Announced& announced) {
  for (const Address& address : announced.addresses) {
    std::vector<Process>& there = at_[address];
    const auto known = std::ranges::find(there, participant, &Process::participant);
    if (known == there.end()) {
      there.push_back({participant, announced.robot});
    } else {
      known->robot = announced.robot;
    }
  }
}

transport::LocatorList Recipients::among(rtps::LocatorsIterator& begin, const rtps::LocatorsIterator& end) {
  if (readers_.as_of != changes_) sort(begin, end);
  transport::LocatorList chosen = readers_.others;
  for (const RobotName& agent : agents_) {
    const auto known = readers_.agents.find(agent);
    if (known == readers_.agents.end()) continue;
    for (const Address& address : known->second) chosen.push_back(address);
  }
  return chosen;
}

void Recipients::sort(rtps::LocatorsIterator& begin, const rtps::LocatorsIterator& end) {
  readers_ = {.as_of = changes_};
  const std::scoped_lock lock(mutex_);
  for (; begin != end; ++begin) {
    const auto known = at_.find(*begin);
    const bool all_are_agents =
        known != at_.end() &&
        std::ranges::none_of(known->second, [](const Process& p) { return p.robot.empty(); });
    if (!all_are_agents) {
      readers_.others.push_back(*begin);
      continue;
    }
    for (const Process& process : known->second) readers_.agents[process.robot].push_back(*begin);
  }
}

std::vector<std::uint8_t> user_data_of(const RobotName& robot) {
  if (robot.empty()) return {};
  std::vector<std::uint8_t> data(robot_key.begin(), robot_key.end());
  data.insert(data.end(), robot.begin(), robot.end());
  return data;
}

RobotName robot_of(std::span<const std::uint8_t> user_data) {
  const std::string text(user_data.begin(), user_data.end());
  return text.starts_with(robot_key) ? text.substr(robot_key.size()) : RobotName();
}

std::vector<std::uint8_t> user_data_of_replayer() {
  return {replayer_data.begin(), replayer_data.end()};
}

void Announcements::hear(Bytes announcement) {
  const std::scoped_lock lock(mutex_);
  if (met_.size() >= most_met) met_.clear();  // only forged names grow this far, as they are never forgotten
  if (!met_.insert(sender_of(announcement)).second) return;
  const std::vector<rtps::Locator_t> addresses = addresses_in(announcement);
  // On the same host a participant is reached through the loopback, whatever address it announces.
  const auto leads_there = [&](const auto& entry) {
    const rtps::Locator_t& destination = entry.first.destination;
    return std::ranges::any_of(addresses, [&](const rtps::Locator_t& address) {
      return destination == address ||
             (destination.port == address.port && rtps::IPLocator::isLocal(destination));
    });
  };
  std::erase_if(told_, leads_there);
  std::erase_if(last_heartbeats_, leads_there);
}

void Announcements::forget(const rtps::GuidPrefix_t& participant) {
  const std::scoped_lock lock(mutex_);
  met_.erase(participant);
}

void Announcements::tell_anew(const void* sender) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(told_, [&](const auto& entry) { return entry.first.sender == sender; });
}

bool Announcements::is_due(const void* sender, const rtps::Locator_t& destination, std::uint64_t number,
                           Time now) {
  if (!begun_) return false;
  const bool is_group = rtps::IPLocator::isMulticast(destination);
  const std::scoped_lock lock(mutex_);
  const auto [entry, fresh] = told_.try_emplace({sender, destination});
  Told& told = entry->second;
  const bool is_news = told.number != number && is_group;
  const auto usual = is_group ? first_repeat_to_group * (1 << told.repeats) : repeat_to_one;
  const auto gap = told.repeats < repeats_until_seldom ? std::min(usual, seldom) : seldom;
  if (!fresh && !is_news && now - told.at < gap) return false;
  const int repeats = fresh || is_news ? 0 : std::min(told.repeats + 1, repeats_until_seldom);
  told = {number, now, repeats};
  return true;
}

bool Announcements::is_due(const void* sender, const rtps::Locator_t& destination,
                           const EndpointHeartbeat& news, Time now) {
  const std::scoped_lock lock(mutex_);
  const auto [entry, fresh] = last_heartbeats_.try_emplace({sender, destination, news.writer});
  LastHeartbeat& last = entry->second;
  if (!fresh && last.heartbeat == news && now - last.at < between_heartbeats) return false;
  last = {news, now};
  return true;
}

namespace {

class SparingTransport final : public transport::ChainingTransport {
 public:
  SparingTransport(const transport::ChainingTransportDescriptor& descriptor,
                   std::unique_ptr<transport::TransportDescriptorInterface> configuration,
                   const SparingTransportParts& parts)
      : ChainingTransport(descriptor), configuration_(std::move(configuration)), parts_(parts) {}

  transport::TransportDescriptorInterface* get_configuration() override { return configuration_.get(); }

  bool send(rtps::SenderResource* udp, const rtps::octet* message, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    if (parts_.recipients.is_limited())
      return send_to(parts_.recipients.among(*begin, *end), udp, message, size, timeout);
    if (parts_.announcements != nullptr) {
      Announcements& announcements = *parts_.announcements;
      const Bytes bytes(message, size);
      if (const auto number = announcement_in(bytes)) {
        const auto now = std::chrono::steady_clock::now();
        const auto is_due = [&](const rtps::Locator_t& l) {
          if (rtps::IPLocator::isMulticast(l)) announce_on_changed_networks(bytes, l, *number, now);
          return announcements.is_due(udp, l, *number, now);
        };
        return send_to(those(is_due, begin, end), udp, message, size, timeout);
      }
      if (const auto news = endpoint_heartbeat_in(bytes)) {
        const auto now = std::chrono::steady_clock::now();
        const auto is_due = [&](const rtps::Locator_t& l) {
          return announcements.is_due(udp, l, *news, now);
        };
        return send_to(those(is_due, begin, end), udp, message, size, timeout);
      }
    }
    if (parts_.is_secure && is_handshake_of_others({message, size})) return true;
    const auto all = [](const rtps::Locator_t&) { return true; };
    return send_to(those(all, begin, end), udp, message, size, timeout);
  }

  /// UDP sends through every channel that it has. DDS asks for the channels to all readers again whenever it
  /// finds one more reader.
  bool OpenOutputChannel(transport::SendResourceList& senders, const rtps::Locator_t& address) override {
    const std::scoped_lock lock(opening_);
    if (open_.contains(address)) return true;
    if (!ChainingTransport::OpenOutputChannel(senders, address)) return false;
    open_.insert(address);
    return true;
  }

  /// Chooses as UDP does, but in linear time. UDP compares each locator with all locators chosen before. DDS
  /// chooses anew whenever a reader is found or lost, so N processes that meet would need N^4 comparisons.
  void select_locators(rtps::LocatorSelector& selector) const override {
    parts_.recipients.note_selection();
    auto& readers = selector.transport_starts();
    const bool in_groups = std::ranges::any_of(readers, [](const rtps::LocatorSelectorEntry* reader) {
      return reader->transport_should_process && !reader->multicast.empty();
    });
    if (in_groups) return ChainingTransport::select_locators(selector);
    // The set lies on the stack, because it is built hundreds of times for hundreds of addresses.
    std::array<std::byte, 16384> room;
    std::pmr::monotonic_buffer_resource memory(room.data(), room.size());
    std::pmr::unordered_set<rtps::Locator_t, AddressHash> chosen(&memory);
    chosen.reserve(readers.size());
    for (std::size_t i = 0; i < readers.size(); ++i) {
      rtps::LocatorSelectorEntry& reader = *readers[i];
      if (!reader.transport_should_process) continue;
      for (std::size_t k = 0; k < reader.unicast.size(); ++k) {
        if (IsLocatorSupported(reader.unicast[k]) && chosen.insert(reader.unicast[k]).second)
          reader.state.unicast.push_back(k);
      }
      if (!reader.state.unicast.empty()) selector.select(i);
    }
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* message, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    parts_.traffic.bytes_received += size;
    parts_.whereabouts.hear(sender_of({message, size}), remote);
    std::unique_lock one_at_a_time(discovering_, std::defer_lock);
    if (announcement_in({message, size})) {
      one_at_a_time.lock();
      if (parts_.announcements != nullptr) parts_.announcements->hear({message, size});
    }
    next->OnDataReceived(message, size, local, remote);
  }

 private:
  template <class Wanted>
  static transport::LocatorList those(Wanted&& wanted, rtps::LocatorsIterator* begin,
                                      rtps::LocatorsIterator* end) {
    transport::LocatorList chosen;
    for (; *begin != *end; ++*begin) {
      if (wanted(**begin)) chosen.push_back(**begin);
    }
    return chosen;
  }

  /// Once for all senders of DDS.
  void announce_on_changed_networks(Bytes announcement, const rtps::Locator_t& group, std::uint64_t number,
                                    Announcements::Time now) {
    in_addr address{};
    std::memcpy(&address, rtps::IPLocator::getIPv4(group), sizeof address);
    const std::vector<OwnNetwork> networks = parts_.networks.networks_of_group(address);
    const std::uint64_t changes = parts_.networks.changes();
    if (announced_as_of_.exchange(changes) != changes) parts_.announcements->tell_anew(&parts_.networks);
    if (networks.empty() || !parts_.announcements->is_due(&parts_.networks, group, number, now)) return;
    for (const OwnNetwork& network : networks) {
      parts_.networks.send(announcement, network, address, static_cast<std::uint16_t>(group.port));
      parts_.traffic.bytes_sent += announcement.size();
    }
  }

  bool send_to(transport::LocatorList chosen, rtps::SenderResource* udp, const rtps::octet* message,
               std::uint32_t size, const std::chrono::steady_clock::time_point& timeout) {
    if (chosen.empty()) return true;
    // Fast DDS sends only to addresses for which it has opened a channel.
    for (const rtps::Locator_t& there : parts_.whereabouts.present_of(chosen)) {
      in_addr address{};
      std::memcpy(&address, rtps::IPLocator::getIPv4(there), sizeof address);
      OwnNetworks::send({message, size}, address, static_cast<std::uint16_t>(there.port));
      parts_.traffic.bytes_sent += size;
    }
    if (chosen.empty()) return true;
    parts_.traffic.bytes_sent += std::uint64_t{size} * chosen.size();
    rtps::Locators first(chosen.begin());
    rtps::Locators last(chosen.end());
    return udp->send(message, size, &first, &last, timeout);
  }

  std::unique_ptr<transport::TransportDescriptorInterface> configuration_;
  SparingTransportParts parts_;
  std::mutex opening_;
  /// DDS never closes a channel before the participant ends.
  std::unordered_set<rtps::Locator_t, AddressHash> open_;
  std::mutex discovering_;
  std::atomic<std::uint64_t> announced_as_of_ = 0;  ///< of the changes of this host's networks
};

struct SparingTransportDescriptor final : transport::ChainingTransportDescriptor {
  SparingTransportDescriptor(const std::shared_ptr<transport::TransportDescriptorInterface>& udp,
                             const SparingTransportParts& p)
      : ChainingTransportDescriptor(udp), parts(p) {}
  transport::TransportInterface* create_transport() const override {
    auto configuration = std::make_unique<SparingTransportDescriptor>(*this);
    // NOLINTNEXTLINE(cppcoreguidelines-owning-memory): the interface's way
    return new SparingTransport(*this, std::move(configuration), parts);
  }
  /// The largest message that DDS sends. UDP below allows longer ones, because other processes on this host
  /// may send them and they must fit the receive buffers.
  std::uint32_t max_message_size() const override {
    return static_cast<std::uint32_t>(parts.largest_datagram);
  }
  SparingTransportParts parts;
};

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> sparing_udp_transport(
    const SparingTransportParts& parts) {
  auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
  udp->receiveBufferSize = wanted_receive_buffer;
  udp->maxMessageSize = datagram_for_one_host;
  return std::make_shared<SparingTransportDescriptor>(udp, parts);
}

}  // namespace coppice
