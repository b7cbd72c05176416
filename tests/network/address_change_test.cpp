// Tests of hosts that lose their address, get another one, or get their first one after the fleet has
// started: new processes find the fleet, on the same host and on others, and the fleet stays together.
//
// CTest: RESOURCE_LOCK hosts

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/network/hosts.h"
#include "tests/support.h"

namespace coppice::test {
namespace {

using namespace std::chrono_literals;

constexpr const char* map =
    "type octile\nheight 4\nwidth 12\nmap\n............\n............\n............\n............\n";
constexpr const char* site = R"({"map": "room.map", "radius": 0.4, "max_speed": 2, "robots": [
  {"name": "r1", "start": {"x": 1, "y": 1}}, {"name": "r2", "start": {"x": 1, "y": 3}}]})";

/// `--discovery` of all processes. A server is on host 1.
class ChangingHosts : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (const std::string reason = Hosts::why_not(); !reason.empty()) GTEST_SKIP() << reason;
    hosts = std::make_unique<Hosts>(2);
    folder.write("room.map", map);
    folder.write("site.json", site);
    if (GetParam().find(':') == std::string::npos) return;
    server = hosts->start(1, {program("coppice"), "discovery", "--port", "11811"}, file("server"));
    ASSERT_TRUE(
        within(15s, [&] { return contents(file("server")).find("discovery server") != std::string::npos; }));
  }
  std::string file(const std::string& name) const { return (folder.path() / name).string(); }
  void ip(std::size_t host, const std::string& words) const {
    const Outcome outcome = hosts->on(host, [&] { return shell("ip " + words); });
    ASSERT_EQ(outcome.exit_code, 0) << words << ": " << outcome.output;
  }
  std::vector<std::string> with_discovery(std::vector<std::string> command) const {
    command[0] = program(command[0]);
    command.insert(command.end(), {"--discovery", GetParam()});
    return command;
  }
  /// Service, broker and r1 on host 0; r2 too, or on host 1.
  void start(std::size_t host_of_r2) {
    const auto run = [&](std::size_t host, const std::string& log, const std::vector<std::string>& command) {
      fleet.push_back(hosts->start(host, with_discovery(command), file(log)));
    };
    run(0, "broker", {"tree_broker"});
    run(0, "r1", {"robot_agent", "--name", "r1"});
    run(host_of_r2, "r2", {"robot_agent", "--name", "r2"});
    run(0, "service", {"planner_service", file("site.json"), "--serve", "--quiet"});
  }
  /// A new process gives an order and waits until it is carried out.
  void expect_obeyed(std::size_t host, const std::string& words, const std::string& when) {
    std::vector<std::string> command{"coppice"};
    for (std::size_t at = 0; at < words.size();) {
      const std::size_t end = std::min(words.find(' ', at), words.size());
      command.push_back(words.substr(at, end - at));
      at = end + 1;
    }
    command.insert(command.end(), {"--wait", "--patience", "25"});
    const std::string log = file("command" + std::to_string(++commands));
    const auto process = hosts->start(host, with_discovery(command), log);
    ASSERT_TRUE(within(60s, [&] { return has_ended(process->pid()); })) << when << ": " << contents(log);
    EXPECT_EQ(process->wait(), 0) << when << ": " << contents(log) << contents(file("service"));
  }

  TemporaryFolder folder;
  std::unique_ptr<Hosts> hosts;
  std::unique_ptr<Background> server;
  std::vector<std::unique_ptr<Background>> fleet;
  int commands = 0;
};

TEST_P(ChangingHosts, AFleetOnOneHostIsFoundThereWhateverItsAddress) {
  start(0);
  expect_obeyed(0, "stop", "before");
  expect_obeyed(0, "release", "before");
  if (GetParam().find(':') == std::string::npos) {
    ip(0, "address flush dev eth0");
    expect_obeyed(0, "stop", "without an address");
    expect_obeyed(0, "release", "without an address");
  } else {
    ip(0, "address flush dev eth0");
  }
  ip(0, "address add 10.77.0.99/24 dev eth0");
  expect_obeyed(0, "stop", "with another address");
  ip(0, "address flush dev eth0");
  ip(0, "address add " + Hosts::address(0) + "/24 dev eth0");
  expect_obeyed(0, "release", "with its first address");
  expect_obeyed(0, "send r1 --to 9,1", "in the end");
}

