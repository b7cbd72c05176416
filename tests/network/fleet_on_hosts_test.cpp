// Fleets of real processes on several hosts, over networks that are as they should be and as they should not.

#include "tests/network/fleet_on_hosts.h"

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace coppice::test {
namespace {

using namespace std::chrono_literals;

class FleetOnHostsTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string reason = Hosts::why_not(); !reason.empty()) GTEST_SKIP() << reason;
  }

  /// On the host, in the list of servers at this place.
  std::unique_ptr<Background> discovery_server(const Hosts& hosts, std::size_t host, int place) const {
    auto server = hosts.start(host,
                              {program("coppice"), "discovery", "--address", Hosts::address(host), "--port",
                               "11811", "--place", std::to_string(place)},
                              folder.path() / ("server" + std::to_string(place)));
    EXPECT_TRUE(within(10s, [&] {
      return contents(folder.path() / ("server" + std::to_string(place))).find("discovery server") !=
             std::string::npos;
    }));
    return server;
  }
  static std::string server_on(std::size_t host) { return Hosts::address(host) + ":11811"; }

  TemporaryFolder folder;
};

TEST_F(FleetOnHostsTest, MeetsByMulticastAndArrives) {
  const Hosts hosts(3);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 6, .domain = 160, .time_scale = 4});
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, WithoutMulticastMeetsThroughADiscoveryServer) {
  Hosts hosts(3);
  hosts.links("multicast off");
  const auto server = discovery_server(hosts, 1, 0);
  FleetOnHosts fleet(
      hosts,
      {.scenario = "rooms-20", .robots = 6, .domain = 161, .discovery = server_on(1), .time_scale = 4});
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, ServersMayBeNamedAsInRos) {
  Hosts hosts(2);
  hosts.links("multicast off");
  const auto server = discovery_server(hosts, 1, 0);
  ASSERT_EQ(setenv("ROS_DISCOVERY_SERVER", server_on(1).c_str(), 1), 0);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 2, .domain = 162, .time_scale = 4});
  unsetenv("ROS_DISCOVERY_SERVER");
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, OneOfTwoDiscoveryServersMayDie) {
  Hosts hosts(3);
  hosts.links("multicast off");
  const auto first = discovery_server(hosts, 1, 0);
  const auto second = discovery_server(hosts, 2, 1);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20",
                             .robots = 6,
                             .domain = 163,
                             .discovery = server_on(1) + ";" + server_on(2),
                             .time_scale = 2});
  ASSERT_TRUE(fleet.all_have_paths(60s)) << fleet.last_words();
  first->send(SIGKILL);
  EXPECT_EQ(first->wait(), 128 + SIGKILL);
  EXPECT_FALSE(fleet.all_have_arrived()) << "it is to die in mid-run";
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, ANetworkInTwoPiecesHealsAndEverybodyArrives) {
  Hosts hosts(3);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 6, .domain = 164});
  ASSERT_TRUE(fleet.all_have_paths(60s)) << fleet.last_words();
  std::this_thread::sleep_for(2s);
  for (const std::size_t other : {0u, 1u}) {
    hosts.link(other, 2, "down");
    hosts.link(2, other, "down");
  }
  std::this_thread::sleep_for(4s);
  hosts.links("");
  EXPECT_FALSE(fleet.all_have_arrived()) << "it is to be in mid-run";
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, OverBadLinksAFewArrive) {
  Hosts hosts(3);
  hosts.links("loss 20% delay 100ms 50ms");
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 6, .domain = 165});
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, AcceptanceTwentyArriveOverBadLinks) {
  Hosts hosts(5);
  hosts.links("loss 20% delay 100ms 50ms");
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 20, .domain = 166});
  fleet.expect_good_end();
  std::cout << hosts.end();
}

}  // namespace
}  // namespace coppice::test
