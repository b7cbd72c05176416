// Tests of a recording that pages play, and of pictures of it.
#include "monitor/recording/player.h"

#include <fstream>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "monitor/recording/picture_book.h"
#include "monitor/recording/recorder.h"
#include "tests/support.h"
#include "tests/unit/monitor/recording/epoch.h"

namespace coppice {
namespace {

using test::epoch;

/// A robot drives at 1 m/s along x from x = 20 m for 10 s. The recording begins 0.5 s before the run.
std::vector<Arrival> drive() {
  std::vector<Arrival> all;
  MapMessage map{"m", {}, {1}};
  map.map.width = 60;
  map.map.height = 20;
  map.map.blocked.assign(1200, 0);
  all.push_back(arrival_of(map, epoch - 0.5));
  const Mission mission{.robot = "a",
                        .number = 1,
                        .map_id = "m",
                        .start = {20, 10},
                        .goal = {30, 10},
                        .radius = 1,
                        .max_speed = 4,
                        .max_acceleration = 8,
                        .goal_tolerance = 1,
                        .clock = {epoch, 1}};
  all.push_back(arrival_of(mission, epoch - 0.1));
  all.push_back(arrival_of(InactiveTreesMessage{{1, 1}, "m", 1, {{{5, 5}, -1, 3}, {{9, 5}, 0, 3}}}, epoch));
  all.push_back(
      arrival_of(RootNodes{"a", 1, 0, {{Root::start, {20, 10}, -1}, {Root::start, {22, 10}, 0}}}, epoch));
  all.push_back(arrival_of(PathMessage{"a", 1, {{20, 10}, {30, 10}}}, epoch));
  for (int k = 0; k <= 200; ++k) {
    const double t = 0.05 * k;
    all.push_back(arrival_of(RobotState{.robot = "a",
                                        .sequence = static_cast<std::uint32_t>(k),
                                        .promise = {.stamp = t,
                                                    .position = {20 + t, 10},
                                                    .velocity = {1, 0},
                                                    .decision_time = t + 0.05,
                                                    .next_velocity = {1, 0},
                                                    .expiry = t + 0.1},
                                        .radius = 1,
                                        .max_speed = 4,
                                        .max_acceleration = 8,
                                        .phase = Phase::driving},
                             epoch + t));
  }
  return all;
}

std::string write(const std::filesystem::path& file, std::vector<Arrival> all) {
  Recorder recorder;
  recorder.on(std::move(all));
  std::ofstream out(file, std::ios::binary);
  for (const mcap::Bytes& bytes : {recorder.step(epoch + 60), recorder.finish()})
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return file.string();
}

struct OfADrive : testing::Test {
  test::TemporaryFolder folder;
  Recording recording{write(folder.path() / "drive.mcap", drive())};
};
using PlayerTest = OfADrive;
using PictureBookTest = OfADrive;

live::FromPage play(bool playing) {
  live::FromPage wish;
  wish.set_playing(playing);
  return wish;
}
live::FromPage seek(double to) {
  live::FromPage wish;
  wish.set_seek(to);
  return wish;
}
live::FromPage speed(double value) {
  live::FromPage wish;
  wish.set_speed(value);
  return wish;
}

/// The stamp of the last state among them; negative if there is none.
double last_stamp(const std::vector<Arrival>& arrivals) {
  double stamp = -1;
  for (const Arrival& arrival : arrivals) {
    if (const auto* state = std::get_if<RobotState>(arrival.message.get())) stamp = state->promise.stamp;
  }
  return stamp;
}

TEST_F(PlayerTest, APlayerPlaysAtRealSpeedToTheEndAndStops) {
  Player player(recording, 50);
  EXPECT_EQ(player.due(50).size(), 1u);  // the map: the recording begins with it
  EXPECT_NEAR(last_stamp(player.due(52.5)), 2, 0.051);
  EXPECT_NEAR(player.at(52.5), epoch + 2, 1e-6);
  EXPECT_TRUE(player.state(52.5).playing());
  EXPECT_NEAR(last_stamp(player.due(70)), 10, 1e-9);
  EXPECT_FALSE(player.state(70).playing());
  EXPECT_NEAR(player.at(99), epoch + 10, 1e-6);
  EXPECT_TRUE(player.due(99).empty());
  EXPECT_TRUE(player.heed(play(true), 100));  // from the beginning again
  EXPECT_EQ(player.due(100).size(), 1u);
}

TEST_F(PlayerTest, APlayerPausesAndGoesOnAtAnotherSpeed) {
  Player player(recording, 0);
  EXPECT_FALSE(player.heed(play(false), 1.5));
  EXPECT_NEAR(last_stamp(player.due(5)), 1, 0.051);
  EXPECT_TRUE(player.due(8).empty());
  EXPECT_FALSE(player.heed(speed(4), 9));
  EXPECT_FALSE(player.heed(play(true), 10));
  EXPECT_NEAR(last_stamp(player.due(11)), 5, 0.051);
  EXPECT_EQ(player.state(11).speed(), 4);
  player.heed(speed(std::numeric_limits<double>::quiet_NaN()), 11);
  EXPECT_EQ(player.state(11).speed(), 4);
  player.heed(speed(-3), 11);
  EXPECT_GT(player.state(11).speed(), 0);
}

TEST_F(PlayerTest, ASeekDeliversAllThatIsValidThere) {
  Player player(recording, 0);
  player.due(9);
  ASSERT_TRUE(player.heed(seek(epoch + 4), 9));
  FleetView view;
  for (const Arrival& arrival : player.due(9)) view.on(arrival.message, arrival.at);
  ASSERT_EQ(view.robots().size(), 1u);
  EXPECT_NEAR(view.robots()[0].state->promise.stamp, 4, 0.051);
  EXPECT_FALSE(view.robots()[0].path.empty());
  EXPECT_EQ(view.inactive_trees().size(), 1u);
  EXPECT_EQ(view.robots()[0].root_nodes.size(), 2u);
  EXPECT_TRUE(player.heed(seek(0), 9));  // long before the beginning
  EXPECT_NEAR(player.at(9), epoch - 0.5, 1e-6);
  EXPECT_FALSE(player.heed(seek(std::numeric_limits<double>::infinity()), 9));
  EXPECT_FALSE(player.heed(live::FromPage(), 9));
}

TEST_F(PictureBookTest, APictureShowsTheFleetAtATime) {
  PictureBook book(recording);
  EXPECT_EQ(book.begin(), 0);
  EXPECT_NEAR(book.end(), 10, 1e-6);
  const PictureContent content = book.at(4);
  ASSERT_EQ(content.robots.size(), 1u);
  const PictureContent::Robot& robot = content.robots[0];
  EXPECT_NEAR(robot.body.value().x(), 24, 1e-6);
  EXPECT_EQ(robot.goal, Point2(30, 10));
  EXPECT_EQ(robot.path.size(), 2u);
  EXPECT_EQ(robot.track.front(), Point2(20, 10));
  EXPECT_EQ(robot.track.back(), *robot.body);
  ASSERT_EQ(content.edges.size(), 2u);
  EXPECT_EQ(content.edges[0].robot, -1);
  EXPECT_EQ(content.edges[1].robot, 0);
  EXPECT_EQ(content.map.width, 60);
  EXPECT_NEAR(book.at(6).robots[0].body.value().x(), 26, 1e-6);
  const std::string svg = picture_svg(book.at(10));
  EXPECT_NE(svg.find("disc: robot"), std::string::npos);
}

TEST(PictureBook, APictureNeedsAFleet) {
  const test::TemporaryFolder folder;
  const Recording recording(write(folder.path() / "r.mcap", {arrival_of(BrokerStatus{.broker = 1}, epoch)}));
  EXPECT_THROW(PictureBook{recording}, InputError);
}

}  // namespace
}  // namespace coppice
