#include "bus/dds_transport.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/common/LocatorsIterator.hpp>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

namespace coppice {

namespace rtps = eprosima::fastrtps::rtps;
namespace transport = eprosima::fastdds::rtps;

namespace {

// The group hears all news, and has new members. Who was told directly, since it had just come, is in the
// group.
constexpr std::chrono::milliseconds repeat_to_one{10'000};
constexpr std::chrono::milliseconds repeat_to_group{3'000};
// The first ones may be lost, or too early for those who start at the same time: the gaps double from here
// on.
constexpr std::chrono::milliseconds first_repeat_to_group{500};
constexpr int most_doublings = 3;
// Two hundred processes announce themselves at once: the usual 200 KB of a socket overflow. The system may
// grant less.
constexpr std::uint32_t receive_buffer = 4u << 20;

constexpr std::string_view robot_key = "robot=";

}  // namespace

Audience::Limit::Limit(Audience& audience, std::vector<RobotName> agents) : audience_(audience) {
  std::ranges::sort(agents);
  audience_.agents_ = std::move(agents);
  audience_.limited_in_ = std::this_thread::get_id();
}

Audience::Limit::~Limit() {
  audience_.limited_in_ = std::thread::id();
}

void Audience::discover(const rtps::ParticipantDiscoveryInfo& info) {
  const RobotName robot = robot_of(info.info.m_userData);
  if (robot.empty()) return;
  const bool gone = info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
                    info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT;
  const std::scoped_lock lock(mutex_);
  for (const rtps::Locator_t& address : info.info.default_locators.unicast) {
    const auto known = agent_at_.find(address);
    if (!gone) {
      agent_at_[address] = {robot, info.info.m_guid};
    } else if (known != agent_at_.end() && known->second.participant == info.info.m_guid) {
      agent_at_.erase(known);  // and not its successor, after a restart
    }
  }
}

bool Audience::includes(const rtps::Locator_t& address) const {
  const std::scoped_lock lock(mutex_);
  const auto agent = agent_at_.find(address);
  return agent == agent_at_.end() || std::ranges::binary_search(agents_, agent->second.robot);
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

/// DDS-RTPS 2.2, 8.3.3 (messages), 9.4.5 (submessages), 8.5.3 (participant discovery).
std::optional<std::uint64_t> announcement_in(std::span<const std::uint8_t> message) {
  constexpr std::size_t header = 20;
  constexpr std::size_t submessage_header = 4;
  constexpr std::uint8_t info_timestamp = 0x09;
  constexpr std::uint8_t data = 0x15;
  constexpr std::uint8_t first_of_vendors = 0x80;
  constexpr std::uint8_t is_little_endian = 0x01;
  constexpr std::uint8_t holds_data = 0x04;
  constexpr std::size_t writer_at = 12;  // of a data submessage; its sequence number follows
  constexpr std::array<std::uint8_t, 4> participant_writer{0x00, 0x01, 0x00, 0xc2};
  std::optional<std::uint64_t> number;
  for (std::size_t at = header; at + submessage_header <= message.size();) {
    const std::span rest = message.subspan(at);
    const std::uint8_t kind = rest[0];
    if (kind == data) {
      const bool announces = rest.size() >= writer_at + 12 && (rest[1] & holds_data) != 0 &&
                             std::ranges::equal(rest.subspan(writer_at, 4), participant_writer);
      if (!announces || number) return std::nullopt;
      std::uint64_t bytes = 0;
      for (const std::uint8_t byte : rest.subspan(writer_at + 4, 8)) bytes = bytes << 8 | byte;
      number = bytes;
    } else if (kind != info_timestamp && kind < first_of_vendors) {
      return std::nullopt;
    }
    const bool little = (rest[1] & is_little_endian) != 0;
    const std::size_t length = little ? rest[2] | rest[3] << 8 : rest[2] << 8 | rest[3];
    if (length == 0) break;  // to the end of the message
    at += submessage_header + length;
  }
  return number;
}

bool Announcements::is_due(const rtps::SenderResource* sender, const rtps::Locator_t& destination,
                           std::uint64_t number, Time now) {
  if (!begun_) return false;
  const bool is_group = rtps::IPLocator::isMulticast(destination);
  const std::scoped_lock lock(mutex_);
  const auto [entry, fresh] = told_.try_emplace({sender, destination});
  Told& told = entry->second;
  const bool is_news = told.number != number && is_group;
  const auto gap =
      is_group ? std::min(repeat_to_group, first_repeat_to_group * (1 << told.repeats)) : repeat_to_one;
  if (!fresh && !is_news && now - told.at < gap) return false;
  const int repeats = fresh || is_news ? 0 : std::min(told.repeats + 1, most_doublings);
  told = {number, now, repeats};
  return true;
}

namespace {

class SparingTransport final : public transport::ChainingTransport {
 public:
  SparingTransport(const transport::ChainingTransportDescriptor& descriptor,
                   std::unique_ptr<transport::TransportDescriptorInterface> configuration, Audience& audience,
                   Announcements* announcements, Traffic& traffic)
      : ChainingTransport(descriptor),
        configuration_(std::move(configuration)),
        audience_(audience),
        announcements_(announcements),
        traffic_(traffic) {}

  transport::TransportDescriptorInterface* get_configuration() override { return configuration_.get(); }

  bool send(rtps::SenderResource* udp, const rtps::octet* message, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    if (audience_.is_limited()) {
      const auto includes = [&](const rtps::Locator_t& l) { return audience_.includes(l); };
      return send_to(includes, udp, message, size, begin, end, timeout);
    }
    if (const auto number = announcements_ != nullptr ? announcement_in({message, size}) : std::nullopt) {
      const auto now = std::chrono::steady_clock::now();
      const auto is_due = [&](const rtps::Locator_t& l) {
        return announcements_->is_due(udp, l, *number, now);
      };
      return send_to(is_due, udp, message, size, begin, end, timeout);
    }
    const auto all = [](const rtps::Locator_t&) { return true; };
    return send_to(all, udp, message, size, begin, end, timeout);
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* message, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    traffic_.bytes_received += size;
    next->OnDataReceived(message, size, local, remote);
  }

 private:
  template <class Wanted>
  bool send_to(Wanted&& wanted, rtps::SenderResource* udp, const rtps::octet* message, std::uint32_t size,
               rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
               const std::chrono::steady_clock::time_point& timeout) {
    transport::LocatorList chosen;
    for (; *begin != *end; ++*begin) {
      if (wanted(**begin)) chosen.push_back(**begin);
    }
    if (chosen.empty()) return true;
    traffic_.bytes_sent += std::uint64_t{size} * chosen.size();
    rtps::Locators first(chosen.begin());
    rtps::Locators last(chosen.end());
    return udp->send(message, size, &first, &last, timeout);
  }

  std::unique_ptr<transport::TransportDescriptorInterface> configuration_;
  Audience& audience_;
  Announcements* announcements_;
  Traffic& traffic_;
};

struct SparingTransportDescriptor final : transport::ChainingTransportDescriptor {
  SparingTransportDescriptor(const std::shared_ptr<transport::TransportDescriptorInterface>& udp, Audience& a,
                             Announcements* n, Traffic& t)
      : ChainingTransportDescriptor(udp), audience(a), announcements(n), traffic(t) {}
  transport::TransportInterface* create_transport() const override {
    auto configuration = std::make_unique<SparingTransportDescriptor>(*this);
    // NOLINTNEXTLINE(cppcoreguidelines-owning-memory): the interface's way
    return new SparingTransport(*this, std::move(configuration), audience, announcements, traffic);
  }
  Audience& audience;
  Announcements* announcements;
  Traffic& traffic;
};

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> sparing_udp_transport(Audience& audience,
                                                                               Announcements* announcements,
                                                                               Traffic& traffic,
                                                                               int largest_datagram) {
  auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
  udp->receiveBufferSize = receive_buffer;
  udp->maxMessageSize = static_cast<std::uint32_t>(largest_datagram);
  return std::make_shared<SparingTransportDescriptor>(udp, audience, announcements, traffic);
}

}  // namespace coppice
