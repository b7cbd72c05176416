// Tests of the Foxglove protocol: the messages to and from a client, and the positions in a scene.

#include "monitor/foxglove/foxglove.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <regex>

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "foxglove_socket.pb.h"
#include "monitor/foxglove/foxglove_scene.h"
#include "monitor/view/live_stream.h"
#include "tests/support.h"
#include "tests/unit/monitor/seen_fleet.h"

namespace coppice {
namespace {

namespace fox = ::foxglove;
namespace socket = foxglove_socket;

template <class M>
M from_json(const std::string& json) {
  M message;
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(json, &message).ok()) << json;
  return message;
}

template <class M>
M from_bytes(const std::string& bytes) {
  M message;
  EXPECT_TRUE(message.ParseFromString(bytes));
  return message;
}

struct Data {
  std::uint32_t subscription = 0;
  std::uint64_t nanoseconds = 0;
  std::string payload;
};

Data data_of(const Outbound& out) {
  const std::string& bytes = *out.bytes;
  EXPECT_FALSE(out.text);
  EXPECT_GE(bytes.size(), 13u);
  EXPECT_EQ(bytes[0], 1);
  Data data{.payload = bytes.substr(13)};
  const auto byte = [&](std::size_t k) { return std::uint64_t{static_cast<unsigned char>(bytes[k])}; };
  for (std::size_t k = 0; k < 4; ++k) data.subscription |= static_cast<std::uint32_t>(byte(1 + k) << 8 * k);
  for (std::size_t k = 0; k < 8; ++k) data.nanoseconds |= byte(5 + k) << 8 * k;
  return data;
}

struct FoxgloveTest : testing::Test {
  test::SeenFleet fleet;
  LiveStream live{"here"};
  FoxgloveFeed feed;

  std::vector<Outbound> after(double seconds) {
    fleet.now += seconds;
    live.look(fleet.view, fleet.now);
    return feed.next(fleet.view, live);
  }
  std::uint32_t channel(const std::string& topic) {
    FoxgloveFeed fresh;
    const auto advertised = from_json<socket::Advertise>(*fresh.next(fleet.view, live).at(1).bytes);
    for (const auto& one : advertised.channels()) {
      if (one.topic() == topic) return one.id();
    }
    ADD_FAILURE() << topic;
    return 0;
  }
  void subscribe(std::uint32_t id, const std::string& topic) {
    feed.on(R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(id) + R"(,"channelId":)" +
                std::to_string(channel(topic)) + "}]}",
            true);
  }
  /// The only message of the only subscription.
  template <class M>
  M only(const std::vector<Outbound>& out) {
    EXPECT_EQ(out.size(), 1u);
    return out.empty() ? M() : from_bytes<M>(data_of(out[0]).payload);
  }
  void small_fleet() {
    fleet.map();
    fleet.mission("a");
    fleet.state("a", {1, 0.5}, {0, 1});
    fleet.status("a", Phase::driving);
    fleet.path("a", {{0.5, 1.5}, {3.5, 1.5}});
    fleet.tree(1);
    fleet.root_nodes("a", 0, 4);
  }
};

TEST_F(FoxgloveTest, AClientIsGreetedWithServerInformationAndChannels) {
  const auto out = after(0);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_TRUE(out[0].text && out[1].text);
  EXPECT_NE(out[0].bytes->find(R"("op":"serverInfo")"), std::string::npos);
  EXPECT_NE(out[0].bytes->find(R"("capabilities":[])"), std::string::npos) << "clients may only read";
  const auto advertised = from_json<socket::Advertise>(*out[1].bytes);
  EXPECT_EQ(advertised.op(), "advertise");
  ASSERT_EQ(advertised.channels_size(), 9);
  for (const auto& channel : advertised.channels()) {
    EXPECT_EQ(channel.encoding(), "protobuf");
    google::protobuf::FileDescriptorSet files;
    ASSERT_TRUE(files.ParseFromString(channel.schema()));
    google::protobuf::DescriptorPool pool;
    for (const auto& file : files.file())
      ASSERT_NE(pool.BuildFile(file), nullptr) << "a file before its imports";
    EXPECT_NE(pool.FindMessageTypeByName(channel.schema_name()), nullptr) << channel.schema_name();
  }
  EXPECT_TRUE(after(1).empty());
}

TEST_F(FoxgloveTest, AClientGetsOnlySubscribedChannels) {
  small_fleet();
  after(0);
  EXPECT_TRUE(after(0.5).empty());
  subscribe(5, "/poses");
  const auto out = after(0.5);
  ASSERT_EQ(out.size(), 1u);
  const Data data = data_of(out[0]);
  EXPECT_EQ(data.subscription, 5u);
  EXPECT_EQ(data.nanoseconds, 101'000'000'000u);
  feed.on(R"({"op":"unsubscribe","subscriptionIds":[5]})", true);
  EXPECT_TRUE(after(0.5).empty());
}

TEST_F(FoxgloveTest, InvalidRequestsAreAnsweredByErrorsAndChangeNothing) {
  small_fleet();
  after(0);
  subscribe(1, "/poses");
  feed.on("{", true);
  feed.on("[]", true);
  feed.on(R"({"op":"setParameters","parameters":[{"name":"x","value":1}]})", true);
  feed.on(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})", true);
  feed.on(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":99}]})", true);
  feed.on(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})", true);
  feed.on(std::string("\x01\x01\x00\x00\x00x", 6), false);
  const auto out = after(0.5);
  ASSERT_EQ(out.size(), 8u);
  for (std::size_t k = 0; k < 7; ++k) {
    const auto status = from_json<socket::Status>(*out[k].bytes);
    EXPECT_EQ(status.op(), "status");
    EXPECT_EQ(status.level(), 2u);
  }
  EXPECT_EQ(data_of(out[7]).subscription, 1u);
}

