// Tests of a real monitor of a real fleet, seen by other programs: Foxglove's client, promtool, a Prometheus
// server; and of what it refuses. They need Node.js with the packages of tests/web/package.json, and
// Prometheus: tests/run installs them.
//
// CTest: PARALLEL

#include <algorithm>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"
#include "tests/web/client.h"
#include "tests/web/packages.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

std::string which(const std::string& name) {
  const test::Outcome found = test::shell("command -v " + name);
  return found.exit_code == 0 ? found.output.substr(0, found.output.find('\n')) : std::string();
}

struct MonitorTest : testing::Test {
  test::TemporaryFolder folder;

  std::filesystem::path path(const std::string& name) const { return folder.path() / name; }

  std::unique_ptr<test::Background> monitor(int of_domain,
                                            std::vector<std::string> options = {"--port", "0"}) {
    std::vector<std::string> command{test::program("coppice"), "monitor", "--domain",
                                     std::to_string(of_domain)};
    command.insert(command.end(), options.begin(), options.end());
    auto process = std::make_unique<test::Background>(command, path("monitor.log"));
    EXPECT_TRUE(test::within(20s, [&] { return !url().empty(); })) << test::contents(path("monitor.log"));
    return process;
  }
  /// The address in the first line of the monitor.
  std::string url() const {
    const std::string said = test::contents(path("monitor.log"));
    return said.starts_with("http://") ? said.substr(0, said.find('\n')) : std::string();
  }
  std::string port() const {
    const std::string all = url();
    const std::size_t colon = all.rfind(':');
    return all.substr(colon + 1, all.size() - colon - 2);
  }
  std::unique_ptr<test::Background> fleet(int of_domain) {
    return std::make_unique<test::Background>(
        std::vector<std::string>{test::program("coppice"), "run",
                                 (test::scenarios() / "rooms-8.json").string(), "--robots", "4", "--domain",
                                 std::to_string(of_domain), "--quiet", "--time-scale", "1", "--trajectory",
                                 path("trajectory.csv").string()},
        path("run.log"));
  }
  test::Outcome node(const std::string& script, const std::string& arguments) const {
    return test::shell("cd '" + test::web_tests().string() + "' && node " + script + " " + arguments);
  }
};

TEST_F(MonitorTest, FoxgloveAndThePageShowWhatTheFleetDrives) {
  const auto watcher = monitor(test::own_domain());
  const auto run = fleet(test::own_domain());
  const test::Outcome outcome =
      node("monitor_fleet.js", fmt::format("{} '{}/idl/live.proto' '{}' 1", url(), COPPICE_SOURCE_DIR,
                                           path("trajectory.csv").string()));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output << test::contents(path("run.log"));
  std::cout << outcome.output;
  EXPECT_EQ(run->wait(), 0) << test::contents(path("run.log"));
  watcher->send(SIGTERM);
  EXPECT_EQ(watcher->wait(), 0) << test::contents(path("monitor.log"));
}

TEST_F(MonitorTest, TheMonitorRefusesInvalidRequestsAndGoesOn) {
  const auto watcher = monitor(test::own_domain());
  const test::Outcome outcome = node("monitor_refusals.js", url());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_FALSE(test::has_ended(watcher->pid())) << test::contents(path("monitor.log"));
}

TEST_F(MonitorTest, PrometheusReadsTheMetrics) {
  ASSERT_FALSE(which("prometheus").empty()) << "needs prometheus: tests/run installs it";
  const auto watcher = monitor(test::own_domain());
  const auto run = fleet(test::own_domain());
  const auto value = [&](const std::string& base, const std::string& what) {
    return test::shell("curl -s '" + base + what + "'").output;
  };
  EXPECT_TRUE(test::within(20s, [&] {
    return value(url(), "metrics").find("coppice_robots_in_phase{phase=\"driving\"} 4\n") !=
           std::string::npos;
  })) << value(url(), "metrics");
  const test::Outcome checked = test::shell("curl -s " + url() + "metrics | promtool check metrics");
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_EQ(checked.output, "");

  // The example of deploy/, changed to scrape this monitor, and more often.
  std::string config = test::contents(std::filesystem::path(COPPICE_SOURCE_DIR) / "deploy/prometheus.yml");
  const std::string usual = "127.0.0.1:8090";
  ASSERT_NE(config.find(usual), std::string::npos);
  config.replace(config.find(usual), usual.size(), "127.0.0.1:" + port());
  config.replace(config.find("5s"), 2, "1s");
  folder.write("prometheus.yml", config);
  const std::string server = fmt::format("127.0.0.1:{}", test::free_port());
  const test::Background prometheus(
      {which("prometheus"), "--config.file=" + path("prometheus.yml").string(),
       "--storage.tsdb.path=" + path("data").string(), "--web.listen-address=" + server},
      path("prometheus.log"));
  const std::string query = "http://" + server + "/api/v1/query?query=";
  EXPECT_TRUE(test::within(30s,
                           [&] {
                             return value(query, "coppice_robots").find("\"4\"]") != std::string::npos &&
                                    value(query, "up").find("\"1\"]") != std::string::npos;
                           }))
      << value(query, "up") << test::contents(path("prometheus.log"));
}

