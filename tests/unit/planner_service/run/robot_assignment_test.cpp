// Robot assignment: message by message, and with agents without a name on a bus that loses messages.
#include "planner_service/run/robot_assignment.h"

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/process/claimant.h"
#include "robot_agent/process/nameless_agent.h"
#include "simulation/simulated_bus.h"

namespace coppice {
namespace {

std::vector<Assignment> assignments(const std::vector<Message>& messages) {
  std::vector<Assignment> all;
  for (const Message& m : messages) all.push_back(std::get<Assignment>(m));
  return all;
}

/// An assignment that started long enough ago to assign robots, and that is stepped twice a second.
struct SteppedAssignment {
  explicit SteppedAssignment(const std::vector<RobotName>& robots) : assignment(robots, -5) {}
  std::vector<Assignment> hears(const Message& message, double at) {
    while (now + 0.5 < at) EXPECT_TRUE(assignment.step(now += 0.5).empty()) << now;
    return hears_after_nap(message, at);
  }
  std::vector<Assignment> hears_after_nap(const Message& message, double at) {
    now = at;
    assignment.on(arrival_of(message, now));
    return assignments(assignment.step(now));
  }
  /// The time at which a claimant that begins to ask at `from` is given a robot.
  double gives_one_to(std::uint64_t claimant, double from) {
    std::uint32_t number = 0;
    while (hears_after_nap(Claim{claimant, ++number}, from).empty() && from < now + 100) from += 0.5;
    return now;
  }
  RobotAssignment assignment;
  double now = -5;
};

TEST(RobotAssignment, EachClaimantGetsTheFirstFreeRobot) {
  SteppedAssignment assignment({"a", "b", "c"});
  EXPECT_TRUE(assignment.hears(AgentStatus{.robot = "b"}, 0).empty());
  EXPECT_EQ(assignment.hears(Claim{7, 1}, 0), (std::vector<Assignment>{{"a", 7, 1}}));
  EXPECT_EQ(assignment.hears(Claim{8, 1}, 0), (std::vector<Assignment>{{"c", 8, 1}}));
  EXPECT_TRUE(assignment.hears(Claim{9, 1}, 0).empty());
}

TEST(RobotAssignment, NoRobotIsAssignedBeforeTheServiceHasListened) {
  RobotAssignment assignment({"a"}, 0);
  assignment.on(arrival_of(Claim{7, 1}, 0));
  for (const double now : {0.0, 1.0, 1.9}) EXPECT_TRUE(assignment.step(now).empty());
  EXPECT_LE(assignment.next_wake(), 2.1);
  EXPECT_EQ(assignments(assignment.step(2.1)), (std::vector<Assignment>{{"a", 7, 1}}));
}

TEST(RobotAssignment, EachNewClaimOfTheOwnerIsAnsweredAndNoRepetition) {
  SteppedAssignment assignment({"a", "b"});
  assignment.hears(Claim{7, 1}, 0);
  EXPECT_TRUE(assignment.hears(Claim{7, 1}, 0.1).empty());
  EXPECT_EQ(assignment.hears(Claim{7, 2}, 0.5), (std::vector<Assignment>{{"a", 7, 2}}));
  EXPECT_TRUE(assignment.hears(Claim{7, 1}, 0.6).empty());
  EXPECT_TRUE(assignment.hears(Claim{7, 3, "a"}, 0.7).empty());
  EXPECT_TRUE(assignment.hears(Claim{7, 2}, 0.8).empty());
}

TEST(RobotAssignment, ALeaseThatIsNotRenewedEnds) {
  SteppedAssignment assignment({"a"});
  assignment.hears(Claim{7, 1}, 0);
  assignment.hears(Claim{7, 2, "a"}, 0.1);
  assignment.hears(AgentStatus{.robot = "a"}, 5);
  for (std::uint32_t n = 1; n < 20; ++n) EXPECT_TRUE(assignment.hears(Claim{8, n}, 5 + n * 0.5).empty()) << n;
  EXPECT_EQ(assignment.hears(Claim{8, 20}, 5.1 + claim_lease), (std::vector<Assignment>{{"a", 8, 20}}));
  EXPECT_EQ(assignment.hears(Claim{7, 2, "a"}, 16),
            (std::vector<Assignment>{{"a", 8, 20}}));  // the one before
  EXPECT_EQ(assignment.hears(Claim{8, 21}, 16), (std::vector<Assignment>{{"a", 8, 21}}));
}

TEST(RobotAssignment, AClaimantThatStoppedAskingGetsNothing) {
  SteppedAssignment assignment({"a"});
  assignment.hears(AgentStatus{.robot = "a"}, 0);
  assignment.hears(Claim{7, 1}, 0);
  EXPECT_EQ(assignment.hears(Claim{8, 1}, claim_lease + 1), (std::vector<Assignment>{{"a", 8, 1}}));
}

TEST(RobotAssignment, TheLeaseOfALivingAgentOutlivesAPauseOfTheService) {
  SteppedAssignment assignment({"a"});
  assignment.hears(AgentStatus{.robot = "a"}, 0);
  EXPECT_NEAR(assignment.gives_one_to(8, 60), 60 + claim_lease, 0.6);
}

TEST(RobotAssignment, TheSuccessorKeepsTheLeasesOfItsPredecessor) {
  SteppedAssignment assignment({"a", "b"});
  assignment.hears(Claim{7, 9, "b"}, 0);
  assignment.assignment.recall(std::vector<Message>{AgentStatus{.robot = "a"}}, 0);
  EXPECT_NEAR(assignment.gives_one_to(8, 0.5), claim_lease, 0.6);
}

TEST(RobotAssignment, TheServiceLearnsLeasesFromClaimsAndStatuses) {
  SteppedAssignment assignment({"a", "b"});
  EXPECT_TRUE(assignment.hears(Claim{7, 9, "a"}, 0).empty());
  EXPECT_EQ(assignment.hears(Claim{8, 1}, 0), (std::vector<Assignment>{{"b", 8, 1}}));
  EXPECT_TRUE(assignment.hears(Claim{9, 1, "elsewhere"}, 0).empty());
}

TEST(RobotAssignment, AClaimantGetsAnotherRobotIfAPeerSpeaksAsItsOwn) {
  SteppedAssignment assignment({"a", "b"});
  assignment.hears(Claim{7, 1}, 0);
  assignment.hears(AgentStatus{.robot = "a"}, 0.2);
  EXPECT_EQ(assignment.hears(Claim{7, 2}, 0.5), (std::vector<Assignment>{{"b", 7, 2}}));
}

std::vector<Claim> claims(std::vector<Outgoing> said) {
  std::vector<Claim> all;
  for (const Outgoing& one : said) all.push_back(std::get<Claim>(one.message));
  return all;
}

TEST(Claimant, AClaimantAsksUntilItIsAnswered) {
  Claimant claimant(7);
  EXPECT_EQ(claims(claimant.step(0)), (std::vector<Claim>{{7, 1}}));
  EXPECT_TRUE(claimant.step(0.1).empty());
  EXPECT_EQ(claims(claimant.step(claimant.next_wake())), (std::vector<Claim>{{7, 2}}));
  claimant.on(arrival_of(Assignment{"b", 8, 1}, 0.6));
  claimant.step(0.6);
  EXPECT_FALSE(claimant.robot());
  claimant.on(arrival_of(Assignment{"a", 7, 1}, 0.7));
  EXPECT_LE(claimant.next_wake(), 0.7);
  EXPECT_EQ(claims(claimant.step(0.7)), (std::vector<Claim>{{7, 3, "a"}}));
  EXPECT_EQ(claimant.robot(), "a");
  EXPECT_FALSE(claimant.lost());
}

TEST(Claimant, AnAnswerThatTookTooLongDoesNotCount) {
  Claimant claimant(7);
  claimant.step(0);
  for (double now = 0.5; now < 6; now += 0.5) claimant.step(now);
  claimant.on(arrival_of(Assignment{"a", 7, 1}, 6));
  claimant.step(6);
  EXPECT_FALSE(claimant.robot());
  claimant.on(arrival_of(Assignment{"a", 7, 12}, 6.1));
  claimant.step(6.1);
  EXPECT_EQ(claimant.robot(), "a");
}

TEST(Claimant, AClaimantWaitsWhileAnotherAgentSpeaksAsItsRobot) {
  Claimant claimant(7);
  claimant.step(0);
  claimant.on(arrival_of(RobotState{.robot = "a"}, 0.1));
  claimant.on(arrival_of(Assignment{"a", 7, 1}, 0.2));
  claimant.step(0.2);
  EXPECT_FALSE(claimant.robot());
  claimant.step(0.7);
  claimant.on(arrival_of(RobotState{.robot = "a", .passed_on = true}, 1));  // a relayed state does not count
  claimant.on(arrival_of(Assignment{"a", 9, 1}, 1.05));
  claimant.step(1.2);
  EXPECT_FALSE(claimant.robot());
  claimant.on(arrival_of(Assignment{"a", 7, 2}, 1.3));
  claimant.step(1.3);
  EXPECT_EQ(claimant.robot(), "a");
}

/// The claimant of robot a, since 0.1 s.
Claimant named() {
  Claimant claimant(7);
  claimant.step(0);
  claimant.on(arrival_of(Assignment{"a", 7, 1}, 0.1));
  claimant.step(0.1);
  return claimant;
}

TEST(Claimant, AClaimantLosesItsRobotToAnotherAndBySilence) {
  Claimant replaced = named();
  replaced.on(arrival_of(Assignment{"b", 8, 1}, 1));
  replaced.on(arrival_of(Assignment{"a", 7, 1}, 1));
  EXPECT_FALSE(replaced.lost());
  replaced.on(arrival_of(Assignment{"a", 8, 1}, 2));
  EXPECT_TRUE(replaced.lost());

  Claimant silent = named();
  silent.step(5);
  EXPECT_FALSE(silent.lost());
  silent.step(5.1 + 0.8 * claim_lease);
  EXPECT_TRUE(silent.lost());
}

TEST(Claimant, ClaimsRenewTheLeaseWhileALongJournalIsRead) {
  Claimant claimant = named();
  for (double now = 1; now <= 60; ++now) EXPECT_EQ(claimant.claim(now).robot, "a");
  claimant.step(61);
  EXPECT_FALSE(claimant.lost());
  claimant.claim(61.1 + 0.8 * claim_lease);
  EXPECT_TRUE(claimant.lost());
}

/// An agent that became robot a at 0 s.
NamelessAgent agent_of_a() {
  NamelessAgent agent(7);
  agent.step(0);
  agent.on(arrival_of(Assignment{"a", 7, 1}, 0));
  agent.step(0);
  agent.begin({});
  return agent;
}

std::vector<AgentStatus> statuses(std::vector<Outgoing> said) {
  std::vector<AgentStatus> all;
  for (const Outgoing& one : said) all.push_back(std::get<AgentStatus>(one.message));
  return all;
}

TEST(NamelessAgent, TheAgentReportsTheCountersOfItsBus) {
  NamelessAgent agent = agent_of_a();
  agent.note({.rejected = 3, .agents = 5}, 0);
  const auto said = statuses(agent.step(0));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].rejected, 3u);
  EXPECT_EQ(said[0].load.agents_matched, 5u);
}

