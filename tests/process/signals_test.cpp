// Tests of how programs end when they are stopped, and of how they show that they work. A robot brakes first,
// and its track is complete.
//
// CTest: RESOURCE_LOCK lane_1

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "files/report_file.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/run_check.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

struct Program {
  Program(const test::TemporaryFolder& folder, std::vector<std::string> command)
      : log(folder.path() / (command[0] + ".log")), process(started(std::move(command)), log) {}
  static std::vector<std::string> started(std::vector<std::string> command) {
    command[0] = test::program(command[0]);
    return command;
  }
  bool says(const std::string& text) const {
    return test::within(20s, [&] { return test::contents(log).find(text) != std::string::npos; });
  }
  int ends_by(int signal) {
    process.send(signal);
    EXPECT_TRUE(test::within(6s, [&] { return test::has_ended(process.pid()); })) << test::contents(log);
    return process.wait();
  }
  std::filesystem::path log;
  test::Background process;
};

TEST(Signals, AStoppedRobotBrakesAndItsTrackIsComplete) {
  const test::TemporaryFolder folder;
  const std::string report = (folder.path() / "report.json").string();
  const std::string trajectory = (folder.path() / "t.csv").string();
  Program agent(folder, {"robot_agent", "--name", "r1", "--domain", test::domain_name()});
  Program service(folder, {"planner_service", (test::scenarios() / "blank-10.json").string(), "--robots", "1",
                           "--domain", test::domain_name(), "--report", report, "--trajectory", trajectory});
  ASSERT_TRUE(service.says("paths found 1/1")) << test::contents(service.log);
  std::this_thread::sleep_for(2s);
  EXPECT_EQ(agent.ends_by(SIGTERM), 0) << test::contents(agent.log);
  EXPECT_EQ(service.process.wait(), 1) << test::contents(service.log);
  const proto::Report result = read_report(report);
  EXPECT_EQ(result.robots(0).reason(), "the agent was told to stop");
  const auto track = test::read_trajectory_rows(trajectory).at("r1");
  ASSERT_GT(track.size(), 40u);
  EXPECT_GT(test::distance(track.front().place, track.back().place), 5);
  EXPECT_TRUE(test::contents(trajectory).ends_with(",0.000000,0.000000\n")) << "the robot stands at the end";
}

TEST(Signals, SigtermEndsEveryOtherProgram) {
  const test::TemporaryFolder folder;
  Program broker(folder, {"tree_broker", "--domain", test::domain_name()});
  Program discovery(folder, {"coppice", "discovery", "--port", "23934"});
  Program agent(folder, {"robot_agent", "--name", "r1", "--domain", test::domain_name()});
  Program service(folder, {"planner_service", (test::scenarios() / "blank-10.json").string(), "--domain",
                           test::domain_name(1)});
  ASSERT_TRUE(broker.says("on domain " + test::domain_name()));
  ASSERT_TRUE(discovery.says("discovery server 0"));
  ASSERT_TRUE(agent.says("on domain " + test::domain_name()));
  ASSERT_TRUE(service.says("paths found"));
  EXPECT_EQ(broker.ends_by(SIGTERM), 0);
  EXPECT_EQ(discovery.ends_by(SIGTERM), 0);
  EXPECT_EQ(agent.ends_by(SIGINT), 0);
  EXPECT_EQ(service.ends_by(SIGTERM), 1);  // not every robot has arrived
  EXPECT_NE(test::contents(service.log).find("interrupted"), std::string::npos);
}

/// An agent that was started with this handling of SIGHUP.
struct AgentWithHangup {
  AgentWithHangup(void (*hangup)(int), const test::TemporaryFolder& folder)
      : before(std::signal(SIGHUP, hangup)),
        agent(folder, {"robot_agent", "--name", "r1", "--domain", test::domain_name()}) {
    std::signal(SIGHUP, before);
    EXPECT_TRUE(agent.says("on domain " + test::domain_name()));
  }
  void (*before)(int);
  Program agent;
};

TEST(Signals, SighupEndsAProgramUnlessItIsIgnored) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(AgentWithHangup(SIG_DFL, folder).agent.ends_by(SIGHUP), 0);
  AgentWithHangup by_nohup(SIG_IGN, folder);
  by_nohup.agent.process.send(SIGHUP);
  std::this_thread::sleep_for(500ms);
  EXPECT_FALSE(test::has_ended(by_nohup.agent.process.pid()));
  EXPECT_EQ(by_nohup.agent.ends_by(SIGTERM), 0);
}

TEST(Signals, AClosedOutputEndsNoProgram) {
  const test::TemporaryFolder folder;
  const std::string report = (folder.path() / "report.json").string();
  const std::string code = (folder.path() / "code").string();
  test::shell("{ '" + test::program("coppice") + "' run '" + (test::scenarios() / "blank-10.json").string() +
              "' --robots 1 --time-scale 10 --report '" + report + "' 2>&1; echo $? > '" + code +
              "'; } | true");
  EXPECT_EQ(test::contents(code), "0\n");
  EXPECT_EQ(read_report(report).outcome(), "arrived");
}

TEST(Logs, AnAgentLogsThatAnotherProcessHasItsRobot) {
  const test::TemporaryFolder folder;
  const test::TemporaryFolder other_folder;
  const Program agent(folder, {"robot_agent", "--name", "r1", "--domain", test::domain_name()});
  ASSERT_TRUE(agent.says("on domain " + test::domain_name()));
  const Program other(other_folder, {"robot_agent", "--name", "r1", "--domain", test::domain_name()});
  EXPECT_TRUE(agent.says("another process is the agent of robot r1"));
  EXPECT_TRUE(other.says("another process is the agent of robot r1"));
}

