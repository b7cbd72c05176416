// Tests of fleets of real processes on several hosts, over good and bad networks.
//
// CTest: RESOURCE_LOCK hosts

#include "tests/network/fleet_on_hosts.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice::test {
namespace {

using namespace std::chrono_literals;

class FleetOnHostsTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string reason = Hosts::why_not(); !reason.empty()) GTEST_SKIP() << reason;
  }

  /// Starts a discovery server on the host, with this place in the list of servers.
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

TEST_F(FleetOnHostsTest, TheFleetMeetsByMulticastAndArrives) {
  const Hosts hosts(3);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 6, .time_scale = 4});
  fleet.expect_good_end();
}

// As bridges to containers have them: these addresses lead nowhere else, and come before the address in the
// common network.
TEST_F(FleetOnHostsTest, HostsThatShareAddressesArrive) {
  const Hosts hosts(2);
  for (std::size_t host = 0; host < hosts.size(); ++host) {
    hosts.on(host, [] {
      for (int k = 0; k < 6; ++k)
        ASSERT_EQ(shell("ip address add 172.17." + std::to_string(k) + ".1/24 dev lo").exit_code, 0);
    });
  }
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 6, .time_scale = 4});
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, TheFleetMeetsThroughADiscoveryServerWithoutMulticast) {
  Hosts hosts(3);
  hosts.links("multicast off");
  const auto server = discovery_server(hosts, 1, 0);
  FleetOnHosts fleet(hosts,
                     {.scenario = "rooms-20", .robots = 6, .discovery = server_on(1), .time_scale = 4});
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, ServersMayBeNamedAsInRos) {
  Hosts hosts(2);
  hosts.links("multicast off");
  const auto server = discovery_server(hosts, 1, 0);
  ASSERT_EQ(setenv("ROS_DISCOVERY_SERVER", server_on(1).c_str(), 1), 0);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 2, .time_scale = 4});
  unsetenv("ROS_DISCOVERY_SERVER");
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, OneOfTwoDiscoveryServersMayFail) {
  Hosts hosts(3);
  hosts.links("multicast off");
  const auto first = discovery_server(hosts, 1, 0);
  const auto second = discovery_server(hosts, 2, 1);
  FleetOnHosts fleet(
      hosts,
      {.scenario = "rooms-20", .robots = 6, .discovery = server_on(1) + ";" + server_on(2), .time_scale = 2});
  ASSERT_TRUE(fleet.all_have_paths(60s)) << fleet.log_end();
  first->send(SIGKILL);
  EXPECT_EQ(first->wait(), 128 + SIGKILL);
  EXPECT_FALSE(fleet.all_have_arrived()) << "the server must end during the run";
  fleet.expect_good_end();
}

TEST_F(FleetOnHostsTest, APartitionedNetworkHealsAndAllRobotsArrive) {
  Hosts hosts(3);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 6});
  ASSERT_TRUE(fleet.all_have_paths(60s)) << fleet.log_end();
  std::this_thread::sleep_for(2s);
  for (const std::size_t other : {0u, 1u}) {
    hosts.link(other, 2, "down");
    hosts.link(2, other, "down");
  }
  std::this_thread::sleep_for(4s);
  hosts.links("");
  EXPECT_FALSE(fleet.all_have_arrived()) << "the partition must begin during the run";
  fleet.expect_good_end();
}

constexpr const char* bad_links = "loss 20% delay 100ms 50ms";

/// Different for each --gtest_random_seed.
std::uint64_t seed() {
  return static_cast<std::uint64_t>(testing::UnitTest::GetInstance()->random_seed());
}

TEST_F(FleetOnHostsTest, AFewRobotsArriveOverBadLinks) {
  Hosts hosts(3, seed());
  hosts.links(bad_links);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 6});
  fleet.expect_good_end();
}

/// Four robots on each host: 160 of the 190 pairs of robots meet over bad links.
TEST_F(FleetOnHostsTest, TwentyRobotsArriveOverBadLinks) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  Hosts hosts(5, seed());
  hosts.links(bad_links);
  FleetOnHosts fleet(hosts, {.scenario = "rooms-20", .robots = 20});
  fleet.expect_good_end();
}

class MeetingTest : public FleetOnHostsTest, public testing::WithParamInterface<const char*> {};

/// The test does not measure speed. It checks that all processes meet, with the map in fragments and hundreds
/// of trees, in a time that tells repetition from luck.
TEST_P(MeetingTest, ProcessesMeetOverBadLinks) {
  constexpr std::size_t agents = 6;
  Hosts hosts(3, seed());
  const auto server = discovery_server(hosts, 0, 0);
  hosts.links(bad_links);
  const std::string discovery = GetParam() == std::string("server") ? server_on(0) : GetParam();
  std::vector<std::filesystem::path> logs;
  std::vector<std::unique_ptr<Background>> processes;
  const auto start = [&](std::size_t host, const std::string& role, const std::string& name) {
    logs.push_back(folder.path() / name);
    processes.push_back(hosts.start(host,
                                    {std::string(COPPICE_TEST_BIN_DIR) + "/meeting_probe", role, name,
                                     "--discovery", discovery, "--agents", std::to_string(agents)},
                                    logs.back()));
  };
  start(2, "broker", "broker");
  for (std::size_t k = 0; k < agents; ++k) start(k % 3, "agent", "r" + std::to_string(k));
  start(0, "service", "service");
  const auto all_say = [&](const std::string& word, std::size_t first, std::size_t count) {
    return std::all_of(logs.begin() + static_cast<std::ptrdiff_t>(first),
                       logs.begin() + static_cast<std::ptrdiff_t>(first + count),
                       [&](const auto& log) { return contents(log).find(word) != std::string::npos; });
  };
  EXPECT_TRUE(within(40s, [&] { return all_say("matched", 0, agents + 2); }));
  EXPECT_TRUE(within(20s, [&] { return all_say("map", 1, agents) && all_say("trees", 1, agents); }));
  for (const auto& log : logs) std::cout << log.filename() << ": " << contents(log);
}

INSTANTIATE_TEST_SUITE_P(Ways, MeetingTest, testing::Values("multicast", "static", "server"));

}  // namespace
}  // namespace coppice::test
