// Tests of a fleet that takes orders, as processes over DDS: commands, kills, and another vendor's DDS.
//
// CTest: RESOURCE_LOCK lane_3

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/report_file.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using test::Background;
using test::Outcome;
using test::shell;

/// Four robots in a hall of 40 m x 30 m with a wall in it. They have no goals.
std::string hall() {
  std::string map = "type octile\nheight 30\nwidth 40\nmap\n";
  for (int j = 0; j < 30; ++j) {
    for (int i = 0; i < 40; ++i) map += (i == 19 || i == 20) && j > 8 ? '@' : '.';
    map += '\n';
  }
  return map;
}
constexpr const char* site = R"({"map": "hall.map", "radius": 0.5, "max_speed": 4, "robots": [
  {"name": "r1", "start": {"x": 3, "y": 3}}, {"name": "r2", "start": {"x": 3, "y": 8}},
  {"name": "r3", "start": {"x": 36, "y": 3}}, {"name": "r4", "start": {"x": 36, "y": 8}}]})";

class StandingFleet : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("hall.map", hall());
    folder.write("site.json", site);
    fleet = std::make_unique<Background>(
        std::vector<std::string>{test::program("coppice"), "serve", file("site.json"), "--domain",
                                 test::domain_name(), "--time-scale", "2", "--state", file("state"),
                                 "--report", file("report.json")},
        file("log"));
  }
  std::string file(const std::string& name) const { return (folder.path() / name).string(); }
  /// Runs a command that gives or lists orders.
  Outcome order(const std::string& words) const {
    return shell(test::program("coppice") + " " + words + " --patience 40 --domain " + test::domain_name());
  }
  /// Whether `coppice orders` says that, by and by: on a busy machine it may not hear all within its time.
  bool list_says(const std::string& text, const std::string& words = "") const {
    return test::within(60s, [&] {
      const Outcome list =
          shell(test::program("coppice") + " orders " + words + " --domain " + test::domain_name());
      return list.output.find(text) != std::string::npos;
    });
  }
  std::optional<pid_t> process(const std::string& name) const {
    for (const test::ProcessInfo& child : test::children_of(fleet->pid())) {
      if (child.name == name && child.state != 'Z') return child.pid;
    }
    return std::nullopt;
  }
  proto::Report end() {
    fleet->send(SIGINT);
    EXPECT_EQ(fleet->wait(), 0) << test::contents(file("log"));
    return read_report(file("report.json"));
  }
  /// The last state of each order in the history, and how often it ended.
  std::map<std::string, int> ends_in_history() const {
    std::map<std::string, int> ends;
    std::istringstream lines(test::contents(file("state/orders.jsonl")));
    for (std::string line; std::getline(lines, line);) {
      const std::string id = line.substr(7, line.find('"', 7) - 7);
      ends[id] += line.find("\"ended_at\":null") == std::string::npos;
    }
    return ends;
  }

  test::TemporaryFolder folder;
  std::unique_ptr<Background> fleet;
};

TEST_F(StandingFleet, CommandsAndForeignProgramsGiveOrders) {
  const Outcome sent = order("send r1 --to 30,5 --wait --by test");
  EXPECT_EQ(sent.exit_code, 0) << sent.output << test::contents(file("log"));
  EXPECT_NE(sent.output.find("done by r1"), std::string::npos) << sent.output;
  const Outcome nearest = order("send --any --to 36,10 --stay 0.5 --wait --json");
  EXPECT_EQ(nearest.exit_code, 0) << nearest.output;
  EXPECT_NE(nearest.output.find(R"("state":"done","robot":"r4")"), std::string::npos) << nearest.output;

  const Outcome wall = order("send r1 --to 20,20");
  EXPECT_EQ(wall.exit_code, 1);
  EXPECT_NE(wall.output.find("is in an obstacle"), std::string::npos) << wall.output;
  EXPECT_NE(order("send r9 --to 3,3").output.find("r9 is no robot of this fleet"), std::string::npos);
  EXPECT_EQ(order("cancel nothing").exit_code, 1);

  EXPECT_EQ(order("stop --wait").exit_code, 0);
  const Outcome held = order("send r2 --to 3,25");
  EXPECT_EQ(held.exit_code, 0) << held.output;
  EXPECT_TRUE(list_says("r2 is stopped by the operator"));
  EXPECT_TRUE(list_says("r3: stopped by the operator"));
  EXPECT_EQ(order("release --wait").exit_code, 0);
  const std::string id = held.output.substr(6, 16);
  const Outcome cancelled = order("cancel " + id);
  EXPECT_EQ(cancelled.exit_code, 0) << cancelled.output;
  EXPECT_TRUE(list_says(id + ": cancelled", "--all"));

  // Another vendor's DDS, with the IDL alone.
  const Outcome seen = shell(std::string(COPPICE_TEST_BIN_DIR) + "/cyclone_dispatcher " +
                             test::domain_name() + " from-cyclone r3 30 20 60");
  EXPECT_EQ(seen.exit_code, 0) << seen.output << test::contents(file("log"));
  EXPECT_NE(seen.output.find("state 3 robot r3"), std::string::npos) << seen.output;
  EXPECT_TRUE(list_says("\"by\":\"cyclone\"", "--all --json"));

  EXPECT_EQ(end().collisions(), 0u);
}

