// Tests of what an agent sends to which peers, and how often.
#include <algorithm>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/robot_agent/agent_run.h"

namespace coppice {
namespace {

/// The state of a robot that heard "a" one control period ago.
RobotState standing(const char* robot, std::uint32_t sequence, double now, const Point2& place) {
  RobotState state = state_of(robot, now, place);
  state.sequence = sequence;
  state.echoes = {{"a", now - 0.05, now}};
  return state;
}

TEST(RobotAgent, TheStatusReportsTheAgeOfReceivedStates) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  for (const Message& m : map_and_missions(service)) agent.on(arrival_of(m, 0));
  AgentStatus status;
  std::uint32_t states = 0;
  for (int k = 1; k < 200; ++k) {
    const double now = 0.05 * k;
    if (k % 4 == 0) {
      ++states;
      agent.on(arrival_of(standing("b", states, now, {20, 20}), now));
    }
    for (const Message& m : messages(agent.step(now + 0.001))) {
      if (const auto* said = std::get_if<AgentStatus>(&m)) status = *said;
    }
  }
  EXPECT_NEAR(status.load.states_received, states, 4);
  EXPECT_GT(status.load.samples_received, status.load.states_received);
  EXPECT_LE(status.load.state_age_p50, 0.12);
  EXPECT_GE(status.load.state_age_p99, 0.12);
  EXPECT_LE(status.load.state_age_max, 0.25);
  EXPECT_GE(status.load.state_age_max, status.load.state_age_p99);
  EXPECT_EQ(status.load.periods_missed, 0u);
}

// States of distant robots come rarely by design (send_interval.h). Their age says nothing about the network.
TEST(RobotAgent, TheAgeOfADistantRobotsStateDoesNotCount) {
  Scenario scenario = two_robots();
  scenario.robots[1].goal = {20, 20};
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("b");
  for (const Message& m : map_and_missions(service)) agent.on(arrival_of(m, 0));
  AgentStatus status;
  for (int k = 1; k < 200; ++k) {
    const double now = 0.05 * k;
    RobotState far = state_of("a", now, {20, 79});
    far.sequence = static_cast<std::uint32_t>(k);
    far.echoes = {{"b", now - 0.05, now}};
    if (k % 40 == 0 || k < 10) agent.on(arrival_of(far, now));
    for (const Message& m : messages(agent.step(now + 0.001))) {
      if (const auto* said = std::get_if<AgentStatus>(&m)) status = *said;
    }
  }
  EXPECT_EQ(status.load.state_age_max, 0);
}

/// Steps two agents that hear each other whenever they ask, each time `late` seconds late. Returns what "a"
/// sends.
std::vector<RobotState> said_to_one_other(RobotAgent& a, RobotAgent& b, double from, double until,
                                          double late) {
  std::vector<RobotState> said;
  double now = from;
  while (now < until) {
    for (RobotAgent* agent : {&a, &b}) {
      if (agent->next_wake() > now) continue;
      for (const Message& message : messages(agent->step(now))) {
        const auto* const state = std::get_if<RobotState>(&message);
        if (state == nullptr && !std::holds_alternative<ReservationMessage>(message)) continue;
        (agent == &a ? b : a).on(arrival_of(message, now));
        if (agent == &a && state != nullptr) said.push_back(*state);
      }
    }
    now = std::max(now + 0.001, std::min(a.next_wake(), b.next_wake()) + late);
  }
  return said;
}

/// The number of times that each state was sent.
std::map<std::uint32_t, int> copies_of(const std::vector<RobotState>& said) {
  std::map<std::uint32_t, int> copies;
  for (const RobotState& state : said) ++copies[state.sequence];
  return copies;
}

TEST(RobotAgent, AnOverloadedAgentSendsEachDecisionOnceOrAsOftenAsPromised) {
  Scenario scenario = two_robots();
  scenario.robots[0].max_speed = scenario.robots[1].max_speed = 1;  // so that it drives all the time
  PlannerService service(scenario, {}, 0);
  RobotAgent a("a");
  RobotAgent b("b");
  a.step(0);
  b.step(0);
  for (const Message& message : map_and_missions(service)) {
    for (RobotAgent* agent : {&a, &b}) agent->on(arrival_of(message, 0));
  }
  const auto usually = said_to_one_other(a, b, 0, 5, 0);
  EXPECT_GE(copies_of(usually).rbegin()->second, 3);  // one listener and no known loss
  const auto hardly = said_to_one_other(a, b, 5, 10, 0.12);
  EXPECT_EQ(copies_of(hardly).rbegin()->second, 1);
  EXPECT_EQ(hardly.back().copies, 1);
  const auto again = said_to_one_other(a, b, 10, 15, 0);
  EXPECT_GE(copies_of(again).rbegin()->second, 3);

  // A state is sent at least as often as the state before it promised.
  std::vector<RobotState> all = usually;
  all.insert(all.end(), hardly.begin(), hardly.end());
  all.insert(all.end(), again.begin(), again.end());
  const auto copies = copies_of(all);
  for (std::size_t k = 1; k < all.size(); ++k) {
    const bool same = all[k].sequence == all[k - 1].sequence;
    EXPECT_TRUE(same || copies.at(all[k].sequence) >= all[k - 1].copies) << all[k].sequence;
  }
}

/// The states of an agent that nobody hears from 3 s to 6 s.
std::vector<RobotState> said_by_one_unheard() {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  for (const Message& message : map_and_missions(service)) agent.on(arrival_of(message, 0));
  std::vector<RobotState> said;
  for (double now = 0.1; now < 12; now += 0.05) {
    RobotState other = state_of("b", now, {20, 20});
    if (now < 3 || now > 6) other.echoes.push_back({"a", now, now});
    agent.on(arrival_of(other, now));
    for (const RobotState& state : of<RobotState>(run(agent, now, now + 0.05))) said.push_back(state);
  }
  return said;
}

// It may have missed that a peer failed meanwhile.
TEST(RobotAgent, AnUnheardAgentAsksForNewsWhenItIsHeardAgain) {
  const std::vector<RobotState> said = said_by_one_unheard();
  const auto asks = [&](double from, double until) {
    return std::ranges::count_if(said, [&](const RobotState& s) {
      return s.promise.stamp > from && s.promise.stamp < until && s.is_new;
    });
  };
  EXPECT_EQ(asks(0, 6), 0);
  EXPECT_GE(asks(6, 8), 4);
  EXPECT_EQ(asks(8, 12), 0);
}

// A peer that declares this robot failed relies on the promised number of copies.
TEST(RobotAgent, AnAgentThatAsksForNewsKeepsItsPromiseOfCopies) {
  const std::vector<RobotState> said = said_by_one_unheard();
  const auto copies = copies_of(said);
  int promised = 0;
  for (std::size_t k = 1; k < said.size(); ++k) {
    if (said[k].sequence == said[k - 1].sequence) continue;
    EXPECT_GE(copies.at(said[k].sequence), said[k - 1].copies) << said[k].sequence;
    promised += said[k].is_new && said[k].copies > 1;
  }
  EXPECT_GT(promised, 0);
}

// Nobody acknowledges relayed states.
TEST(RobotAgent, AReturningPeerIsToldOfFailedRobotsOftenEnoughToHear) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent a("a");
  for (const Message& m : map_and_missions(service)) a.on(arrival_of(m, 0));
  std::map<int, int> told;  // step -> number of relayed states
  for (int k = 1; k < 240; ++k) {
    const double now = 0.05 * k;
    const auto hear = [&](const char* robot, const Point2& place) {
      a.on(arrival_of(standing(robot, static_cast<std::uint32_t>(k), now, place), now));
    };
    if (now < 1) hear("c", {60, 20});
    if (now < 5 || now > 8) hear("b", {20, 20});
    for (const Outgoing& said : a.step(now + 0.001)) {
      const auto* state = std::get_if<RobotState>(&said.message);
      const bool is_for_b = said.agents == std::vector<RobotName>{"b"};
      if (state && state->robot == "c" && state->passed_on && is_for_b) ++told[k];
    }
  }
  ASSERT_GE(told.size(), 3u);
  for (const auto& [step, times] : told) EXPECT_GE(times, 3) << step;  // one listener and no known loss
}

// Nothing was heard of what b wants to reserve. Messages take 0.2 s.
TEST(RobotAgent, ARobotThatWaitsForItsTurnBindsItselfToStandForLongerThanAStateTakes) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  for (const Message& message : map_and_missions(service)) agent.on(arrival_of(message, 0));
  RobotState last;
  for (double now = 0.5; now < 4; now += 0.1) {
    RobotState other = state_of("b", now - 0.2, {20, 20});
    other.phase = Phase::driving;
    other.echoes = {{"a", now - 0.4, now - 0.2}};
    agent.on(arrival_of(other, now));
    for (const RobotState& state : of<RobotState>(run(agent, now, now + 0.1))) last = state;
  }
  EXPECT_TRUE(last.promise.velocity.isZero(0));
  EXPECT_EQ(last.reservation, 0u);
  EXPECT_GT(last.promise.expiry - last.promise.stamp, 0.6);
}

}  // namespace
}  // namespace coppice