TEST_F(FoxgloveTest, DeeplyNestedJsonIsRefused) {
  after(0);
  const std::string deep(60'000, '[');
  feed.on(deep, true);
  feed.on(R"({"op":"subscribe","x":)" + deep, true);
  feed.on(R"({"op":"subscribe","subscriptions":)" + deep + std::string(60'000, ']') + "}", true);
  const auto out = after(0.5);
  EXPECT_GE(out.size(), 2u) << "nested empty lists may be accepted as empty";
  for (const Outbound& one : out) EXPECT_TRUE(one.text);
}

TEST_F(FoxgloveTest, SubscriptionsAndErrorsAreBounded) {
  small_fleet();
  after(0);
  for (std::uint32_t id = 0; id < 100; ++id)
    feed.on(R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(id) + R"(,"channelId":3}]})",
            true);
  const auto out = after(0.5);
  EXPECT_EQ(std::ranges::count_if(out, &Outbound::text), 8);
  EXPECT_EQ(std::ranges::count_if(out, std::not_fn(&Outbound::text)), 1);
}

TEST_F(FoxgloveTest, AMapWithYDownIsShownAsItsFileIs) {
  small_fleet();
  after(0);
  subscribe(1, "/map");
  const auto grid = only<fox::Grid>(after(0.5));
  EXPECT_DOUBLE_EQ(grid.pose().position().x(), 0);
  EXPECT_DOUBLE_EQ(grid.pose().position().y(), -3);
  EXPECT_EQ(grid.column_count(), 4u);
  ASSERT_EQ(grid.data().size(), 48u);
  // Grid rows begin at the bottom: the last row of the file is the first. Cells (0, 0) and (1, 2) are
  // blocked.
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const bool wall = (row == 2 && column == 0) || (row == 0 && column == 1);
      EXPECT_EQ(grid.data()[row * grid.row_stride() + column * grid.cell_stride() + 3] != 0, wall)
          << row << ' ' << column;
    }
  }
  EXPECT_TRUE(after(0.5).empty()) << "a map is sent once";
  subscribe(2, "/poses");
  const auto pose = only<fox::PosesInFrame>(after(0)).poses(0);
  EXPECT_DOUBLE_EQ(pose.position().x(), 1);
  EXPECT_DOUBLE_EQ(pose.position().y(), -1.5) << "one second at 1 m/s from 0.5, downwards";
  EXPECT_NEAR(2 * std::atan2(pose.orientation().z(), pose.orientation().w()), 0, 1e-9)
      << "the robot stands by now";
}

TEST_F(FoxgloveTest, HeadingsAreMirroredWithTheMap) {
  for (const YAxis y_axis : {YAxis::down, YAxis::up}) {
    test::SeenFleet one;
    one.map(y_axis);
    one.mission("a");
    one.state("a", {1, 1}, {0, 1});
    const auto pose = foxglove_scene::poses(one.view, one.now + 0.5).poses(0);
    const double sign = y_axis == YAxis::down ? -1 : 1;
    EXPECT_DOUBLE_EQ(pose.position().y(), sign * 1.5);
    EXPECT_NEAR(2 * std::atan2(pose.orientation().z(), pose.orientation().w()), sign * std::numbers::pi / 2,
                1e-9);
    const auto grid = foxglove_scene::grid(*one.view.map(), one.now);
    EXPECT_DOUBLE_EQ(grid.pose().position().y(), y_axis == YAxis::down ? -3 : 0);
    EXPECT_EQ(grid.data()[3] != 0, y_axis == YAxis::up) << "cell (0, 0) is blocked";
  }
}

TEST_F(FoxgloveTest, ALargeMapIsShownInLargerCellsThatKeepEveryWall) {
  constexpr int side = 3000;
  MapMessage map{"large", {.width = side, .height = side, .resolution = 0.5}};
  map.map.blocked.resize(side * side);
  map.map.blocked[std::size_t{side} * (side - 1) + 7] = 1;
  const auto grid = foxglove_scene::grid(map, 1);
  EXPECT_EQ(grid.column_count(), 1500u);
  EXPECT_DOUBLE_EQ(grid.cell_size().x(), 1);
  EXPECT_EQ(grid.data().size(), 1500u * 1500 * 4);
  EXPECT_NE(grid.data()[3 * 4 + 3], 0);
  EXPECT_DOUBLE_EQ(grid.pose().position().y(), -1500);
}

TEST_F(FoxgloveTest, ARobotIsACylinderWithAnArrowAndALifetime) {
  small_fleet();
  after(0);
  subscribe(1, "/robots");
  const auto scene = only<fox::SceneUpdate>(after(0.5));
  ASSERT_EQ(scene.entities_size(), 1);
  const auto& robot = scene.entities(0);
  EXPECT_EQ(robot.id(), "a");
  EXPECT_EQ(robot.frame_id(), "map");
  EXPECT_GT(robot.lifetime().seconds(), 0);
  ASSERT_EQ(robot.cylinders_size(), 1);
  EXPECT_DOUBLE_EQ(robot.cylinders(0).size().x(), 0.5);
  EXPECT_DOUBLE_EQ(robot.cylinders(0).pose().position().y(), -1);
  EXPECT_EQ(robot.arrows_size(), 1);
  EXPECT_EQ(robot.texts(0).text(), "a");
  fleet.state("a", {1, 1});
  EXPECT_EQ(only<fox::SceneUpdate>(after(0.5)).entities(0).arrows_size(), 0) << "the robot stands";
}

TEST_F(FoxgloveTest, ScenesGrowAndAreClearedWithMissionsAndRuns) {
  small_fleet();
  after(0);
  subscribe(1, "/paths");
  subscribe(2, "/trees");
  subscribe(3, "/root_trees");
  auto out = after(0.5);
  ASSERT_EQ(out.size(), 3u);
  for (const Outbound& one : out) {
    const auto scene = from_bytes<fox::SceneUpdate>(data_of(one).payload);
    ASSERT_EQ(scene.deletions_size(), 1);
    EXPECT_EQ(scene.deletions(0).type(), fox::SceneEntityDeletion::ALL);
    EXPECT_EQ(scene.entities_size(), 1);
    EXPECT_EQ(scene.entities(0).lifetime().seconds(), 0);
  }
  EXPECT_TRUE(after(0.5).empty());
  fleet.root_nodes("a", 4, 2);
  auto scene = only<fox::SceneUpdate>(after(0.5));
  EXPECT_EQ(scene.entities(0).id(), "a/1");
  EXPECT_EQ(scene.entities(0).lines(0).points_size(), 4);
  fleet.mission("a", 2);
  out = after(0.5);
  ASSERT_EQ(out.size(), 2u);
  scene = from_bytes<fox::SceneUpdate>(data_of(out[0]).payload);
  ASSERT_EQ(scene.deletions_size(), 1) << "its path";
  EXPECT_EQ(scene.deletions(0).id(), "a");
  scene = from_bytes<fox::SceneUpdate>(data_of(out[1]).payload);
  ASSERT_EQ(scene.deletions_size(), 2) << "both parts of its trees";
  EXPECT_EQ(scene.deletions(1).id(), "a/1");
  fleet.mission("b", 1, 200);
  out = after(0.5);
  ASSERT_EQ(out.size(), 3u) << "another run";
  scene = from_bytes<fox::SceneUpdate>(data_of(out[1]).payload);
  EXPECT_EQ(scene.deletions(0).type(), fox::SceneEntityDeletion::ALL);
  EXPECT_EQ(scene.entities_size(), 1) << "the map's trees stay";
}

TEST_F(FoxgloveTest, EachPhaseIsLoggedOnce) {
  small_fleet();
  after(0);
  subscribe(1, "/log");
  EXPECT_EQ(only<fox::Log>(after(0.5)).message(), "drives");
  fleet.status("a", Phase::driving, 3);
  EXPECT_TRUE(after(0.5).empty());
  fleet.hear(AgentStatus{.robot = "a", .mission = 1, .phase = Phase::no_path, .reason = "walled in"});
  const auto line = only<fox::Log>(after(0.5));
  EXPECT_EQ(line.message(), "has no path: walled in");
  EXPECT_EQ(line.level(), fox::Log::WARNING);
  EXPECT_EQ(line.name(), "a");
  fleet.hear(AgentStatus{.robot = "a", .mission = 1, .phase = Phase::stopped, .arrival_time = 7});
  EXPECT_EQ(only<fox::Log>(after(0.5)).message(), "has stopped at its goal");
}

TEST_F(FoxgloveTest, TheLayoutNamesExistingChannelsAndFields) {
  const std::string layout =
      test::contents(std::filesystem::path(COPPICE_SOURCE_DIR) / "deploy/foxglove-layout.json");
  const std::regex topic(R"re("(/[a-z_]+)(\.([a-z0-9_]+))?")re");
  std::size_t seen = 0;
  for (std::sregex_iterator it(layout.begin(), layout.end(), topic); it != std::sregex_iterator();
       ++it, ++seen) {
    EXPECT_GT(channel(it->str(1)), 0u);
    if (!(*it)[3].matched) continue;
    EXPECT_NE(live::Figures::Point::descriptor()->FindFieldByName(it->str(3)), nullptr) << it->str(3);
  }
  EXPECT_GT(seen, 10u);
}

TEST_F(FoxgloveTest, TheTimeSeriesGoesOnFromItsLastPoint) {
  small_fleet();
  for (int k = 0; k < 10; ++k) after(0.5);
  subscribe(1, "/fleet");
  EXPECT_EQ(only<live::Figures::Point>(after(0.1)).robots(), 1u);
  EXPECT_TRUE(after(0.1).empty());
  const auto point = only<live::Figures::Point>(after(0.4));
  EXPECT_DOUBLE_EQ(point.time(), fleet.now - 100);
}

/// Viewers store the points of lines as floats.
TEST_F(FoxgloveTest, LinesAreRelativeToTheOriginOfTheMap) {
  const Point2 origin(500000, 5400000);
  fleet.map(YAxis::up, origin);
  fleet.mission("a");
  fleet.path("a", {origin + Point2(1.234, 2.345), origin + Point2(3, 0.5)});
  fox::SceneUpdate scene;
  foxglove_scene::add_path(scene, fleet.view.robots()[0], foxglove_scene::projection_of(fleet.view),
                           fleet.now);
  const fox::LinePrimitive& line = scene.entities(0).lines(0);
  EXPECT_DOUBLE_EQ(line.pose().position().x(), 500000);
  EXPECT_DOUBLE_EQ(line.pose().position().y(), 5400000);
  EXPECT_NEAR(line.points(0).x(), 1.234, 1e-6);
  EXPECT_NEAR(line.points(0).y(), 2.345, 1e-6);
}

}  // namespace
}  // namespace coppice