TEST_F(MonitorTest, TheMonitorIsNicerThanTheFleet) {
  constexpr int of_agents = 10;  // the niceness that `coppice run` gives them
  const auto watcher = monitor(test::own_domain());
  EXPECT_GT(getpriority(PRIO_PROCESS, static_cast<id_t>(watcher->pid())), of_agents);
}

TEST_F(MonitorTest, TheMonitorListensOnlyAtTheLoopback) {
  const auto watcher = monitor(test::own_domain());
  const test::Outcome listening = test::shell(fmt::format("ss -Htlnp | grep 'pid={},'", watcher->pid()));
  EXPECT_EQ(std::ranges::count(listening.output, '\n'), 1) << listening.output;
  EXPECT_NE(listening.output.find(" 127.0.0.1:" + port() + " "), std::string::npos) << listening.output;
}

TEST_F(MonitorTest, TheMonitorTakesAnotherPortOnRequestAndSaysSo) {
  const auto first = monitor(test::own_domain());
  const std::string taken = port();
  const test::Background second({test::program("coppice"), "monitor", "--domain", test::domain_name(),
                                 "--port", taken, "--else-any-port"},
                                path("second.log"));
  const auto said = [&] { return test::contents(path("second.log")); };
  EXPECT_TRUE(test::within(20s, [&] { return said().find("http://127.0.0.1:") != std::string::npos; }))
      << said();
  EXPECT_TRUE(said().starts_with("port " + taken + " is taken: the page is at port ")) << said();
  EXPECT_EQ(said().find("http://127.0.0.1:" + taken + "/"), std::string::npos) << said();
}

/// Prometheus's own tool checks that the rules of deploy/ are well formed and fire as they should.
TEST_F(MonitorTest, TheAlertsFireAsTheyShould) {
  if (which("promtool").empty()) GTEST_SKIP() << "needs prometheus";
  const std::string rules = std::string(COPPICE_SOURCE_DIR) + "/deploy/prometheus-alerts.yml";
  const test::Outcome checked = test::shell("promtool check rules '" + rules + "' 2>&1");
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  std::string tests = test::contents(test::web_tests() / "alerts_test.yml");
  tests.replace(tests.find("[RULES]"), 7, "[" + rules + "]");
  folder.write("alerts_test.yml", tests);
  const test::Outcome tested =
      test::shell("promtool test rules '" + path("alerts_test.yml").string() + "' 2>&1");
  EXPECT_EQ(tested.exit_code, 0) << tested.output;
}

/// The monitor of a recording has no figures of a bus, and its process figures are true.
TEST_F(MonitorTest, TheMonitorOfARecordingReportsItsOwnFigures) {
  if (which("curl").empty()) GTEST_SKIP() << "needs curl";
  const std::string file = path("fleet.mcap").string();
  ASSERT_EQ(
      test::shell(fmt::format("'{}' simulate '{}' --robots 2 --quiet --record '{}'", test::program("coppice"),
                              (test::scenarios() / "rooms-8.json").string(), file))
          .exit_code,
      0);
  const test::Background watcher({test::program("coppice"), "monitor", file, "--port", "0"},
                                 path("monitor.log"));
  ASSERT_TRUE(test::within(20s, [&] { return !url().empty(); }));
  std::string metrics;
  EXPECT_TRUE(test::within(20s, [&] {
    metrics = test::shell("curl -s " + url() + "metrics").output;
    return metrics.find("\nprocess_resident_memory_bytes ") != std::string::npos &&
           metrics.find("\nprocess_resident_memory_bytes 0\n") == std::string::npos;
  })) << metrics;
  EXPECT_EQ(metrics.find("\nprocess_cpu_seconds_total 0\n"), std::string::npos) << metrics;
  EXPECT_EQ(metrics.find("coppice_monitor_rejected_messages_total"), std::string::npos) << metrics;
}

TEST_F(MonitorTest, TheMonitorSaysWhereItCannotListen) {
  const auto refused = [&](const std::string& options) {
    return test::shell(fmt::format("timeout 20 '{}' monitor --domain {} {}", test::program("coppice"),
                                   test::own_domain(), options));
  };
  const auto watcher = monitor(test::own_domain());
  const test::Outcome taken = refused("--port " + port());
  EXPECT_EQ(taken.exit_code, 2);
  EXPECT_EQ(taken.output, "127.0.0.1:" + port() + ": cannot listen there: Address already in use\n");
  const test::Outcome nowhere = refused("--address somewhere");
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_EQ(nowhere.output, "--address somewhere: expected an IP address\n");
  EXPECT_EQ(refused("--port 70000").exit_code, 2);
  EXPECT_EQ(refused("--domain 300").exit_code, 2);
}

}  // namespace
}  // namespace coppice
