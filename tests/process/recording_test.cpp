// Tests of a run that is recorded over DDS, described, and replayed; and of a recorder that is killed or
// finds no room.
//
// CTest: RESOURCE_LOCK lane_2

#include "monitor/recording/recording.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "dds/dds_bus.h"
#include "messages/topics.h"
#include "monitor/view/fleet_view.h"
#include "runtime/process.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using test::Background;
using test::Outcome;
using test::shell;

std::vector<std::string> coppice(const std::vector<std::string>& arguments) {
  std::vector<std::string> command{test::program("coppice")};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}
std::vector<std::string> run_of_four(int on, const std::vector<std::string>& more = {}) {
  std::vector<std::string> command =
      coppice({"run", (test::scenarios() / "rooms-8.json").string(), "--robots", "4", "--time-scale", "4",
               "--domain", std::to_string(on)});
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

std::map<std::string, std::uint64_t> counts_of(const std::string& file) {
  const Recording recording(file);
  std::map<std::string, std::uint64_t> counts;
  for (TopicNumber topic = 0; topic < topic_count; ++topic)
    counts[channel_name(topic)] = recording.count(topic);
  return counts;
}

/// The least time between a state and its arrival, in fleet seconds. A busy machine delays most messages of a
/// recording or a replay, and some message nevertheless arrives at once.
double least_delay(const Recording& recording) {
  FleetView view;
  double least = std::numeric_limits<double>::infinity();
  Playback playback(recording, recording.begin());
  while (const auto next = playback.next()) {
    view.on(next->message, next->at);
    const auto* const state = std::get_if<RobotState>(next->message.get());
    const auto time = view.fleet_time(next->at);
    if (state != nullptr && !state->passed_on && time) least = std::min(least, *time - state->promise.stamp);
  }
  return least;
}

/// One run that is recorded once for all tests.
class RecordedRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new test::TemporaryFolder;
    Background run(
        run_of_four(test::own_domain(), {"--record", path("run.mcap"), "--trajectory", path("t.csv")}),
        path("run.log"));
    exit_code = run.wait();
  }
  static void TearDownTestSuite() {
    delete folder;
    folder = nullptr;
  }
  static std::string path(const std::string& name) { return (folder->path() / name).string(); }

  static inline test::TemporaryFolder* folder = nullptr;
  static inline int exit_code = -1;
};

TEST_F(RecordedRun, TheRecordingHoldsTheWholeRun) {
  ASSERT_EQ(exit_code, 0) << test::contents(path("run.log"));
  const Recording recording(path("run.mcap"));
  EXPECT_EQ(recording.file().ending(), "");
  std::set<RobotName> arrived;
  std::set<RobotName> cancelled;
  std::map<RobotName, std::size_t> points;
  Playback playback(recording, recording.begin());
  while (const auto next = playback.next()) {
    if (const auto* m = std::get_if<AgentStatus>(next->message.get()); m && m->phase == Phase::arrived)
      arrived.insert(m->robot);
    if (const auto* m = std::get_if<Mission>(next->message.get()); m && m->cancelled)
      cancelled.insert(m->robot);
    if (const auto* m = std::get_if<TrackMessage>(next->message.get())) points[m->robot] += m->points.size();
  }
  EXPECT_EQ(playback.rejected(), 0u);
  EXPECT_EQ(arrived.size(), 4u);
  EXPECT_EQ(cancelled.size(), 4u) << "it holds the last messages of the service";
  for (const auto& [robot, count] : points) EXPECT_GT(count, 50u) << robot;
  EXPECT_EQ(points.size(), 4u);
}

TEST_F(RecordedRun, TheRecordingIsDescribed) {
  const Outcome info = shell(test::program("coppice") + " info " + path("run.mcap"));
  EXPECT_EQ(info.exit_code, 0) << info.output;
  for (const char* part :
       {", complete", "4 robots: r1 r2 r3 r4", "zstd", "/coppice/robot_state", "/coppice/map"})
    EXPECT_NE(info.output.find(part), std::string::npos) << part << " in " << info.output;
  // A recording that is cut in the middle.
  const std::string whole = test::contents(path("run.mcap"));
  folder->write("cut.mcap", whole.substr(0, 2 * whole.size() / 3));
  const Outcome cut = shell(test::program("coppice") + " info " + path("cut.mcap"));
  EXPECT_EQ(cut.exit_code, 0) << cut.output;
  for (const char* part : {"not complete", "within the record", "4 robots: r1 r2 r3 r4"})
    EXPECT_NE(cut.output.find(part), std::string::npos) << part << " in " << cut.output;
  const Outcome none = shell(test::program("coppice") + " info " + path("t.csv"));
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.output.find("t.csv"), std::string::npos) << none.output;
}

