// Tests of where participants are whose hosts have got other addresses.
#include "dds/whereabouts.h"

#include <string>
#include <vector>

#include <fastrtps/utils/IPLocator.h>
#include <gtest/gtest.h>

namespace coppice {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

rtps::Locator_t at(const std::string& address, std::uint32_t port) {
  rtps::Locator_t locator(LOCATOR_KIND_UDPv4, port);
  rtps::IPLocator::setIPv4(locator, address);
  return locator;
}

rtps::GuidPrefix_t participant(std::uint8_t number) {
  rtps::GuidPrefix_t prefix;
  prefix.value[0] = number;
  return prefix;
}

class WhereaboutsTest : public testing::Test {
 protected:
  void announce(std::uint8_t number, const std::string& address, bool gone = false) {
    rtps::RTPSParticipantAllocationAttributes allocation;
    rtps::ParticipantProxyData data(allocation);
    data.m_guid.guidPrefix = participant(number);
    data.metatraffic_locators.add_unicast_locator(at(address, 7410));
    data.default_locators.add_unicast_locator(at(address, 7411));
    rtps::ParticipantDiscoveryInfo info(data);
    info.status = gone ? info.DROPPED_PARTICIPANT : info.DISCOVERED_PARTICIPANT;
    whereabouts.discover(info);
  }
  void hear(std::uint8_t number, const std::string& address) {
    whereabouts.hear(participant(number), at(address, 40000));
  }
  /// Where a message to that address goes.
  std::vector<std::string> goes_to(const std::string& address) const {
    eprosima::fastdds::rtps::LocatorList list;
    list.push_back(at(address, 7411));
    const std::vector<rtps::Locator_t> present = whereabouts.present_of(list);
    std::vector<std::string> all;
    const auto add = [&](const rtps::Locator_t& locator) {
      EXPECT_EQ(locator.port, 7411u);
      all.push_back(rtps::IPLocator::toIPv4string(locator));
    };
    for (const rtps::Locator_t& locator : list) add(locator);
    for (const rtps::Locator_t& locator : present) add(locator);
    return all;
  }

  using Places = std::vector<std::string>;
  OwnNetworks networks;
  Whereabouts whereabouts{networks, false};
};

TEST_F(WhereaboutsTest, AParticipantThatSpeaksFromWhereItAnnouncesItselfIsThere) {
  announce(1, "192.0.2.5");
  EXPECT_EQ(goes_to("192.0.2.5"), Places({"192.0.2.5"}));
  hear(1, "192.0.2.5");
  hear(9, "192.0.2.77");  // of which nothing is known
  EXPECT_EQ(goes_to("192.0.2.5"), Places({"192.0.2.5"}));
}

TEST_F(WhereaboutsTest, MessagesGoAlsoToWhereAParticipantSpeaksFrom) {
  announce(1, "192.0.2.5");
  hear(1, "192.0.2.77");
  EXPECT_EQ(goes_to("192.0.2.5"), Places({"192.0.2.5", "192.0.2.77"}));
  hear(1, "192.0.2.78");
  EXPECT_EQ(goes_to("192.0.2.5"), Places({"192.0.2.5", "192.0.2.78"}));
  hear(1, "192.0.2.5");
  EXPECT_EQ(goes_to("192.0.2.5"), Places({"192.0.2.5"})) << "it is back";
}

TEST_F(WhereaboutsTest, AParticipantOfThisHostIsReachedThroughTheLoopbackAlone) {
  announce(1, "192.0.2.5");
  hear(1, "127.0.0.1");
  EXPECT_EQ(goes_to("192.0.2.5"), Places({"127.0.0.1"}));
  announce(2, "192.0.2.5");  // another host has got this address since
  hear(2, "192.0.2.5");
  EXPECT_EQ(goes_to("192.0.2.5"), Places({"192.0.2.5", "127.0.0.1"}));
}

TEST_F(WhereaboutsTest, ASourceDoesNotTakeThePlaceOfAnAddressIfOthersMayBeHostile) {
  Whereabouts secure(networks, true);
  rtps::RTPSParticipantAllocationAttributes allocation;
  rtps::ParticipantProxyData data(allocation);
  data.m_guid.guidPrefix = participant(1);
  data.default_locators.add_unicast_locator(at("192.0.2.5", 7411));
  secure.discover(rtps::ParticipantDiscoveryInfo(data));
  secure.hear(participant(1), at("127.0.0.1", 40000));
  eprosima::fastdds::rtps::LocatorList list;
  list.push_back(at("192.0.2.5", 7411));
  EXPECT_EQ(secure.present_of(list).size(), 1u);
  EXPECT_EQ(list.size(), 1u);
}

// Its messages may come from any of this host's addresses.
TEST_F(WhereaboutsTest, AParticipantOfThisHostHasNotMovedIfItAnnouncedAnAddressOfThisHost) {
  announce(1, "127.0.0.1");
  hear(1, "127.0.0.2");
  EXPECT_EQ(goes_to("127.0.0.1"), Places({"127.0.0.1"}));
}

TEST_F(WhereaboutsTest, AParticipantThatHasGoneIsForgotten) {
  announce(1, "192.0.2.5");
  hear(1, "127.0.0.1");
  announce(1, "192.0.2.5", true);
  EXPECT_EQ(goes_to("192.0.2.5"), Places({"192.0.2.5"}));
}

}  // namespace
}  // namespace coppice
