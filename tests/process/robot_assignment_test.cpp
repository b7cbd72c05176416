// Tests of agents without a name over DDS. Each gets its own robot, and a successor gets the robot of an
// agent that failed.
//
// CTest: RESOURCE_LOCK lane_1

#include <csignal>
#include <map>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/report_file.h"
#include "messages/messages.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

/// The fleet's processes, each with a log.
struct Roles {
  std::size_t start(std::vector<std::string> command) {
    command[0] = test::program(command[0]);
    command.insert(command.end(), {"--domain", test::domain_name()});
    const std::size_t number = processes.size();
    processes.push_back(std::make_unique<test::Background>(command, log_file(number)));
    return number;
  }
  std::filesystem::path log_file(std::size_t number) const {
    return folder.path() / ("log" + std::to_string(number));
  }
  std::string log(std::size_t number) const { return test::contents(log_file(number)); }
  /// The robot that an agent reports to be; empty if it has none yet.
  std::string robot(std::size_t agent) const {
    const std::string said = log(agent);
    std::smatch match;
    return std::regex_search(said, match, std::regex(": is (\\S+)")) ? match[1].str() : std::string();
  }
  /// The agent of each robot, as soon as all agents have one.
  std::map<std::string, std::size_t> names(const std::vector<std::size_t>& agents,
                                           std::chrono::seconds time) const {
    std::map<std::string, std::size_t> by_name;
    test::within(time, [&] {
      by_name.clear();
      for (const std::size_t agent : agents) by_name.emplace(robot(agent), agent);
      return by_name.size() == agents.size() && !by_name.contains("");
    });
    return by_name;
  }

  test::TemporaryFolder folder;
  std::vector<std::unique_ptr<test::Background>> processes;
};

TEST(NamelessAgents, FourAgentsWithoutNamesGetFourRobotsAndAreReplaced) {
  Roles roles;
  std::vector<std::size_t> agents;
  // Containers share a folder: a paused agent has the journal of its robot open.
  const std::string state = (roles.folder.path() / "state").string();
  for (int k = 0; k < 4; ++k) agents.push_back(roles.start({"robot_agent", "--state", state}));
  const std::string report = (roles.folder.path() / "report.json").string();
  const std::size_t service = roles.start({"planner_service", (test::scenarios() / "blank-10.json").string(),
                                           "--robots", "4", "--time-scale", "10", "--report", report});
  const auto names = roles.names(agents, 20s);
  ASSERT_EQ(names.size(), 4u);
  for (const char* name : {"r1", "r2", "r3", "r4"}) EXPECT_TRUE(names.contains(name)) << name;

  const std::size_t killed = names.at("r2");
  const std::size_t stopped = names.at("r3");
  roles.processes[killed]->send(SIGKILL);
  roles.processes[stopped]->send(SIGSTOP);
  const std::vector<std::size_t> spares{roles.start({"robot_agent", "--state", state}),
                                        roles.start({"robot_agent", "--state", state})};
  const auto replaced = roles.names(spares, 30s);
  ASSERT_EQ(replaced.size(), 2u);
  ASSERT_TRUE(replaced.contains("r2") && replaced.contains("r3"));
  EXPECT_TRUE(test::within(10s, [&] {
    return roles.log(replaced.at("r3")).find("is in use by another process") != std::string::npos;
  })) << roles.log(replaced.at("r3"));
  roles.processes[stopped]->send(SIGCONT);
  EXPECT_EQ(roles.processes[stopped]->wait(), 1) << roles.log(stopped);

  EXPECT_EQ(roles.processes[service]->wait(), 0) << roles.log(service);
  EXPECT_EQ(read_report(report).outcome(), "arrived");
  for (const std::size_t agent : {names.at("r1"), names.at("r4"), spares[0], spares[1]}) {
    roles.processes[agent]->send(SIGTERM);
    EXPECT_EQ(roles.processes[agent]->wait(), 0) << roles.log(agent);
  }
}

TEST(NamelessAgents, AnAgentWithoutAServiceSaysSoAndEndsOnRequest) {
  Roles roles;
  const std::size_t agent = roles.start({"robot_agent"});
  EXPECT_TRUE(test::within(20s, [&] {
    return roles.log(agent).find("no planner service") != std::string::npos;
  })) << roles.log(agent);
  roles.processes[agent]->send(SIGTERM);
  EXPECT_EQ(roles.processes[agent]->wait(), 0);
}

}  // namespace
}  // namespace coppice