TEST_F(RecordedRun, TheRecordingIsExplained) {
  const auto explained = [](const std::string& arguments) {
    return shell(test::program("coppice") + " explain " + arguments);
  };
  const Outcome all = explained(path("run.mcap") + " r1");
  EXPECT_EQ(all.exit_code, 0) << all.output;
  for (const char* part :
       {": r1 got mission 1, to (", "r1 drove ", "r1 stood at its goal.", "its run had ended"})
    EXPECT_NE(all.output.find(part), std::string::npos) << part << " in " << all.output;
  const Outcome moment = explained(path("run.mcap") + " r1 5");
  EXPECT_EQ(moment.exit_code, 0) << moment.output;
  for (const char* part :
       {"r1 at 5.00 s\n", "\nPlace: ", "\nTask: ", "\nDecision: ", "\nReservation: ", "\nContact: "})
    EXPECT_NE(moment.output.find(part), std::string::npos) << part << " in " << moment.output;

  folder->write("empty.mcap", "");
  const std::vector<std::pair<std::string, std::string>> mistakes{
      {path("run.mcap") + " r5",
       "there is no robot \"r5\" (did you mean r1?): the recording holds r1, r2, r3, r4"},
      {path("run.mcap") + " r1 1e6", "time 1e+06: expected a fleet time of the recording"},
      {path("run.mcap") + " r1 soon", "soon"},
      {path("none.mcap") + " r1", "none.mcap: cannot be read"},
      {path("empty.mcap") + " r1", "empty.mcap: is empty"},
      {path("t.csv") + " r1", "expected a recording (MCAP)"}};
  for (const auto& [arguments, message] : mistakes) {
    const Outcome refused = explained(arguments);
    EXPECT_EQ(refused.exit_code, 2) << refused.output;
    EXPECT_NE(refused.output.find(message), std::string::npos) << message << " in " << refused.output;
  }
}

TEST_F(RecordedRun, TheRecordingIsNotReplaced) {
  const std::string before = test::contents(path("run.mcap"));
  Background again(run_of_four(test::own_domain(1), {"--record", path("run.mcap")}), path("again.log"));
  EXPECT_EQ(again.wait(), 2);
  EXPECT_NE(test::contents(path("again.log")).find("already exists"), std::string::npos);
  const Outcome record = shell(test::program("coppice") + " record --domain " + test::domain_name(1) +
                               " --duration 0.1 " + path("run.mcap"));
  EXPECT_EQ(record.exit_code, 2);
  EXPECT_NE(record.output.find("--force"), std::string::npos) << record.output;
  EXPECT_EQ(test::contents(path("run.mcap")), before);
}

TEST_F(RecordedRun, TheRecordingIsReplayedForOthers) {
  Background second(coppice({"record", path("second.mcap"), "--domain", test::domain_name(1)}),
                    path("second.log"));
  ASSERT_TRUE(test::within(10s, [&] { return std::filesystem::exists(path("second.mcap")); }));
  Background replay(coppice({"replay", path("run.mcap"), "--domain", test::domain_name(1), "--speed", "2"}),
                    path("replay.log"));
  EXPECT_EQ(replay.wait(), 0) << test::contents(path("replay.log"));
  second.send(SIGTERM);
  EXPECT_EQ(second.wait(), 0) << test::contents(path("second.log"));
  const auto were = counts_of(path("run.mcap"));
  const std::set<std::string> kept_all{"/coppice/map", "/coppice/inactive_tree", "/coppice/root_nodes",
                                       "/coppice/track"};
  const auto least = [&](const std::string& channel) {
    const std::uint64_t said = were.at(channel);
    if (kept_all.contains(channel)) return said;
    if (channel == "/coppice/robot_state") return said / 2;
    // For the other topics, DDS keeps the latest sample of each key for a reader: those of four robots.
    return std::min<std::uint64_t>(said / 2, 4);
  };
  for (const auto& [channel, count] : counts_of(path("second.mcap"))) {
    EXPECT_GE(count, least(channel)) << channel;
    EXPECT_LE(count, were.at(channel)) << channel;
  }

  // The fleet times are the same, and the fleet clock follows the present one.
  const Recording first(path("run.mcap"));
  const Recording again(path("second.mcap"));
  EXPECT_NEAR(again.end() - again.begin(), (first.end() - first.begin()) / 2, 1.5);
  const auto view_of = [](const Recording& recording) {
    FleetView view;
    Playback playback(recording, recording.begin());
    while (const auto next = playback.next()) view.on(next->message, next->at);
    return view;
  };
  const FleetView one = view_of(first);
  const FleetView other = view_of(again);
  EXPECT_NEAR(least_delay(first), least_delay(again), 0.2);
  ASSERT_EQ(other.robots().size(), 4u);
  for (const SeenRobot& robot : other.robots()) {
    const SeenRobot& same = one.robots()[*one.find(robot.name)];
    ASSERT_TRUE(robot.state && same.state) << robot.name;
    RobotState state = *same.state;
    state.run = robot.state->run;  // it has another clock
    EXPECT_EQ(*robot.state, state) << robot.name;
    EXPECT_EQ(robot.path, same.path) << robot.name;
  }
}