/// Agents and a service on a bus that loses and delays messages. They are killed, paused, and restarted.
class ManyClaims {
 public:
  explicit ManyClaims(std::uint64_t seed)
      : random_(seed), bus_(0.001, {.loss = 0.3, .delay = 0.05, .jitter = 0.05}, Random(seed + 1)) {
    start_service();
    for (int k = 0; k < 6; ++k) start_agent();
  }

  void run(double until, bool faults) {
    for (; now_ < until; now_ += 0.02) {
      bus_.set_time(now_);
      if (faults && random_.uniform() < 0.01) disturb();
      turn(service_->port, service_->assignment, nullptr);
      for (std::size_t k = 0; k < agents_.size(); ++k) {
        Agent& agent = agents_[k];
        if (!agent.alive || now_ < agent.stopped_until) continue;
        turn(*agent.port, agent.role, &agent);
        if (agent.role.lost()) replace(agent);  // as the process's supervisor does
      }
    }
  }
  std::set<RobotName> robots_of_the_living() const {
    std::set<RobotName> robots;
    for (const Agent& agent : agents_) {
      if (agent.alive && agent.role.robot()) robots.insert(*agent.role.robot());
    }
    return robots;
  }

 private:
  struct Agent {
    std::size_t id;
    NamelessAgent role;
    SimulatedBus::Port* port;
    bool alive = true;
    double stopped_until = -1;
  };
  struct Service {
    RobotAssignment assignment;
    SimulatedBus::Port& port;
  };