TEST_P(ChangingHosts, AFleetOnTwoHostsStaysTogetherAndIsFoundFromBoth) {
  start(1);
  expect_obeyed(1, "send r1 --to 9,1", "before");
  ip(0, "address flush dev eth0");
  std::this_thread::sleep_for(1s);
  ip(0, "address add 10.77.0.99/24 dev eth0");
  expect_obeyed(1, "stop", "from the other host");
  expect_obeyed(0, "release", "from the host that has changed");
  expect_obeyed(1, "send r2 --to 9,3", "the robot on the other host");
  expect_obeyed(1, "send r1 --to 1,1", "the robot on the host that has changed");
}

/// Discovery that needs no server on another host.
class HostsWithoutAServer : public ChangingHosts {};

TEST_P(HostsWithoutAServer, AFleetThatStartedWithoutANetworkIsFoundOnceThereIsOne) {
  ip(0, "address flush dev eth0");
  start(0);
  expect_obeyed(0, "stop", "without a network");
  ip(0, "address add 10.77.0.99/24 dev eth0");
  expect_obeyed(0, "release", "on the host itself");
  expect_obeyed(1, "send r1 --to 9,1", "from another host");
}

INSTANTIATE_TEST_SUITE_P(ByDiscovery, ChangingHosts,
                         testing::Values("multicast", "static", "10.77.0.2:11811"),
                         [](const auto& discovery) {
                           return discovery.param.find(':') == std::string::npos ? discovery.param
                                                                                 : std::string("server");
                         });

INSTANTIATE_TEST_SUITE_P(ByDiscovery, HostsWithoutAServer, testing::Values("multicast", "static"),
                         [](const auto& discovery) { return discovery.param; });

class LoopbackOnly : public testing::Test {};

TEST_F(LoopbackOnly, ADiscoveryServerServesTheHostItself) {
  if (const std::string reason = Hosts::why_not(); !reason.empty()) GTEST_SKIP() << reason;
  const Hosts hosts(1);
  const TemporaryFolder folder;
  folder.write("room.map", map);
  const auto site_file = folder.write("site.json", site);
  ASSERT_EQ(hosts.on(0, [] { return shell("ip address flush dev eth0").exit_code; }), 0);
  const auto log = [&](const std::string& name) { return folder.path() / name; };
  const auto server = hosts.start(0, {program("coppice"), "discovery", "--port", "11811"}, log("server"));
  ASSERT_TRUE(within(15s, [&] {
    return contents(log("server")).find("only the loopback of this host is up") != std::string::npos;
  })) << contents(log("server"));
  const auto fleet = hosts.start(
      0, {program("coppice"), "serve", site_file.string(), "--domain", "7", "--discovery", "127.0.0.1:11811"},
      log("fleet"));
  const auto command = hosts.start(0,
                                   {program("coppice"), "send", "r1", "--to", "9,1", "--wait", "--patience",
                                    "30", "--domain", "7", "--discovery", "127.0.0.1:11811"},
                                   log("command"));
  ASSERT_TRUE(within(60s, [&] { return has_ended(command->pid()); })) << contents(log("fleet"));
  EXPECT_EQ(command->wait(), 0) << contents(log("command")) << contents(log("fleet"));
  const auto second = hosts.start(0, {program("coppice"), "discovery", "--port", "11811"}, log("second"));
  ASSERT_TRUE(within(20s, [&] { return has_ended(second->pid()); }));
  EXPECT_EQ(second->wait(), 2);
  EXPECT_NE(contents(log("second")).find("another program has UDP port 11811"), std::string::npos)
      << contents(log("second"));
}

}  // namespace
}  // namespace coppice::test
