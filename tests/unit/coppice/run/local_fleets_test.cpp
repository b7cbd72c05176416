#include "coppice/run/local_fleets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "dds/discovery.h"

namespace coppice {
namespace {

/// A machine as the kernel shows it.
class Machine {
 public:
  /// Joins a domain as DDS does. `is_visible`: whether the process may be inspected.
  void join(int domain, int participant, const std::vector<std::string>& arguments, bool is_visible = true) {
    LocalProcess process{arguments, {}};
    for (const int port : {domain_port(domain), participant_port(domain, participant),
                           participant_port(domain, participant) + 1})
      process.sockets.insert(open(port));
    if (is_visible) processes_.push_back(process);
  }
  std::uint64_t open(int port) {
    table_ += fmt::format(
        "  {}: 00000000:{:04X} 00000000:0000 07 00000000:00000000 00:00000000 00000000  1000"
        "        0 {} 2 0000000000000000 0\n",
        next_, port, next_);
    return next_++;
  }
  std::vector<LocalFleet> fleets() const { return fleets_among(table_, processes_); }

 private:
  std::string table_ =
      "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode ref "
      "pointer drops\n";
  std::vector<LocalProcess> processes_;
  std::uint64_t next_ = 100;
};

std::string refusal(DdsSettings settings, const std::vector<LocalFleet>& fleets) {
  try {
    choose_fleet(settings, fleets, "coppice top");
  } catch (const InputError& refused) {
    return refused.what();
  }
  return {};
}

TEST(LocalFleets, AFleetIsFoundByThePortsOfItsProcesses) {
  Machine machine;
  machine.open(53);
  machine.join(37, 0, {"/usr/bin/tree_broker", "--domain", "37"});
  machine.join(37, 1, {"robot_agent", "--name", "r1", "--domain", "37", "--discovery", "static"});
  machine.join(37, 2, {"/opt/robot_agent", "--name", "r2", "--domain", "37"});
  const auto fleets = machine.fleets();
  ASSERT_EQ(fleets.size(), 1u);
  EXPECT_EQ(in_words(fleets[0]), "domain 37: 2 robot agents, 1 other role");
  DdsSettings network;
  EXPECT_EQ(choose_fleet(network, fleets, "coppice top"),
            "takes the fleet that is alive on this machine, domain 37: 2 robot agents, 1 other role");
  EXPECT_EQ(network.domain, 37);
  EXPECT_EQ(network.discovery, "static") << "as in the command line of the fleet";
}

TEST(LocalFleets, DiscoveryServersAreReadFromTheFleetsEnvironment) {
  const std::vector<LocalProcess> processes{{{"robot_agent", "--name", "r1"}, {7}, "10.0.0.1:11811"}};
  const std::string table = fmt::format(
      "heading\n 1: 00000000:{:04X} 00000000:0000 07 00000000:00000000 00:00000000 00000000 0 0 7 2 0 0\n",
      domain_port(5));
  const auto fleets = fleets_among(table, processes);
  ASSERT_EQ(fleets.size(), 1u);
  EXPECT_EQ(fleets[0].discovery, "10.0.0.1:11811");
}

TEST(LocalFleets, ObserversAloneAreNoFleet) {
  Machine machine;
  machine.join(0, 0, {"coppice", "monitor"});
  machine.join(4, 0, {"coppice", "record", "a.mcap"});
  machine.join(9, 0, {"/usr/bin/talker"});
  EXPECT_TRUE(machine.fleets().empty());
  machine.join(5, 0, {"coppice", "replay", "a.mcap"});
  ASSERT_EQ(machine.fleets().size(), 1u);
  EXPECT_EQ(machine.fleets()[0].domain, 5);
}

TEST(LocalFleets, TheFleetOfAnotherUserCounts) {
  Machine machine;
  machine.join(12, 0, {}, false);
  const auto fleets = machine.fleets();
  ASSERT_EQ(fleets.size(), 1u);
  EXPECT_EQ(fleets[0].domain, 12);
  EXPECT_FALSE(fleets[0].is_seen);
  machine.join(13, 0, {"planner_service"});
  DdsSettings network;
  choose_fleet(network, machine.fleets(), "coppice top");
  EXPECT_EQ(network.domain, 13) << "a certain fleet goes before an uncertain one";
}

TEST(LocalFleets, AnEphemeralPortIsNoDomain) {
  Machine machine;
  machine.open(domain_port(120));
  EXPECT_TRUE(machine.fleets().empty());
}

// From the 120th participant on, the ports are those of the next domain.
TEST(LocalFleets, ManyProcessesOfOneDomainAreNotTakenForAnother) {
  for (const bool is_visible : {true, false}) {
    Machine machine;
    for (int k = 0; k < 300; ++k) machine.join(7, k, {"robot_agent", "--domain", "7"}, is_visible);
    const auto fleets = machine.fleets();
    ASSERT_EQ(fleets.size(), 1u) << is_visible;
    EXPECT_EQ(fleets[0].domain, 7);
  }
}

TEST(LocalFleets, TheUserChoosesBetweenSeveralFleets) {
  Machine machine;
  machine.join(3, 0, {"robot_agent"});
  machine.join(8, 0, {"robot_agent", "--discovery=127.0.0.1:11811;127.0.0.1:11812"});
  machine.join(9, 0, {"robot_agent", "--security", "keys/agent"});
  EXPECT_EQ(
      refusal({}, machine.fleets()),
      "3 fleets are alive on this machine, choose one:\n"
      "  coppice top --domain 3   # domain 3: 1 robot agent, 0 other roles\n"
      "  coppice top --domain 8 --discovery '127.0.0.1:11811;127.0.0.1:11812'   # domain 8: 1 robot agent, "
      "0 other roles\n"
      "  coppice top --domain 9 --security KEYS/observer   # domain 9: 1 robot agent, 0 other roles, "
      "with --security");
}

TEST(LocalFleets, ASecuredFleetIsObservedWithCredentials) {
  Machine machine;
  machine.join(9, 0, {"robot_agent", "--security", "keys/agent"});
  EXPECT_EQ(refusal({}, machine.fleets()),
            "the fleet on domain 9 is secured, expected the observer's credentials: coppice top --domain 9 "
            "--security KEYS/observer");
  DdsSettings network{.security = "keys/observer"};
  choose_fleet(network, machine.fleets(), "coppice top");
  EXPECT_EQ(network.domain, 9);
}

TEST(LocalFleets, TheDefaultDomainIsToldIfNoFleetIsAlive) {
  DdsSettings network;
  EXPECT_EQ(choose_fleet(network, {}, "coppice top"),
            "no fleet is alive on this machine: waits on domain 0 (--domain)");
  EXPECT_EQ(network.domain, 0);
}

TEST(LocalFleets, WordsForAShellAreQuotedWhereNecessary) {
  const std::vector<std::string> words{"a-b/c.d", "two words", "it's", ""};
  EXPECT_EQ(shell_words(words), R"(a-b/c.d 'two words' 'it'\''s' '')");
}

}  // namespace
}  // namespace coppice