TEST_F(RecordedRun, TheRecordingIsReplayedFromAnyTime) {
  const Recording recording(path("run.mcap"));
  const double from = 0.6 * (recording.end() - recording.begin());
  DdsBus watcher({.domain = test::own_domain(1)}, Role::observer, "watcher");
  Background replay(coppice({"replay", path("run.mcap"), "--domain", test::domain_name(1), "--from",
                             std::to_string(from), "--speed", "4"}),
                    path("replay.log"));
  FleetView view;
  double first_time = -1;
  test::within(30s, [&] {
    for (const Arrival& arrival : watcher.take()) {
      view.on(arrival.message, arrival.at);
      if (first_time < 0 && view.robots().size() == 4)
        first_time = view.fleet_time(DisciplinedClock::read().system).value_or(-1);
    }
    return test::has_ended(replay.pid());
  });
  EXPECT_EQ(replay.wait(), 0);
  EXPECT_TRUE(view.map().has_value()) << "the map was sent at the beginning";
  EXPECT_EQ(view.robots().size(), 4u);
  EXPECT_GT(first_time, 5) << "fleet seconds: the replay must not start at the beginning";
}

TEST_F(RecordedRun, TheRecordingIsNotReplayedOnTheDomainOfAFleet) {
  const DdsBus broker({.domain = test::own_domain(1)}, Role::broker, "broker");
  DdsBus service({.domain = test::own_domain(1)}, Role::service, "service");
  MapMessage map{"m", {}, {1}};
  map.map.width = map.map.height = 2;
  map.map.blocked.assign(4, 0);
  service.publish(Message(map));
  const Outcome replay =
      shell(test::program("coppice") + " replay --domain " + test::domain_name(1) + " " + path("run.mcap"));
  EXPECT_EQ(replay.exit_code, 2) << replay.output;
  EXPECT_NE(replay.output.find("a fleet or another replay is active"), std::string::npos) << replay.output;
}

TEST_F(RecordedRun, AFleetIgnoresTheRecording) {
  DdsBus watcher({.domain = test::own_domain(1)}, Role::observer, "watcher");
  DdsBus agent({.domain = test::own_domain(1), .robot = "r9"}, Role::agent, "agent");
  Background replay(coppice({"replay", path("run.mcap"), "--domain", test::domain_name(1)}),
                    path("replay.log"));
  std::size_t seen = 0;
  std::size_t taken = 0;
  EXPECT_TRUE(test::within(20s, [&] {
    seen += watcher.take().size();
    taken += agent.take().size();
    return seen > 500;
  }));
  EXPECT_EQ(taken, 0u) << "an agent accepted a recorded mission";
  EXPECT_GT(agent.rejected(), 0u);
  replay.send(SIGTERM);
  EXPECT_EQ(replay.wait(), 0) << test::contents(path("replay.log"));
}

TEST(Recorder, AKilledRecorderLeavesWhatItHasWritten) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "killed.mcap").string();
  Background recorder(coppice({"record", file, "--domain", test::domain_name()}), folder.path() / "log");
  Background run(run_of_four(test::own_domain()), folder.path() / "run.log");
  const auto holds_states = [&] {
    try {
      const Recording recording(file);
      return recording.count(topic_number<RobotState>()) > 200 &&
             recording.count(topic_number<Mission>()) >= 4;
    } catch (const InputError&) {
      return false;  // not even the beginning is there
    }
  };
  EXPECT_TRUE(test::within(40s, holds_states)) << "the file is readable while it is written";
  recorder.send(SIGKILL);
  recorder.wait();
  const Recording recording(file);
  EXPECT_NE(recording.file().ending(), "");
  Playback playback(recording, recording.begin());
  std::uint64_t played = 0;
  while (playback.next()) ++played;
  EXPECT_EQ(played, recording.file().statistics().messages);
  EXPECT_EQ(run.wait(), 0) << "the fleet is not affected";
}

TEST(Recorder, ARecorderWithoutRoomSaysSoAndLeavesWhatItHasWritten) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "full.mcap").string();
  Background run(run_of_four(test::own_domain()), folder.path() / "run.log");
  // 480 blocks of 512 bytes hold the descriptions and some seconds. SIGXFSZ is ignored, as it would end the
  // recorder.
  const Outcome record = shell("ulimit -f 480; exec " + test::program("coppice") +
                               " record --duration 60 --domain " + test::domain_name() + " " + file);
  EXPECT_EQ(record.exit_code, 2) << record.output;
  EXPECT_NE(record.output.find("full.mcap: cannot be written"), std::string::npos) << record.output;
  const Recording recording(file);
  EXPECT_GT(recording.file().statistics().messages, 0u);
  Playback playback(recording, recording.begin());
  while (playback.next()) {
  }
  run.send(SIGTERM);
  run.wait();
}

}  // namespace
}  // namespace coppice
