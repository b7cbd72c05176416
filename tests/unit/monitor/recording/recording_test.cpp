// Tests of a recording from the messages that arrive to those that are played, from the beginning and from
// any time.

#include "monitor/recording/recording.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "monitor/recording/recorder.h"
#include "monitor/recording/replay_clock.h"
#include "tests/support.h"
#include "tests/unit/monitor/recording/epoch.h"

namespace coppice {
namespace {

using test::epoch;

RobotState state(const char* robot, double t) {
  return {.robot = robot,
          .sequence = static_cast<std::uint32_t>(20 * t),
          .promise = {.stamp = t,
                      .position = {t, 0},
                      .decision_time = t,
                      .next_velocity = Point2::Zero(),
                      .expiry = t},
          .radius = 1,
          .max_speed = 4,
          .max_acceleration = 8,
          .round = {}};
}
Mission mission(const char* robot, std::uint32_t number) {
  return {.robot = robot,
          .number = number,
          .map_id = "m",
          .radius = 1,
          .max_speed = 4,
          .max_acceleration = 8,
          .goal_tolerance = 1,
          .clock = {epoch, 1}};
}
RootNodes nodes(const char* robot, std::uint32_t first) {
  return {robot, 1, first, {{Root::start, {1, 1}, -1}}};
}

/// The messages of two robots over 20 s, in order and 50 ms apart. One robot stands for most of the time.
std::vector<Arrival> fleet() {
  std::vector<Arrival> all;
  const auto say = [&](Message message, double t) {
    all.push_back(arrival_of(std::move(message), epoch + t));
  };
  MapMessage map{"m", {}, {1}};
  map.map.width = map.map.height = 3;
  map.map.blocked.assign(9, 0);
  say(map, 0);
  for (const char* robot : {"a", "b"}) say(mission(robot, 1), 0.01);
  for (int k = 1; k <= 400; ++k) {
    const double t = 0.05 * k;
    say(state("a", t), t);
    if (k % 40 == 0) say(state("b", t), t + 0.001);
    if (k % 20 == 0) say(nodes("a", static_cast<std::uint32_t>(k / 20 - 1)), t + 0.002);
    if (k % 10 == 0) say(BrokerStatus{.broker = 7, .trees_active = static_cast<std::uint32_t>(k)}, t + 0.003);
    if (k == 200) say(mission("b", 2), t + 0.004);
  }
  return all;
}

class RecordingTest : public testing::Test {
 protected:
  /// Records as a recorder that looks every 100 ms. It takes what it finds in the order of the topics.
  std::string record(const std::vector<Arrival>& all, bool whole = true) {
    Recorder recorder;
    std::ofstream out(folder_.path() / "r.mcap", std::ios::binary);
    std::size_t next = 0;
    for (int k = 1; next < all.size(); ++k) {
      const WallTime now = epoch + 0.1 * k;
      std::vector<Arrival> taken;
      for (; next < all.size() && all[next].at <= now; ++next) taken.push_back(all[next]);
      std::ranges::stable_sort(taken, {}, [](const Arrival& a) { return a.message->index(); });
      recorder.on(taken);
      out << recorder.step(now);
    }
    if (whole) out << recorder.finish();
    return (folder_.path() / "r.mcap").string();
  }
  static std::vector<Arrival> play(const Recording& recording, WallTime from,
                                   const Topics& topics = Topics().set()) {
    std::vector<Arrival> all;
    Playback playback(recording, from, topics);
    while (auto next = playback.next()) all.push_back(std::move(*next));
    EXPECT_EQ(playback.rejected(), 0u);
    return all;
  }
  static void expect_same(const std::vector<Arrival>& found, const std::vector<Arrival>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(*found[k].message, *expected[k].message) << k;
      EXPECT_NEAR(found[k].at, expected[k].at, 1e-6) << k;
    }
  }
  test::TemporaryFolder folder_;
};

TEST_F(RecordingTest, ARecordingHoldsEveryMessageInOrder) {
  const Recording recording(record(fleet()));
  EXPECT_EQ(recording.file().ending(), "");
  EXPECT_NEAR(recording.begin(), epoch, 1e-6);
  EXPECT_NEAR(recording.end(), epoch + 20.003, 1e-6);
  EXPECT_EQ(recording.count(topic_number<RobotState>()), 410u);
  expect_same(play(recording, recording.begin()), fleet());
}

TEST_F(RecordingTest, ARecordingThatWasCutOffHoldsAllButTheLastSecond) {
  const Recording recording(record(fleet(), false));
  EXPECT_NE(recording.file().ending(), "");
  EXPECT_GT(recording.end(), epoch + 18.5);
  std::vector<Arrival> expected = fleet();
  std::erase_if(expected, [&](const Arrival& a) { return a.at > recording.end() + 1e-6; });
  expect_same(play(recording, recording.begin()), expected);
}

/// What a participant that joins at `from` is given, in the order of arrival.
std::vector<Arrival> expected_from(WallTime from) {
  std::vector<Arrival> all;
  const std::vector<Arrival> heard = fleet();
  for (std::size_t k = 0; k < heard.size(); ++k) {
    const Message& message = *heard[k].message;
    const auto is_newer = [&](const Arrival& later) {
      if (later.at >= from || later.message->index() != message.index()) return false;
      if (const auto* m = std::get_if<Mission>(&message))
        return m->robot == std::get<Mission>(*later.message).robot;
      if (const auto* m = std::get_if<RobotState>(&message))
        return m->robot == std::get<RobotState>(*later.message).robot;
      return !std::holds_alternative<RootNodes>(message);
    };
    const bool replaced =
        heard[k].at < from &&
        std::any_of(heard.begin() + static_cast<std::ptrdiff_t>(k) + 1, heard.end(), is_newer);
    if (!replaced) all.push_back(heard[k]);
  }
  return all;
}

TEST_F(RecordingTest, PlaybackFromAnyTimeBeginsWithWhatIsValidThen) {
  const Recording recording(record(fleet()));
  for (const double t : {0.02, 3.7, 9.99, 10.02, 15.0251, 19.99}) {
    SCOPED_TRACE(t);
    expect_same(play(recording, epoch + t), expected_from(epoch + t));
  }
}

TEST_F(RecordingTest, PlaybackFromALateTimeReadsNoEarlierStates) {
  const std::string file = record(fleet());
  // A chunk of early states is damaged, so that reading it fails.
  const Recording sound(file);
  const std::uint16_t states = *sound.channels_of(Topics().set(topic_number<RobotState>())).begin();
  const auto early = std::ranges::find_if(sound.file().pieces(), [&](const McapReader::Piece& piece) {
    return piece.channels == std::vector{states};
  });
  ASSERT_NE(early, sound.file().pieces().end());
  std::string damaged = test::contents(file);
  damaged[early->offset + early->length - 5] ^= 1;
  const Recording recording(folder_.write("damaged.mcap", damaged).string());
  EXPECT_THROW(play(recording, recording.begin()), InputError);
  EXPECT_NO_THROW(play(recording, epoch + 15));
}

TEST_F(RecordingTest, PlaybackShowsOnlyTheRequestedTopics) {
  const Recording recording(record(fleet()));
  const auto missions = play(recording, recording.begin(), Topics().set(topic_number<Mission>()));
  EXPECT_EQ(missions.size(), 3u);
}

TEST_F(RecordingTest, PlaybackDropsMessagesThatFailValidation) {
  std::vector<Arrival> all = fleet();
  RobotState forged = state("a", 1);
  forged.max_speed = -1;
  all.push_back(arrival_of(forged, epoch + 21));
  const Recording recording(record(all));
  Playback playback(recording, recording.begin());
  std::size_t played = 0;
  while (playback.next()) ++played;
  EXPECT_EQ(played, all.size() - 1);
  EXPECT_EQ(playback.rejected(), 1u);
}

TEST_F(RecordingTest, ARecordingKeepsItsOrderIfMessagesComeLate) {
  Recorder recorder;
  std::string file = recorder.step(epoch);
  recorder.on({arrival_of(state("a", 2), epoch + 2), arrival_of(state("b", 1), epoch + 1)});
  recorder.on({arrival_of(mission("a", 1), epoch + 0.5)});  // it was held back until its sender was known
  file += recorder.finish();
  const Recording recording(folder_.write("r.mcap", file).string());
  const auto all = play(recording, recording.begin());
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(std::get<RobotState>(*all[0].message).robot, "b");
  EXPECT_NEAR(all[0].at, epoch + 1, 1e-6);
  EXPECT_NEAR(all[2].at, epoch + 2, 1e-6);
}

TEST_F(RecordingTest, ARecordingGoesOnInOrderIfTheClockIsSetBack) {
  Recorder recorder;
  std::string bytes;
  const auto step = [&](double t, double clock) {
    recorder.on({arrival_of(state("a", t), clock)});
    bytes += recorder.step(clock);
  };
  for (int k = 0; k < 100; ++k) step(0.1 * k, epoch + 0.1 * k);
  for (int k = 0; k < 100; ++k) step(10 + 0.1 * k, epoch - 3600 + 0.1 * k);
  EXPECT_GT(bytes.size(), 5'000u) << "messages are written within a second";
  bytes += recorder.finish();
  const std::string file = folder_.write("back.mcap", bytes).string();
  const Recording recording(file);
  EXPECT_NEAR(recording.end() - recording.begin(), 19.8, 0.1);
  const auto all = play(recording, recording.begin());
  ASSERT_EQ(all.size(), 200u);
  for (std::size_t k = 1; k < all.size(); ++k) EXPECT_GE(all[k].at, all[k - 1].at);
}

TEST_F(RecordingTest, AForeignFileIsNoRecording) {
  McapWriter writer("other");
  writer.add_channel("/chatter", "protobuf", "std.String", "");
  writer.finish();
  EXPECT_THROW(Recording(folder_.write("r.mcap", writer.take()).string()), InputError);
}

TEST(ReplayClock, AReplayKeepsFleetTime) {
  const ReplayClock clock{.from = epoch + 10, .start = epoch + 5000, .speed = 4};
  Mission m = mission("a", 1);
  m.clock = {epoch + 2, 0.5};
  const auto now = std::get<Mission>(at_present(m, clock));
  for (const double t : {0.0, 10.0, 17.0})
    EXPECT_NEAR(now.clock.fleet_time(clock.present(epoch + t)), m.clock.fleet_time(epoch + t), 1e-6);
  EXPECT_EQ(clock.present(epoch + 10), epoch + 5000);
  EXPECT_EQ(clock.present(epoch + 14), epoch + 5001);
}

TEST(ReplayClock, AReplayKeepsTheShareOfProcessorTime) {
  const ReplayClock clock{.from = epoch, .start = epoch + 5000, .speed = 4};
  const auto broker = [&](double seconds, WallTime leading_since) {
    BrokerStatus status{.broker = 1, .leading_since = leading_since};
    status.processor_seconds = seconds;
    return std::get<BrokerStatus>(at_present(status, clock));
  };
  EXPECT_EQ(broker(1, epoch + 8).leading_since, epoch + 5002);
  EXPECT_EQ(broker(1, 0).leading_since, 0) << "it does not lead";
  const double share = (broker(3, 0).processor_seconds - broker(1, 0).processor_seconds) /
                       (clock.present(epoch + 8) - clock.present(epoch + 4));
  EXPECT_NEAR(share, 2.0 / 4, 1e-9);
}

}  // namespace
}  // namespace coppice