  void start_service() {
    if (service_) service_->port.close();
    service_.emplace(Service{RobotAssignment({"a", "b", "c", "d"}, now_), bus_.attach(Role::service)});
  }
  void start_agent() {
    const std::size_t id = agents_.size() + 1;
    agents_.push_back({id, NamelessAgent(id), &bus_.attach(Role::claimant)});
  }
  void replace(Agent& agent) {
    agent.alive = false;
    agent.port->close();
    start_agent();
  }
  void disturb() {
    Agent& agent = agents_[random_.index(agents_.size())];
    const double kind = random_.uniform();
    if (kind < 0.1) {
      start_service();
    } else if (kind < 0.5) {
      agent.stopped_until = now_ + random_.uniform(0, 20);
    } else if (agent.alive) {
      replace(agent);
    }
  }
  static bool has_no_robot(const NamelessAgent& agent) { return !agent.robot(); }
  static bool has_no_robot(const RobotAssignment&) { return true; }
  static void begin(NamelessAgent& agent) { agent.begin({}); }
  static void begin(RobotAssignment&) {}
  template <class R>
  void turn(SimulatedBus::Port& port, R& role, const Agent* agent) {
    // A resumed agent first has to read what came while it was paused.
    const bool deaf = agent != nullptr && now_ < agent->stopped_until + 0.2;
    if (!deaf) {
      for (const Arrival& arrival : port.take()) role.on(arrival);
    }
    if (role.next_wake() > now_ && role.next_wake() <= now_ + 2) return;
    const bool had_none = has_no_robot(role);
    auto messages = role.step(now_);
    if (had_none && !has_no_robot(role)) begin(role);
    for (auto& message : messages) {
      Outgoing said(std::move(message));
      if (const auto* status = std::get_if<AgentStatus>(&said.message)) expect_sole(status->robot, *agent);
      port.publish(std::move(said));
    }
  }
  /// Checks that no successor of the speaker spoke before, and that the speaker was no other robot.
  void expect_sole(const RobotName& robot, const Agent& agent) {
    std::vector<std::size_t>& line = speakers_[robot];
    if (line.empty() || line.back() != agent.id) {
      EXPECT_EQ(std::ranges::count(line, agent.id), 0) << agent.id << " is " << robot << " again";
      line.push_back(agent.id);
    }
    const RobotName& first = robot_of_.try_emplace(agent.id, robot).first->second;
    EXPECT_EQ(first, robot) << agent.id << " is two robots";
  }

  Random random_;
  SimulatedBus bus_;
  double now_ = 0;
  std::optional<Service> service_;
  std::deque<Agent> agents_;  ///< a deque keeps them where they are
  std::map<RobotName, std::vector<std::size_t>> speakers_;
  std::map<std::size_t, RobotName> robot_of_;
};

TEST(ManyClaimants, NoTwoAgentsShareARobotUnderFaults) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    ManyClaims claims(seed);
    claims.run(60, true);
    claims.run(110, false);
    EXPECT_EQ(claims.robots_of_the_living().size(), 4u);
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace coppice
