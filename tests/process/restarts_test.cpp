// Tests of a standing fleet that is ended and started again, with a monitor that stays, and of robots that
// are not heard. They need curl.
//
// CTest: RESOURCE_LOCK lane_2

#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coppice/planning/geometry.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using test::Background;
using test::Outcome;
using test::shell;

constexpr const char* token = "0123456789abcdef0123456789abcdef";

/// Three robots in a hall of 30 m x 20 m.
std::string hall() {
  std::string map = "type octile\nheight 20\nwidth 30\nmap\n";
  for (int j = 0; j < 20; ++j) map += std::string(30, '.') + "\n";
  return map;
}
constexpr const char* site = R"({"map": "hall.map", "radius": 0.5, "max_speed": 4, "robots": [
  {"name": "r1", "start": {"x": 3, "y": 3}}, {"name": "r2", "start": {"x": 3, "y": 8}},
  {"name": "r3", "start": {"x": 26, "y": 3}}]})";

struct Restarts : testing::Test {
  Restarts() {
    folder.write("hall.map", hall());
    folder.write("site.json", site);
    folder.write("token", token);
  }
  std::string file(const std::string& name) const { return (folder.path() / name).string(); }
  void serve(std::vector<std::string> more = {}) {
    std::vector<std::string> command{"/usr/bin/env",           "XDG_STATE_HOME=" + file("home"),
                                     test::program("coppice"), "serve",
                                     file("site.json"),        "--domain",
                                     test::domain_name()};
    command.insert(command.end(), more.begin(), more.end());
    fleet = std::make_unique<Background>(command, file(fmt::format("log{}", ++fleets)));
  }
  std::string log() const { return test::contents(file(fmt::format("log{}", fleets))); }
  void watch() {
    monitor = std::make_unique<Background>(
        std::vector<std::string>{test::program("coppice"), "monitor", "--control", "--token-file",
                                 file("token"), "--domain", test::domain_name(), "--port", "0"},
        file("monitor"));
    ASSERT_TRUE(
        test::within(20s, [&] { return test::contents(file("monitor")).find('\n') != std::string::npos; }));
    const std::string said = test::contents(file("monitor"));
    url = said.substr(0, said.find('\n')) + "api/";
  }
  std::string get(const std::string& what) const {
    return shell(fmt::format("curl -s -H 'Authorization: Bearer {}' '{}{}'", token, url, what)).output;
  }
  std::string post(const std::string& what, const std::string& body) const {
    return shell(fmt::format("curl -s -H 'Authorization: Bearer {}' '{}{}' -d '{}'", token, url, what, body))
        .output;
  }
  bool says(const std::string& what, const std::string& part, std::chrono::seconds time = 60s) const {
    return test::within(time, [&] { return get(what).find(part) != std::string::npos; });
  }
  /// Where a robot is, once it is heard.
  Point2 place_of(const std::string& robot) const {
    const std::regex pattern(R"("name":")" + robot + R"(","phase":"[^"]*","x":([-0-9.]+),"y":([-0-9.]+))");
    std::smatch match;
    std::string robots;
    EXPECT_TRUE(test::within(60s, [&] {
      robots = get("robots");
      return std::regex_search(robots, match, pattern);
    })) << robots;
    return {std::stod(match[1]), std::stod(match[2])};
  }
  Outcome order(const std::string& words) const {
    return shell(test::program("coppice") + " " + words + " --patience 40 --domain " + test::domain_name());
  }
  void end() {
    fleet->send(SIGINT);
    EXPECT_EQ(fleet->wait(), 0) << log();
  }
  int times(const std::string& history, const std::string& id) const {
    const std::string text = test::contents(file(history));
    const std::regex ended("\"id\":\"" + id + "\"[^\n]*\"ended_at\":[0-9]");
    return static_cast<int>(std::distance(std::sregex_iterator(text.begin(), text.end(), ended), {}));
  }
  std::optional<pid_t> agent(const std::string& robot) const {
    for (const test::ProcessInfo& child : test::children_of(fleet->pid())) {
      const std::string command = test::contents(fmt::format("/proc/{}/cmdline", child.pid));
      if (command.find(std::string("--name") + '\0' + robot + '\0') != std::string::npos) return child.pid;
    }
    return std::nullopt;
  }

  test::TemporaryFolder folder;
  int fleets = 0;
  std::string url{};
  std::unique_ptr<Background> fleet{};
  std::unique_ptr<Background> monitor{};
};

TEST_F(Restarts, AFleetStandsUpAgainWhereItWas) {
  serve({"--state", file("state")});
  watch();
  post("orders", R"({"id": "once", "robot": "r1", "goal": {"x": 15, "y": 10}})");
  ASSERT_TRUE(says("orders/once", R"("state":"done")")) << get("orders/once") << log();
  EXPECT_EQ(order("pause r3 --wait").exit_code, 0);
  post("orders", R"({"id": "open", "robot": "r3", "goal": {"x": 20, "y": 10}})");
  EXPECT_EQ(order("stop --wait").exit_code, 0);
  end();
  EXPECT_TRUE(says("orders/open", R"("reason":"the fleet has ended")"));

  serve({"--state", file("state")});  // the same again
  ASSERT_TRUE(test::within(60s, [&] { return place_of("r1").x() > 14; })) << get("robots") << log();
  EXPECT_LT((place_of("r1") - Point2(15, 10)).norm(), 1.01);
  EXPECT_TRUE(says("robots", R"("halt":"stopped","why":"stopped by the operator")")) << get("robots");
  std::this_thread::sleep_for(4s);  // what the monitor still offers would be taken up by now
  EXPECT_EQ(order("resume r1").exit_code, 1);
  EXPECT_NE(order("resume r1").output.find("r1 stays stopped until it is released"), std::string::npos);
  const Outcome released = order("release --wait");
  EXPECT_EQ(released.exit_code, 0) << released.output;
  EXPECT_NE(released.output.find("r3 stays paused until it is resumed"), std::string::npos)
      << released.output;
  EXPECT_TRUE(says("robots", R"("halt":"paused","why":"paused by the operator")"));
  std::this_thread::sleep_for(2s);
  EXPECT_LT((place_of("r3") - Point2(26, 3)).norm(), 0.1) << "paused, and its order has ended";
  EXPECT_NE(
      post("orders", R"({"id": "once", "robot": "r2", "goal": {"x": 5, "y": 15}})").find(R"("state":"done")"),
      std::string::npos);
  EXPECT_EQ(times("state/orders.jsonl", "once"), 1);
  EXPECT_EQ(times("state/orders.jsonl", "open"), 1);
  end();

  // A new fleet, with the same monitor: its orders are of the one before.
  serve({"--state", file("another")});
  EXPECT_TRUE(test::within(30s, [&] { return (place_of("r1") - Point2(3, 3)).norm() < 0.1; })) << log();
  std::this_thread::sleep_for(8s);
  EXPECT_LT((place_of("r1") - Point2(3, 3)).norm(), 0.1);
  EXPECT_TRUE(says("orders/once", R"("state":"done")"));
  EXPECT_EQ(test::contents(file("another/orders.jsonl")).find("under way"), std::string::npos);
  post("orders", R"({"id": "new", "robot": "r1", "goal": {"x": 5, "y": 5}})");
  EXPECT_TRUE(says("orders/new", R"("state":"done")"));
  end();
}

TEST_F(Restarts, WithoutAFolderTheStateIsThatOfTheSite) {
  serve();
  watch();
  EXPECT_TRUE(test::within(30s, [&] { return log().find("a new fleet") != std::string::npos; })) << log();
  post("orders", R"({"id": "1", "robot": "r2", "goal": {"x": 10, "y": 12}})");
  ASSERT_TRUE(says("orders/1", R"("state":"done")")) << log();
  const Outcome second = shell(fmt::format("XDG_STATE_HOME={} {} serve {} --domain {}", file("home"),
                                           test::program("coppice"), file("site.json"), test::domain_name()));
  EXPECT_EQ(second.exit_code, 2);
  end();
  serve();
  EXPECT_TRUE(test::within(30s, [&] {
    return log().find("the fleet goes on where it was") != std::string::npos;
  })) << log();
  watch();  // the monitor before may still show the fleet before
  EXPECT_LT((place_of("r2") - Point2(10, 12)).norm(), 1.01) << log();
  end();
}

TEST_F(Restarts, PosesMayBeGiven) {
  folder.write("poses.json", R"({"robots": [{"name": "r1", "x": 9, "y": 9}, {"name": "r2", "x": 20, "y": 15},
                                            {"name": "r3", "x": 3, "y": 15}]})");
  folder.write("wrong.json", R"({"robots": [{"name": "r1", "x": 9, "y": 9}]})");
  const Outcome wrong =
      shell(fmt::format("{} serve {} --domain {} --state {} --start-at {}", test::program("coppice"),
                        file("site.json"), test::domain_name(), file("state"), file("wrong.json")));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.output.find("wrong.json: r2 is missing, expected a pose for each robot of the site"),
            std::string::npos)
      << wrong.output;
  serve({"--state", file("state"), "--start-at", file("poses.json")});
  watch();
  EXPECT_LT((place_of("r2") - Point2(20, 15)).norm(), 0.1) << log();
  end();
  // A robot that is new starts where the scenario says.
  folder.write("site.json", std::string(site).replace(std::string(site).rfind(']'), 1,
                                                      R"(, {"name": "r4", "start": {"x": 26, "y": 10}}])"));
  serve({"--state", file("state")});
  EXPECT_LT((place_of("r4") - Point2(26, 10)).norm(), 0.1) << log();
  EXPECT_LT((place_of("r1") - Point2(9, 9)).norm(), 0.1);
  end();
  folder.write("site.json", std::string(site).replace(std::string(site).rfind(']'), 1,
                                                      R"(, {"name": "r5", "start": {"x": 9.5, "y": 9}}])"));
  serve({"--state", file("state")});
  EXPECT_EQ(fleet->wait(), 2);
  EXPECT_NE(log().find("r5 is new to this fleet and starts at (9.5, 9), where r1 stands"), std::string::npos)
      << log();
}