TEST_F(StandingFleet, EachOrderEndsOnceThoughServiceBrokerAndAgentsAreKilled) {
  ASSERT_EQ(order("send r1 --to 30,5 --wait").exit_code, 0) << test::contents(file("log"));
  std::vector<std::unique_ptr<Background>> senders;
  const std::vector<std::string> places{"5,20", "10,25", "14,12", "30,25", "25,12", "34,20", "6,14", "28,6"};
  int k = 0;
  for (const char* const killed : {"planner_service", "robot_agent", "tree_broker", "planner_service"}) {
    for (int n = 0; n < 2; ++n, ++k) {
      senders.push_back(std::make_unique<Background>(
          std::vector<std::string>{test::program("coppice"), "send", "--any", "--to",
                                   places.at(static_cast<std::size_t>(k)), "--wait", "--domain",
                                   test::domain_name(), "--patience", "60"},
          file("sender" + std::to_string(k))));
    }
    std::this_thread::sleep_for(700ms);
    // A process that was killed before may not be back yet.
    ASSERT_TRUE(test::within(30s, [&] { return process(killed).has_value(); })) << killed;
    kill(process(killed).value(), SIGKILL);
    std::this_thread::sleep_for(1500ms);
  }
  for (std::size_t n = 0; n < senders.size(); ++n) {
    ASSERT_TRUE(test::within(90s, [&] { return test::has_ended(senders[n]->pid()); }))
        << test::contents(file("sender" + std::to_string(n)));
    EXPECT_EQ(senders[n]->wait(), 0) << test::contents(file("sender" + std::to_string(n)));
  }
  for (const auto& [id, ends] : ends_in_history()) EXPECT_EQ(ends, 1) << id;
  EXPECT_EQ(ends_in_history().size(), senders.size() + 1);
  const proto::Report report = end();
  EXPECT_EQ(report.collisions(), 0u);
}

TEST(Orders, MistakesAreRefusedInOneLine) {
  const auto refuses = [](const std::string& words, const std::string& why) {
    const Outcome outcome = shell(test::program("coppice") + " " + words);
    EXPECT_EQ(outcome.exit_code, 2) << words;
    EXPECT_NE(outcome.output.find(why), std::string::npos) << outcome.output;
  };
  refuses("send r1 --to 3", "--to: 3: expected X,Y or X,Y,YAW");
  refuses("send r1 --to 3,4,90",
          "--to: 3,4,90: yaw 90 is not allowed, expected radians from -6.283 to 6.283");
  refuses("send --to 3,4", "a robot, or --any is required");
  refuses("send r1 --any --to 3,4", "excludes");
  refuses("send r1", "--to");
  refuses("send r1 --to 3,4 --each", "--each requires --any");
  refuses("cancel", "order");
  const Outcome nobody =
      shell(test::program("coppice") + " stop --patience 0.5 --domain " + test::domain_name());
  EXPECT_EQ(nobody.exit_code, 1);
  EXPECT_NE(nobody.output.find("nobody on domain " + test::domain_name() + " has answered"),
            std::string::npos)
      << nobody.output;
}

TEST(Orders, AScenarioWithoutGoalsIsNoRun) {
  test::TemporaryFolder folder;
  folder.write("hall.map", hall());
  const auto file = folder.write("site.json", site);
  const Outcome outcome = shell(test::program("coppice") + " run " + file.string());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.output.find("robots[0].goal: is missing"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace coppice