// A journal that got the file number of standard error would receive the log.
TEST(Signals, ClosedStreamsAreNotReusedForFiles) {
  const test::TemporaryFolder folder;
  const std::string log = (folder.path() / "log").string();
  const std::string once = "timeout --preserve-status -s TERM 2 '" + test::program("robot_agent") +
                           "' --name r1 --domain " + test::domain_name() + " --state '" +
                           folder.path().string() + "' ";
  for (const char* closed : {"2>&-", ">&-", "<&- >&- 2>&-"})
    EXPECT_EQ(std::system((once + closed).c_str()), 0) << closed;
  EXPECT_EQ(std::system((once + "2> '" + log + "'").c_str()), 0) << test::contents(log);
}

/// Receives what programs send to systemd.
class NotifySocket {
 public:
  explicit NotifySocket(const std::filesystem::path& file)
      : descriptor_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    file.string().copy(address.sun_path, sizeof address.sun_path - 1);
    if (bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("no socket at " + file.string());
    setenv("NOTIFY_SOCKET", file.c_str(), 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    close(descriptor_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;
  /// The next message; empty if none came in time.
  std::string next() const {
    pollfd ready{.fd = descriptor_, .events = POLLIN, .revents = 0};
    if (poll(&ready, 1, 10'000) != 1) return {};
    std::array<char, 256> text{};
    const ssize_t size = recv(descriptor_, text.data(), text.size(), 0);
    return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }

 private:
  int descriptor_;
};

TEST(Heartbeat, EachProgramTouchesItsFileAndNotifiesSystemd) {
  const test::TemporaryFolder folder;
  const std::string scenario = (test::scenarios() / "blank-10.json").string();
  const std::vector<std::vector<std::string>> commands{
      {"tree_broker", "--domain", test::domain_name()},
      {"robot_agent", "--domain", test::domain_name()},
      {"robot_agent", "--name", "r1", "--domain", test::domain_name()},
      {"planner_service", scenario, "--domain", test::domain_name()},
      {"coppice", "discovery", "--port", "23937"}};
  for (std::vector<std::string> command : commands) {
    SCOPED_TRACE(command[0]);
    const NotifySocket systemd(folder.path() / "notify");
    const std::filesystem::path alive = folder.path() / "alive";
    command.insert(command.end(), {"--alive", alive.string()});
    const Program program(folder, command);
    EXPECT_EQ(systemd.next(), "READY=1") << test::contents(program.log);
    ASSERT_TRUE(std::filesystem::exists(alive));
    const auto long_ago = std::filesystem::last_write_time(alive) - 1h;
    std::filesystem::last_write_time(alive, long_ago);
    EXPECT_EQ(systemd.next(), "WATCHDOG=1");
    EXPECT_EQ(systemd.next(), "WATCHDOG=1");
    EXPECT_GT(std::filesystem::last_write_time(alive), long_ago);
    std::filesystem::remove(alive);
    std::filesystem::remove(folder.path() / "notify");
  }
}

TEST(Logs, LogsAreLinesOfJsonOnRequest) {
  const test::TemporaryFolder folder;
  const std::string name = "a_\\_name";  // which JSON escapes
  Program agent(folder, {"robot_agent", "--name", name, "--domain", test::domain_name(), "--log-json"});
  ASSERT_TRUE(agent.says("on domain " + test::domain_name()));
  EXPECT_EQ(agent.ends_by(SIGTERM), 0);
  std::istringstream lines(test::contents(agent.log));
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    google::protobuf::Struct fields;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(line, &fields).ok()) << line;
    EXPECT_EQ(fields.fields().at("name").string_value(), "robot_agent " + name);
    EXPECT_EQ(fields.fields().at("level").string_value(), "info");
    EXPECT_EQ(fields.fields().at("message").string_value(), "on domain " + test::domain_name());
    EXPECT_EQ(fields.fields().at("time").string_value().size(),
              std::string("2026-01-01T00:00:00.000+00:00").size());
  }
  EXPECT_EQ(count, 1);
}

TEST(Logs, TheDiscoveryServerLogsAsRequested) {
  const test::TemporaryFolder folder;
  Program told(folder, {"coppice", "discovery", "--port", "23938", "--log-json"});
  EXPECT_TRUE(told.says(R"("message":"discovery server 0)")) << test::contents(told.log);
  EXPECT_EQ(told.ends_by(SIGTERM), 0);
  Program silent(folder, {"coppice", "discovery", "--port", "23938", "--log-level", "off", "--alive",
                          (folder.path() / "alive").string()});
  EXPECT_TRUE(test::within(10s, [&] { return std::filesystem::exists(folder.path() / "alive"); }));
  EXPECT_EQ(silent.ends_by(SIGTERM), 0);
  EXPECT_EQ(test::contents(silent.log), "");
}

TEST(Heartbeat, AnAliveFileThatCannotBeWrittenIsAnError) {
  const test::Outcome outcome = test::shell("'" + test::program("robot_agent") + "' --name r1 --domain " +
                                            test::domain_name() + " --alive /nowhere/alive");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.output.find("/nowhere/alive"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace coppice