TEST_F(Restarts, ARobotThatHangsIsNamedAndItsOpenOrderGoesToAnother) {
  serve({"--state", file("state")});
  watch();
  ASSERT_TRUE(test::within(60s, [&] { return agent("r3").has_value(); })) << log();
  place_of("r1");
  post("orders", R"({"id": "far", "robot": "r3", "goals": [{"x": 4, "y": 17}, {"x": 26, "y": 3}]})");
  ASSERT_TRUE(says("orders/far", R"("state":"under way")")) << log();
  std::this_thread::sleep_for(1s);
  kill(agent("r3").value(), SIGSTOP);
  const std::string why = "is not heard: its agent has ended, hangs, or cannot be reached\"";
  EXPECT_TRUE(says("orders/far", R"("reason":"r3 )" + why, 8s)) << get("orders/far");
  EXPECT_TRUE(says("robots", R"("why":"it )" + why, 8s)) << get("robots");
  const Outcome listed = shell(test::program("coppice") + " orders --domain " + test::domain_name());
  EXPECT_NE(listed.output.find("r3 is not heard"), std::string::npos) << listed.output;
  kill(agent("r3").value(), SIGCONT);
  EXPECT_TRUE(says("orders/far", R"("state":"done")")) << get("orders/far");

  kill(agent("r3").value(), SIGSTOP);
  post("orders", R"({"id": "any", "goal": {"x": 24, "y": 6}})");
  EXPECT_TRUE(says("orders/any", R"("robot":"r2")", 20s)) << get("orders/any") << log();
  // Where r3 may still come nobody drives until it counts as failed.
  EXPECT_TRUE(says("orders/any", R"("state":"done")", 100s)) << get("orders/any") << log();
  EXPECT_EQ(get("orders/any").find(R"("robot":"r3")"), std::string::npos);
  kill(agent("r3").value(), SIGCONT);
  std::this_thread::sleep_for(3s);
  EXPECT_LT((place_of("r3") - Point2(26, 3)).norm(), 1.01) << "it stays where it is";
  end();
}

}  // namespace
}  // namespace coppice
