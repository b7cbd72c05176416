// Tests that only an agent itself may speak for its robot.
//
// CTest: RESOURCE_LOCK lane_1

#include <chrono>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "dds/dds_bus.h"
#include "dds/discovery_server.h"
#include "dds/senders.h"
#include "tests/domains.h"
#include "tests/network/samples.h"

namespace coppice {
namespace {

using Clock = std::chrono::steady_clock;

/// From a participant that is nameless or speaks for another robot, only relayed states are accepted.
void only_its_own_agent_speaks_for_a_robot(const std::string& discovery, int on) {
  DdsBus honest({.domain = on, .robot = "r1", .discovery = discovery}, Role::agent, "r1");
  DdsBus forger({.domain = on, .robot = "r2", .discovery = discovery}, Role::agent, "r2");
  DdsBus nobody({.domain = on, .discovery = discovery}, Role::agent, "nobody");
  DdsBus service({.domain = on, .discovery = discovery}, Role::service, "service");
  DdsBus listener({.domain = on, .robot = "r3", .discovery = discovery}, Role::agent, "r3");
  const auto track = [](std::uint32_t first) {
    return TrackMessage{"r1", 1, first, {{0.05, {1, 1}, {2, 0}}}};
  };
  // The topic is reliable and kept: in any order of discovery, only the honest message arrives.
  forger.publish(track(8));
  nobody.publish(track(9));
  honest.publish(track(1));
  const auto at_service =
      receive(service, [&](const auto& all) { return !all.empty() && service.rejected() >= 2; });
  EXPECT_EQ(at_service, std::vector<Message>{track(1)});
  EXPECT_EQ(service.rejected(), 2u);

  std::set<bool> passed_on;
  std::set<std::uint32_t> sequences;
  const auto end = Clock::now() + std::chrono::seconds(20);
  const auto enough = [&] {
    return sequences.size() >= 10 && passed_on.size() == 2 && listener.rejected() >= 4;
  };
  for (std::uint32_t k = 1; !enough() && Clock::now() < end; ++k) {
    RobotState state = some_state(10 * k);
    forger.publish(Message(state));  // as a relayed state
    state.passed_on = state.counts_as_failed = false;
    honest.publish(Message(state));
    state.sequence = 10 * k + 1;
    forger.publish(Message(state));
    nobody.publish(Message(state));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    for (const Arrival& arrival : listener.take()) {
      const auto* s = std::get_if<RobotState>(arrival.message.get());
      if (s == nullptr) continue;
      EXPECT_EQ(s->sequence % 10, 0u);
      sequences.insert(s->sequence);
      passed_on.insert(s->passed_on);
    }
  }
  EXPECT_TRUE(enough()) << sequences.size() << ' ' << passed_on.size() << ' ' << listener.rejected();
}

class SendersByDiscovery : public testing::TestWithParam<const char*> {};

TEST_P(SendersByDiscovery, OnlyTheOwnAgentSpeaksForARobot) {
  only_its_own_agent_speaks_for_a_robot(GetParam(), test::own_domain());
}

INSTANTIATE_TEST_SUITE_P(Senders, SendersByDiscovery, testing::Values(multicast_discovery, static_discovery));

TEST(Senders, OnlyTheOwnAgentSpeaksForARobotWithADiscoveryServer) {
  const DdsDiscoveryServer server("127.0.0.1", 23919, 0);
  only_its_own_agent_speaks_for_a_robot("127.0.0.1:23919", test::own_domain());
}

TEST(Senders, AMessageSentBeforeItsSenderLeftIsStillAccepted) {
  DdsBus service({.domain = test::own_domain()}, Role::service, "service");
  {
    DdsBus agent({.domain = test::own_domain(), .robot = "r1"}, Role::agent, "r1");
    const auto end = Clock::now() + std::chrono::seconds(10);
    agent.publish(TrackMessage{"r1", 1, 0, {}});
    while (!service.wait(0.1) && Clock::now() < end) {
    }
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(service.take().size(), 1u);
  EXPECT_EQ(service.rejected(), 0u);
}

}  // namespace
}  // namespace coppice
