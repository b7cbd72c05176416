// Tests of what the transport decides for each datagram, and of what it reads from one.
//
// CTest: PARALLEL

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <fastdds/rtps/common/LocatorSelector.hpp>
#include <fastdds/rtps/transport/TransportInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <gtest/gtest.h>

#include "coppice/planning/random.h"
#include "dds/transport.h"

namespace coppice {
namespace {

namespace rtps = eprosima::fastrtps::rtps;
using namespace std::chrono_literals;

rtps::Locator_t address(const std::string& ip, std::uint32_t port) {
  rtps::Locator_t locator;
  rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, ip, port, locator);
  return locator;
}

using Bytes = std::vector<std::uint8_t>;

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// The layout of DDS-RTPS 2.2, little-endian.
const Bytes header{'R', 'T', 'P', 'S', 2, 2, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
const Bytes info_timestamp{0x09, 0x01, 8, 0, 1, 0, 0, 0, 0, 0, 0, 0};
const Bytes of_a_vendor{0x80, 0x01, 4, 0, 9, 9, 9, 9};
const Bytes heartbeat = Bytes{0x07, 0x01, 28, 0} + Bytes(28, 0);

Bytes data(std::uint8_t flags, std::uint8_t writer_kind, std::uint8_t number) {
  return {0x15, flags,       24, 0, 0, 0, 16,     0, 0, 1, 0, 0xc7, 0, 1,
          0,    writer_kind, 0,  0, 0, 0, number, 0, 0, 0, 0, 3,    0, 0};
}
const Bytes announcement = data(0x05, 0xc2, 7);

struct Reader {
  bool enabled;
  std::vector<std::size_t> unicast;    // indices of a few addresses
  std::vector<std::size_t> multicast;  // indices of a few groups
};

/// The addresses that a transport chooses for these readers.
std::vector<rtps::Locator_t> chosen(const eprosima::fastdds::rtps::TransportDescriptorInterface& descriptor,
                                    const std::vector<Reader>& readers) {
  const std::unique_ptr<eprosima::fastdds::rtps::TransportInterface> transport(descriptor.create_transport());
  std::vector<std::unique_ptr<rtps::LocatorSelectorEntry>> entries;
  rtps::LocatorSelector selector{eprosima::fastrtps::ResourceLimitedContainerConfig()};
  for (const Reader& reader : readers) {
    rtps::LocatorSelectorEntry& entry =
        *entries.emplace_back(std::make_unique<rtps::LocatorSelectorEntry>(4, 4));
    entry.enabled = reader.enabled;
    for (const std::size_t k : reader.unicast)
      entry.unicast.push_back(address("10.0.0.1", static_cast<std::uint32_t>(7411 + k)));
    for (const std::size_t k : reader.multicast)
      entry.multicast.push_back(address("239.255.0.1", static_cast<std::uint32_t>(7400 + k)));
    selector.add_entry(&entry);
  }
  selector.selection_start();
  transport->select_locators(selector);
  std::vector<rtps::Locator_t> result;
  selector.for_each([&](const rtps::Locator_t& locator) { result.push_back(locator); });
  return result;
}

TEST(Transport, TheTransportChoosesTheAddressesThatUdpChooses) {
  Recipients recipients;
  Traffic traffic;
  OwnNetworks networks;
  Whereabouts whereabouts(networks, false);
  const auto sparing =
      sparing_udp_transport({recipients, nullptr, traffic, networks, whereabouts, 1'000, false});
  const eprosima::fastdds::rtps::UDPv4TransportDescriptor udp;
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const bool with_groups = random.uniform() < 0.5;
    std::vector<Reader> readers(random.index(30));
    for (Reader& reader : readers) {
      reader.enabled = random.uniform() < 0.8;
      for (std::size_t k = random.index(3); k > 0; --k) reader.unicast.push_back(3 * random.index(5) + k);
      if (with_groups && random.uniform() < 0.3) reader.multicast.push_back(random.index(2));
    }
    EXPECT_EQ(chosen(*sparing, readers), chosen(udp, readers)) << "seed " << seed;
  }
}

TEST(Transport, AMereParticipantAnnouncementIsRecognised) {
  const auto number = announcement_in(header + info_timestamp + announcement + of_a_vendor);
  ASSERT_TRUE(number);
  EXPECT_EQ(announcement_in(header + announcement), number);
  EXPECT_NE(announcement_in(header + data(0x05, 0xc2, 8)), number);
  EXPECT_FALSE(announcement_in(header + announcement + heartbeat)) << "the message holds more";
  EXPECT_FALSE(announcement_in(header + announcement + announcement));
  EXPECT_FALSE(announcement_in(header + data(0x09, 0xc2, 7))) << "only a key: the participant leaves";
  EXPECT_FALSE(announcement_in(header + data(0x05, 0x02, 7))) << "from another writer";
  EXPECT_FALSE(announcement_in(header + info_timestamp));
}

Bytes heartbeat_of(std::uint8_t writer_kind, std::uint8_t last) {
  return Bytes{0x07, 0x01, 28, 0, 0, 0, 0, 0, 0, 0, writer_kind, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0} +
         Bytes{last, 0, 0, 0, 9, 0, 0, 0};
}

/// The announcement of the participant of that number. It wants to hear of others at 10.1.2.3:7410, and reads
/// data at another address.
Bytes announcement_of(std::uint8_t participant) {
  const auto locator = [](std::uint8_t id, std::uint8_t port) {
    return Bytes{id, 0, 24, 0, 1, 0, 0, 0, port, 0x1c, 0, 0} + Bytes(12, 0) + Bytes{10, 1, 2, 3};
  };
  Bytes all = header + info_timestamp + Bytes(announcement.begin(), announcement.end() - 4) +
              Bytes{0, 3, 0, 0} + locator(0x31, 0xf3) + locator(0x32, 0xf2) + Bytes{1, 0, 0, 0};
  all[8] = participant;
  const std::size_t at = header.size() + info_timestamp.size();
  all[at + 2] = static_cast<std::uint8_t>(all.size() - at - 4);
  return all;
}

rtps::GuidPrefix_t participant_of(std::uint8_t number) {
  return sender_of(announcement_of(number));
}

TEST(Transport, AnAnnouncementYieldsItsSenderAndItsDiscoveryAddresses) {
  const Bytes whole = announcement_of(9);
  EXPECT_EQ(int{sender_of(whole).value[0]}, 9);
  EXPECT_EQ(int{sender_of(whole).value[11]}, 12);
  EXPECT_EQ(addresses_in(whole), std::vector{address("10.1.2.3", 7410)});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    (void)sender_of(part);  // for the address sanitizer
    EXPECT_LE(addresses_in(part).size(), 1u);
  }
}

// A killed participant and its successor have the same address.
TEST(Transport, ANewParticipantIsToldAllAtItsAddress) {
  Announcements announcements;
  announcements.begin();
  const Announcements::Time now{100s};
  for (const rtps::Locator_t& to : {address("10.1.2.3", 7410), address("127.0.0.1", 7410)}) {
    announcements.hear(announcement_of(1));
    EXPECT_TRUE(announcements.is_due(nullptr, to, 7, now));
    EXPECT_FALSE(announcements.is_due(nullptr, to, 7, now + 1s));
    announcements.hear(announcement_of(1));
    EXPECT_FALSE(announcements.is_due(nullptr, to, 7, now + 1s)) << "the participant is the same";
    announcements.hear(announcement_of(2));
    EXPECT_TRUE(announcements.is_due(nullptr, to, 7, now + 1s));
    announcements.forget(participant_of(1));
    announcements.hear(announcement_of(1));
    EXPECT_TRUE(announcements.is_due(nullptr, to, 7, now + 1s)) << "the participant was gone";
    announcements.forget(participant_of(1));
    announcements.forget(participant_of(2));
  }
  const rtps::Locator_t other = address("10.1.2.3", 7412);
  EXPECT_TRUE(announcements.is_due(nullptr, other, 7, now));
  announcements.hear(announcement_of(1));
  EXPECT_FALSE(announcements.is_due(nullptr, other, 7, now + 1s));
}

TEST(Transport, HeartbeatsOfEndpointsAreRecognised) {
  const auto found = endpoint_heartbeat_in(header + heartbeat_of(3, 5) + of_a_vendor);
  ASSERT_TRUE(found);
  EXPECT_EQ(endpoint_heartbeat_in(header + info_timestamp + heartbeat_of(3, 5)), found);
  EXPECT_NE(endpoint_heartbeat_in(header + heartbeat_of(3, 6)), found);
  EXPECT_NE(endpoint_heartbeat_in(header + heartbeat_of(4, 5)), found);
  EXPECT_FALSE(endpoint_heartbeat_in(header + heartbeat)) << "from another writer";
  EXPECT_FALSE(endpoint_heartbeat_in(header + heartbeat_of(3, 5) + announcement)) << "the message holds more";
  EXPECT_FALSE(endpoint_heartbeat_in(header + heartbeat_of(3, 5) + heartbeat_of(4, 5)));
  EXPECT_FALSE(endpoint_heartbeat_in(header + Bytes{0x0e, 0x01, 12, 0} + Bytes(12, 1) + heartbeat_of(3, 5)))
      << "an answer to one";
  EXPECT_FALSE(endpoint_heartbeat_in(header + info_timestamp));
}

Bytes for_participant(std::uint8_t id) {
  return Bytes{0x0e, 0x01, 12, 0} + Bytes(12, id);
}
// A step of an authentication, for the participant whose GUID is made of `id`.
Bytes handshake(std::uint8_t id, std::uint8_t writer_kind = 0xc3) {
  return Bytes{0x15, 0x05, 100, 0, 0, 0, 16, 0, 0, 2, 1, 0xc4, 0, 2, 1, writer_kind, 0, 0, 0, 0, 1, 0, 0, 0} +
         Bytes(4 + 24 + 24, 7) + Bytes(12, id) + Bytes{0, 0, 1, 0xc1};
}

TEST(Transport, AuthenticationsOfOthersAreRecognised) {
  EXPECT_TRUE(is_handshake_of_others(header + for_participant(1) + info_timestamp + handshake(2)));
  EXPECT_FALSE(is_handshake_of_others(header + for_participant(1) + info_timestamp + handshake(1)));
  EXPECT_FALSE(is_handshake_of_others(header + handshake(2))) << "any receiver may need it";
  EXPECT_FALSE(is_handshake_of_others(header + for_participant(1) + handshake(2, 0x03)))
      << "from another writer";
  EXPECT_FALSE(is_handshake_of_others(header + for_participant(1) + announcement));
}

TEST(Transport, TheParserReadsNoByteBeyondTheMessage) {
  const Bytes whole = header + info_timestamp + announcement + of_a_vendor;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    (void)announcement_in(part);  // for the address sanitizer
  }
  const Bytes beat = header + heartbeat_of(3, 5);
  for (std::size_t size = 0; size < beat.size(); ++size)
    (void)endpoint_heartbeat_in(Bytes(beat.begin(), beat.begin() + static_cast<std::ptrdiff_t>(size)));
  const Bytes step = header + for_participant(1) + handshake(2);
  for (std::size_t size = 0; size < step.size(); ++size) {
    (void)is_handshake_of_others(Bytes(step.begin(), step.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  Bytes far = header + announcement;
  far[22] = far[23] = 0xff;  // its length
  EXPECT_TRUE(announcement_in(far));
}

TEST(Transport, AnnouncementsRepeatRarelyAndStartOnceComplete) {
  const auto all = address("239.255.0.1", 7400);
  const auto one = address("10.0.0.1", 7410);
  const auto other = address("10.0.0.1", 7412);
  Announcements announcements;
  Announcements::Time now{100s};
  const auto due = [&](const rtps::Locator_t& to, std::uint64_t number, Announcements::Time at) {
    return announcements.is_due(nullptr, to, number, at);
  };
  EXPECT_FALSE(due(all, 1, now));
  announcements.begin();
  EXPECT_TRUE(due(all, 1, now));
  EXPECT_TRUE(due(one, 1, now));
  EXPECT_FALSE(due(all, 1, now + 400ms));
  EXPECT_FALSE(due(one, 1, now + 1s));
  EXPECT_TRUE(due(other, 1, now + 1s));
  EXPECT_TRUE(due(all, 2, now + 1s)) << "news";
  EXPECT_FALSE(due(one, 2, now + 1s)) << "it hears the change in the group";
  EXPECT_TRUE(due(all, 2, now + 5s)) << "for new participants";
  EXPECT_TRUE(due(one, 2, now + 12s));
}

TEST(Transport, TheNumberOfEndpointsIsSentSoonAndOnce) {
  const auto one = address("10.0.0.1", 7410);
  const auto other = address("10.0.0.1", 7412);
  const EndpointHeartbeat five{.writer = 0x3c2, .first = 1, .last = 5};
  const EndpointHeartbeat six{.writer = 0x3c2, .first = 1, .last = 6};
  const EndpointHeartbeat readers{.writer = 0x4c2, .first = 1, .last = 5};
  const Announcements::Time now{100s};
  Announcements announcements;
  const auto due = [&](const rtps::Locator_t& to, const EndpointHeartbeat& beat, Announcements::Time at) {
    return announcements.is_due(nullptr, to, beat, at);
  };
  EXPECT_TRUE(due(one, five, now)) << "also during the setup";
  EXPECT_TRUE(due(one, readers, now));
  EXPECT_TRUE(due(other, five, now));
  EXPECT_FALSE(due(one, five, now + 100ms));
  EXPECT_TRUE(due(one, six, now + 100ms)) << "news";
  EXPECT_FALSE(due(one, six, now + 390ms));
  EXPECT_TRUE(due(one, six, now + 400ms));
}

TEST(Transport, AGroupIsAnnouncedToOnEachOfItsNetworks) {
  const auto all = address("239.255.0.1", 7400);
  const auto senders = std::array<char, 2>();
  const auto* const first = reinterpret_cast<const rtps::SenderResource*>(&senders[0]);
  const auto* const second = reinterpret_cast<const rtps::SenderResource*>(&senders[1]);
  Announcements announcements;
  Announcements::Time now{100s};
  announcements.begin();
  EXPECT_TRUE(announcements.is_due(first, all, 1, now));
  EXPECT_TRUE(announcements.is_due(second, all, 1, now));
  EXPECT_FALSE(announcements.is_due(first, all, 1, now + 400ms));
  EXPECT_FALSE(announcements.is_due(second, all, 1, now + 400ms));
}

TEST(Transport, TheFirstAnnouncementsRepeatSoonAndThenRarely) {
  const auto all = address("239.255.0.1", 7400);
  Announcements announcements;
  announcements.begin();
  std::vector<double> told;
  for (int tenth = 0; tenth < 1200; ++tenth) {
    const Announcements::Time now = Announcements::Time{100s} + tenth * 100ms;
    if (announcements.is_due(nullptr, all, 1, now)) told.push_back(0.1 * tenth);
  }
  const std::vector<double> expected{0, 0.5, 1.5, 3.5, 7.5, 15.5, 31.5, 61.5, 91.5};
  ASSERT_EQ(told.size(), expected.size());
  for (std::size_t k = 0; k < told.size(); ++k) EXPECT_NEAR(told[k], expected[k], 1e-9) << k;
}

rtps::ParticipantDiscoveryInfo info(rtps::ParticipantProxyData& data, const RobotName& robot, std::uint8_t id,
                                    const rtps::Locator_t& at) {
  data.m_userData.data_vec(user_data_of(robot));
  data.m_guid.guidPrefix.value[0] = id;
  data.default_locators.unicast.clear();
  data.default_locators.add_unicast_locator(at);
  return rtps::ParticipantDiscoveryInfo(data);
}

/// While limited: whether a state goes to a reader at this address.
bool is_reached(Recipients& recipients, const rtps::Locator_t& at) {
  recipients.note_selection();
  eprosima::fastdds::rtps::LocatorList readers;
  readers.push_back(at);
  rtps::Locators begin(readers.begin());
  const rtps::Locators end(readers.end());
  return recipients.among(begin, end).begin() != recipients.among(begin, end).end();
}

TEST(Transport, RecipientsAreTheNamedAgentsAndAllOtherParticipants) {
  const auto a = address("10.0.0.1", 7411);
  const auto b = address("10.0.0.1", 7413);
  const auto monitor = address("10.0.0.1", 7415);
  Recipients recipients;
  rtps::ParticipantProxyData data{rtps::RTPSParticipantAllocationAttributes()};
  recipients.discover(info(data, "a", 1, a));
  recipients.discover(info(data, "b", 2, b));
  recipients.discover(info(data, "", 3, monitor));
  EXPECT_FALSE(recipients.is_limited());
  {
    const Recipients::Limit limit(recipients, {"z", "b"});
    EXPECT_TRUE(recipients.is_limited());
    EXPECT_FALSE(is_reached(recipients, a));
    EXPECT_TRUE(is_reached(recipients, b));
    EXPECT_TRUE(is_reached(recipients, monitor));
    // A participant that restarted at the same address stays known when its predecessor is given up.
    recipients.discover(info(data, "b", 4, a));
    auto gone = info(data, "a", 1, a);
    gone.status = rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT;
    recipients.discover(gone);
    EXPECT_TRUE(is_reached(recipients, a));
  }
  EXPECT_FALSE(recipients.is_limited());
}

TEST(Transport, OnlyAuthenticatedParticipantsAreAgentsWithSecurity) {
  const auto a = address("10.0.0.1", 7411);
  Recipients recipients(true);
  rtps::ParticipantProxyData data{rtps::RTPSParticipantAllocationAttributes()};
  recipients.discover(info(data, "a", 1, a));
  const rtps::GUID_t agent = data.m_guid;
  const auto reaches = [&](const rtps::Locator_t& at) {
    const Recipients::Limit limit(recipients, {"b"});
    return is_reached(recipients, at);
  };
  EXPECT_TRUE(reaches(a)) << "the participant is unknown";
  recipients.authenticate(agent);
  EXPECT_FALSE(reaches(a));
  // Neither a stranger at the same address nor a forged change changes the owner of the address.
  recipients.discover(info(data, "b", 2, a));
  recipients.discover(info(data, "b", 1, a));
  EXPECT_FALSE(reaches(a));
  auto gone = info(data, "a", 1, a);
  gone.status = rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT;
  recipients.discover(gone);
  EXPECT_TRUE(reaches(a));
}

TEST(Transport, ReadersAndParticipantsMayComeAtAnyTime) {
  const auto a = address("10.0.0.1", 7411);
  const auto b = address("10.0.0.1", 7413);
  Recipients recipients;
  rtps::ParticipantProxyData data{rtps::RTPSParticipantAllocationAttributes()};
  eprosima::fastdds::rtps::LocatorList readers;
  const auto told = [&](std::vector<RobotName> agents) {
    const Recipients::Limit limit(recipients, std::move(agents));
    rtps::Locators begin(readers.begin());
    const rtps::Locators end(readers.end());
    return recipients.among(begin, end).size();
  };
  readers.push_back(a);
  recipients.discover(info(data, "a", 1, a));
  recipients.note_selection();
  EXPECT_EQ(told({"a"}), 1u);
  EXPECT_EQ(told({"b"}), 0u);
  EXPECT_EQ(told({"a"}), 1u) << "the readers were sorted before";
  recipients.discover(info(data, "b", 2, b));
  EXPECT_EQ(told({"b"}), 0u) << "it is no reader yet";
  readers.push_back(b);
  recipients.note_selection();
  EXPECT_EQ(told({"a", "b"}), 2u);
  recipients.discover(info(data, "", 2, b));
  EXPECT_EQ(told({"a"}), 2u) << "it is no agent any more";
}

// If another host has an address that this host has, too, Fast DDS takes it for this host's loopback.
TEST(Transport, TwoAgentsAtOneAddressAreBothReached) {
  const auto shared = address("127.0.0.1", 7411);
  Recipients recipients;
  rtps::ParticipantProxyData data{rtps::RTPSParticipantAllocationAttributes()};
  recipients.discover(info(data, "here", 1, shared));
  recipients.discover(info(data, "on_another_host", 2, shared));
  const auto reaches = [&](const RobotName& robot) {
    const Recipients::Limit limit(recipients, {robot});
    return is_reached(recipients, shared);
  };
  EXPECT_TRUE(reaches("here"));
  EXPECT_TRUE(reaches("on_another_host"));
  EXPECT_FALSE(reaches("c"));
}

TEST(Transport, AnObserverAtTheAddressOfAKilledAgentHearsAll) {
  const auto a = address("10.0.0.1", 7411);
  for (const bool is_secure : {false, true}) {
    Recipients recipients(is_secure);
    rtps::ParticipantProxyData data{rtps::RTPSParticipantAllocationAttributes()};
    const auto come = [&](const RobotName& robot, std::uint8_t id) {
      recipients.discover(info(data, robot, id, a));
      if (is_secure) recipients.authenticate(data.m_guid);
    };
    const auto reaches_a = [&] {
      const Recipients::Limit limit(recipients, {"b"});
      return is_reached(recipients, a);
    };
    come("a", 1);
    EXPECT_FALSE(reaches_a());
    if (is_secure) {
      recipients.discover(info(data, "", 2, a));
      EXPECT_FALSE(reaches_a()) << "a stranger may announce the same";
    }
    come("", 3);
    EXPECT_TRUE(reaches_a());
    come("a", 4);
    EXPECT_TRUE(reaches_a()) << "the observer may still be there";
    auto gone = info(data, "", 3, a);
    gone.status = rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT;
    recipients.discover(gone);
    EXPECT_FALSE(reaches_a()) << "the participant is an agent again";
  }
}

}  // namespace
}  // namespace coppice
