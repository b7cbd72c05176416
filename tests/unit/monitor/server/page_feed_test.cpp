// Tests of what pages are sent: first all that is known, then each change once.

#include "monitor/server/page_feed.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "monitor/view/live_stream.h"
#include "tests/unit/monitor/seen_fleet.h"

namespace coppice {
namespace {

using live::Edges;
using live::ToPage;

class Page {
 public:
  explicit Page(test::SeenFleet& fleet, LiveStream& live) : fleet_(fleet), live_(live) {}

  /// What the page receives `seconds` later.
  std::vector<ToPage> after(double seconds) {
    fleet_.now += seconds;
    live_.look(fleet_.view, fleet_.now);
    return now();
  }
  std::vector<ToPage> now() {
    std::vector<ToPage> all;
    for (const Payload& bytes : feed_.next(fleet_.view, live_))
      EXPECT_TRUE(all.emplace_back().ParseFromString(*bytes));
    return all;
  }

 private:
  test::SeenFleet& fleet_;
  LiveStream& live_;
  PageFeed feed_;
};

std::vector<ToPage::WhatCase> kinds(const std::vector<ToPage>& messages) {
  std::vector<ToPage::WhatCase> all;
  for (const ToPage& message : messages) all.push_back(message.what_case());
  return all;
}

int count(const std::vector<ToPage>& messages, ToPage::WhatCase kind) {
  return static_cast<int>(std::ranges::count(kinds(messages), kind));
}

int edges(const std::vector<ToPage>& messages, Edges::Kind kind) {
  int sum = 0;
  for (const ToPage& message : messages) {
    if (message.has_edges() && message.edges().kind() == kind) sum += message.edges().points_size() / 4;
  }
  return sum;
}

struct PageFeedTest : testing::Test {
  test::SeenFleet fleet;
  LiveStream live{"here"};
  Page page{fleet, live};
};

TEST_F(PageFeedTest, APageThatConnectsLateGetsAllThatIsKnown) {
  fleet.map();
  fleet.mission("a");
  fleet.state("a", {1, 1}, {1, 0});
  fleet.status("a", Phase::driving, 2.5);
  fleet.path("a", {{0.5, 1.5}, {3.5, 1.5}});
  fleet.tree(1);
  fleet.root_nodes("a", 0, 4);
  const auto told = page.after(0.5);
  using enum ToPage::WhatCase;
  EXPECT_EQ(kinds(told), (std::vector{kBegin, kMap, kRoster, kPath, kStatuses, kEdges, kEdges, kFigures,
                                      kAlarms, kBeat, kFrame}));
  EXPECT_EQ(told[0].begin().source(), "here");
  EXPECT_EQ(told[1].map().occupancy(), std::string("\x01\x02", 2));
  EXPECT_FALSE(told[1].map().y_up());
  EXPECT_EQ(told[2].roster().robots(0).name(), "a");
  EXPECT_EQ(told[2].roster().robots(0).mission(), 1u);
  EXPECT_EQ(told[3].path().points_size(), 4);
  EXPECT_DOUBLE_EQ(told[4].statuses().statuses(0).driven_length(), 2.5);
  EXPECT_DOUBLE_EQ(told[4].statuses().statuses(0).path_length(), 3);
  EXPECT_EQ(edges(told, Edges::INACTIVE), 2);
  EXPECT_EQ(edges(told, Edges::ROOT_START), 3);
  const live::Frame& frame = told[10].frame();
  EXPECT_DOUBLE_EQ(frame.time(), 0.5);
  EXPECT_FLOAT_EQ(frame.x(0), 1.5);
  EXPECT_FLOAT_EQ(frame.decision_time(0), 0.5);
  EXPECT_FLOAT_EQ(frame.age(0), 0.5);
  EXPECT_EQ(frame.phase()[0], static_cast<char>(live::DRIVING));
}

TEST_F(PageFeedTest, NothingIsSentTwice) {
  fleet.map();
  fleet.mission("a");
  fleet.state("a", {1, 1});
  fleet.status("a", Phase::driving);
  fleet.tree(1);
  fleet.root_nodes("a", 0, 4);
  page.after(0.5);
  EXPECT_TRUE(page.now().empty());
  const auto later = page.after(0.4);
  EXPECT_EQ(kinds(later), (std::vector{ToPage::kBeat, ToPage::kFrame}));
  fleet.status("a", Phase::arrived);
  fleet.tree(2);
  fleet.root_nodes("a", 4, 2);
  const auto news = page.after(0.4);
  EXPECT_EQ(count(news, ToPage::kStatuses), 1);
  EXPECT_EQ(edges(news, Edges::INACTIVE), 2);
  EXPECT_EQ(edges(news, Edges::ROOT_START), 2);
  EXPECT_EQ(count(news, ToPage::kRoster) + count(news, ToPage::kMap) + count(news, ToPage::kBegin), 0);
}

TEST_F(PageFeedTest, FramesAreSentAt20HzAndStatusesAt4Hz) {
  fleet.map();
  fleet.mission("a");
  page.after(0);
  int frames = 0;
  int statuses = 0;
  int figures = 0;
  for (int turn = 0; turn < 1000; ++turn) {  // 10 s
    fleet.state("a", {1 + 0.001 * turn, 1});
    fleet.status("a", Phase::driving, 0.001 * turn);
    const auto told = page.after(0.01);
    frames += count(told, ToPage::kFrame);
    statuses += count(told, ToPage::kStatuses);
    figures += count(told, ToPage::kFigures);
  }
  EXPECT_NEAR(frames, 200, 2);
  EXPECT_NEAR(statuses, 40, 1);
  EXPECT_NEAR(figures, 20, 1);
}

TEST_F(PageFeedTest, AFrameIsEncodedOnceForAllPages) {
  fleet.mission("a");
  fleet.state("a", {1, 1});
  live.look(fleet.view, fleet.now);
  PageFeed one;
  PageFeed other;
  EXPECT_EQ(one.next(fleet.view, live).back().get(), other.next(fleet.view, live).back().get());
}

TEST_F(PageFeedTest, ASlowPageSkipsFramesAndLosesNoTree) {
  fleet.map();
  fleet.mission("a");
  fleet.state("a", {1, 1});
  page.after(0.1);
  for (int k = 0; k < 50; ++k) {
    fleet.tree(static_cast<std::uint32_t>(k));
    fleet.now += 0.1;
    live.look(fleet.view, fleet.now);
  }
  const auto told = page.now();
  EXPECT_EQ(count(told, ToPage::kFrame), 1);
  EXPECT_EQ(edges(told, Edges::INACTIVE), 100);
}

TEST_F(PageFeedTest, LargeForestsAreSentInPartsThatEndWithAFrame) {
  constexpr int trees = 40;
  constexpr int nodes = 5001;
  fleet.map();
  fleet.mission("a");
  fleet.state("a", {1, 1});
  for (int k = 0; k < trees; ++k) fleet.tree(static_cast<std::uint32_t>(k), nodes);
  int all = 0;
  int parts = 0;
  for (auto told = page.after(0.1); count(told, ToPage::kEdges) > 0; told = page.after(0.06), ++parts) {
    std::size_t size = 0;
    for (const ToPage& message : told) size += message.ByteSizeLong();
    EXPECT_LT(size, most_bytes_at_once + (1 << 19));
    EXPECT_EQ(told.back().what_case(), ToPage::kFrame);
    all += edges(told, Edges::INACTIVE);
  }
  EXPECT_EQ(all, trees * (nodes - 1));
  EXPECT_GE(parts, 3);
}

TEST_F(PageFeedTest, AnotherMissionReplacesTheRootTrees) {
  fleet.map();
  fleet.mission("a", 1);
  fleet.root_nodes("a", 0, 4, 1);
  page.after(0.5);
  fleet.mission("a", 2);
  fleet.root_nodes("a", 0, 3, 2);
  int kinds_anew = 0;
  for (const ToPage& message : page.after(0.5)) {
    if (!message.has_edges()) continue;
    EXPECT_TRUE(message.edges().anew());
    ++kinds_anew;
    EXPECT_EQ(message.edges().points_size(), message.edges().kind() == Edges::ROOT_START ? 8 : 0);
  }
  EXPECT_EQ(kinds_anew, 2);
}

TEST_F(PageFeedTest, AnotherRunClearsThePage) {
  fleet.map();
  fleet.mission("a");
  fleet.mission("b");
  page.after(0.5);
  fleet.mission("c", 1, 100.5);
  const auto told = page.after(0.5);
  ASSERT_GE(told.size(), 3u);
  EXPECT_EQ(told[0].what_case(), ToPage::kBegin);
  EXPECT_EQ(told[1].what_case(), ToPage::kMap);
  ASSERT_EQ(told[2].what_case(), ToPage::kRoster);
  ASSERT_EQ(told[2].roster().robots_size(), 1);
  EXPECT_EQ(told[2].roster().robots(0).name(), "c");
}

TEST_F(PageFeedTest, ARobotIsInTheRosterBeforeItIsInAFrame) {
  fleet.map();
  fleet.mission("a");
  page.after(0.5);
  int robots = 1;
  for (int k = 0; k < 30; ++k) {
    if (k % 3 == 0) fleet.state("b" + std::to_string(k), {1, 1});
    for (const ToPage& message : page.after(0.01)) {
      if (message.has_roster()) robots = message.roster().robots_size();
      EXPECT_EQ(message.has_frame() ? message.frame().x_size() : robots, robots);
    }
  }
  EXPECT_EQ(robots, 11);
}

/// A page that connects between two frames gets the current roster. An earlier frame knows fewer robots.
TEST_F(PageFeedTest, APageThatConnectsGetsAFrameThatFitsItsRoster) {
  fleet.map();
  fleet.mission("a");
  page.after(0.5);
  fleet.mission("b");
  page.after(0.01);
  Page another{fleet, live};
  std::size_t frames = 0;
  for (const ToPage& message : another.now()) {
    if (message.has_roster()) {
      EXPECT_EQ(message.roster().robots_size(), 2);
    }
    if (!message.has_frame()) continue;
    EXPECT_EQ(message.frame().x_size(), 2);
    ++frames;
  }
  EXPECT_EQ(frames, 1u);
}

TEST_F(PageFeedTest, ActiveTreesAreReplacedAndVanishWithTheirBroker) {
  fleet.map();
  fleet.hear(BrokerStatus{.broker = 7});
  fleet.hear(ActiveTreesMessage{7, "m", {{{0, 0}, {1, 1}}, {{1, 1}, {2, 1}}}});
  EXPECT_EQ(edges(page.after(0.5), Edges::ACTIVE), 2);
  EXPECT_EQ(edges(page.after(0.5), Edges::ACTIVE), 0);
  fleet.hear(ActiveTreesMessage{7, "m", {{{0, 0}, {1, 1}}}});
  const auto anew = page.after(0.5);
  EXPECT_EQ(edges(anew, Edges::ACTIVE), 1);
  EXPECT_EQ(std::ranges::count_if(anew, [](const ToPage& m) { return m.has_edges() && m.edges().anew(); }),
            1);
  fleet.now += 60;
  fleet.hear(BrokerStatus{.broker = 8});
  const auto gone = page.after(0.5);
  EXPECT_EQ(std::ranges::count_if(gone, [](const ToPage& m) { return m.has_edges() && m.edges().anew(); }),
            1);
  EXPECT_EQ(edges(gone, Edges::ACTIVE), 0);
}

TEST_F(PageFeedTest, MessagesOfAPausedRecordingAreInAFrame) {
  fleet.map();
  fleet.mission("a");
  const auto frames_until = [&](double from, double until) {
    int frames = 0;
    for (double present = from; present < until; present += 0.01) {
      live.look(fleet.view, 105, present);
      frames += count(page.now(), ToPage::kFrame);
    }
    return frames;
  };
  EXPECT_EQ(frames_until(1000, 1001), 1);
  fleet.state("a", {1, 1});
  EXPECT_EQ(frames_until(1001, 1002), 1);
  EXPECT_EQ(frames_until(1002, 1003), 0);
}

/// A page that hears no beat knows that the monitor hangs, also if a recording stands or no fleet is there.
TEST_F(PageFeedTest, ABeatIsSentFourTimesASecondThoughNothingChanges) {
  int beats = 0;
  double last = 0;
  for (double present = 1000; present < 1002; present += 0.01) {
    live.look(fleet.view, 105, present);
    for (const ToPage& message : page.now()) {
      if (!message.has_beat()) continue;
      ++beats;
      EXPECT_GT(message.beat().at(), last);
      last = message.beat().at();
    }
  }
  EXPECT_NEAR(beats, 8, 1);
  EXPECT_NEAR(last, 1002, 0.3);
}

TEST_F(PageFeedTest, AlarmsAreSentWhenTheyChange) {
  fleet.mission("a");
  fleet.mission("b");
  fleet.state("b", {2, 1});
  AlarmBoard board;
  const auto alarms_after = [&](double seconds) {
    fleet.now += seconds;
    board.look(fleet.view, fleet.now);
    live.look(fleet.view, fleet.now, fleet.now, board);
    std::vector<live::Alarms> all;
    for (const ToPage& message : page.now())
      if (message.has_alarms()) all.push_back(message.alarms());
    return all;
  };
  const auto first = alarms_after(0.3);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].alarms_size(), 0);
  const auto then = alarms_after(4);
  ASSERT_EQ(then.size(), 1u);
  ASSERT_EQ(then[0].alarms_size(), 1);
  EXPECT_EQ(then[0].alarms(0).kind(), "robot_silent");
  EXPECT_EQ(then[0].alarms(0).robot(), 1);
  EXPECT_NEAR(then[0].alarms(0).since(), 100, 1);
  EXPECT_TRUE(alarms_after(1).empty());
}

TEST_F(PageFeedTest, ARobotThatWasNotHeardHasNoPosition) {
  fleet.map();
  fleet.mission("a");
  fleet.mission("b");
  fleet.state("b", {2, 1});
  const auto told = page.after(0.1);
  ASSERT_EQ(told.back().what_case(), ToPage::kFrame);
  const live::Frame& frame = told.back().frame();
  EXPECT_TRUE(std::isnan(frame.x(0)));
  EXPECT_FLOAT_EQ(frame.x(1), 2);
  for (const int size :
       {frame.y_size(), frame.vx_size(), frame.vy_size(), frame.waits_for_size(), frame.decision_time_size(),
        frame.next_vx_size(), frame.next_vy_size(), frame.expiry_size(), frame.age_size(),
        frame.silence_size(), static_cast<int>(frame.phase().size()), static_cast<int>(frame.stage().size())})
    EXPECT_EQ(size, 2);
}

TEST_F(PageFeedTest, TheTimeSeriesIsKeptForHalfAnHour) {
  fleet.map();
  fleet.mission("a");
  for (int k = 0; k < 3700; ++k) {
    fleet.now += 0.5;
    live.look(fleet.view, fleet.now);
  }
  const auto told = page.after(0.5);
  int points = 0;
  for (const ToPage& message : told) points += message.figures().points_size();
  EXPECT_EQ(points, 3600);
  const auto later = page.after(0.5);
  points = 0;
  for (const ToPage& message : later) points += message.figures().points_size();
  EXPECT_EQ(points, 1);
}

TEST_F(PageFeedTest, ARecordingThatIsRewoundClearsThePage) {
  fleet.map();
  fleet.mission("a");
  page.after(0.5);
  live::Playback playback;
  playback.set_at(3);
  fleet.view = {};
  live.begin_anew();
  live.show(playback);
  fleet.now = 90;
  const auto told = page.after(0);
  using enum ToPage::WhatCase;
  EXPECT_EQ(kinds(told), (std::vector{kBegin, kPlayback, kAlarms, kBeat}));
  live.show(playback);
  EXPECT_TRUE(page.now().empty());
}

/// As in surveyors' grids (UTM), where floats have steps of 0.5 m.
TEST_F(PageFeedTest, PositionsAreExactToAMillimetreForAnyOrigin) {
  const Point2 origin(500000.125, 5400000.5);
  const auto exact = [&](double x, double y) { return Point2(origin + Point2(x, y)); };
  fleet.map(YAxis::up, origin);
  fleet.mission("a");
  fleet.state("a", exact(1.234, 2.345));
  fleet.path("a", {exact(1.234, 2.345), exact(3.456, 0.567)});
  fleet.hear(InactiveTreesMessage{
      .id = {7, 1}, .map_id = "m", .nodes = {{exact(0.111, 1.222), -1, 1}, {exact(2.333, 1.444), 0, 1}}});
  fleet.hear(
      RootNodes{.robot = "a",
                .mission = 1,
                .nodes = {{Root::start, exact(0.5, 0.75), -1}, {Root::start, exact(0.501, 0.751), 0}}});
  fleet.hear(BrokerStatus{.broker = 7});
  fleet.hear(ActiveTreesMessage{7, "m", {{exact(3.001, 2.002), exact(3.003, 2.004)}}});
  std::vector<std::vector<float>> lists;
  for (const ToPage& message : page.after(0)) {
    if (message.has_frame()) lists.push_back({message.frame().x(0), message.frame().y(0)});
    if (message.has_path())
      lists.emplace_back(message.path().points().begin(), message.path().points().end());
    if (message.has_edges() && message.edges().points_size() > 0)
      lists.emplace_back(message.edges().points().begin(), message.edges().points().end());
  }
  const std::vector<std::vector<double>> expected{{1.234, 2.345, 3.456, 0.567},
                                                  {0.111, 1.222, 2.333, 1.444},
                                                  {3.001, 2.002, 3.003, 2.004},
                                                  {0.5, 0.75, 0.501, 0.751},
                                                  {1.234, 2.345}};
  ASSERT_EQ(lists.size(), expected.size());
  for (std::size_t k = 0; k < lists.size(); ++k) {
    ASSERT_EQ(lists[k].size(), expected[k].size());
    for (std::size_t i = 0; i < lists[k].size(); ++i) EXPECT_NEAR(lists[k][i], expected[k][i], 0.0005);
  }
}

TEST_F(PageFeedTest, AMapThatComesLateBringsItsOriginAndResendsAll) {
  fleet.mission("a");
  fleet.state("a", {500001, 5400002});
  page.after(0.5);
  fleet.map(YAxis::up, {500000, 5400000});
  const auto told = page.after(0.5);
  using enum ToPage::WhatCase;
  ASSERT_GE(told.size(), 3u);
  EXPECT_EQ(told[0].what_case(), kBegin);
  EXPECT_EQ(told[1].what_case(), kMap);
  ASSERT_EQ(told.back().what_case(), kFrame);
  EXPECT_FLOAT_EQ(told.back().frame().x(0), 1);
}

const live::Life& life_in(const std::vector<ToPage>& told) {
  return told.back().frame().life();
}

TEST_F(PageFeedTest, AFleetIsAliveWhileItIsHeard) {
  fleet.map();
  fleet.mission("a");
  EXPECT_EQ(life_in(page.after(0.1)).state(), live::Life::NOBODY) << "a mission is no robot";
  fleet.state("a", {1, 1});
  fleet.status("a", Phase::driving);
  EXPECT_EQ(life_in(page.after(0.1)).state(), live::Life::ALIVE);
  const WallTime last = fleet.now - 0.1;
  const auto silent = page.after(30);
  EXPECT_EQ(life_in(silent).state(), live::Life::SILENT);
  EXPECT_DOUBLE_EQ(life_in(silent).heard(), last);
}

TEST_F(PageFeedTest, ARunThatEndsTellsWhichRobotsArrivedAndKeepsThem) {
  fleet.map();
  fleet.mission("a");
  fleet.mission("b");
  fleet.state("a", {3.5, 1.5});
  fleet.state("b", {1, 1});
  fleet.hear(AgentStatus{.robot = "a", .mission = 1, .phase = Phase::arrived, .arrival_time = 3});
  fleet.status("b", Phase::driving);
  EXPECT_EQ(life_in(page.after(0.1)).state(), live::Life::ALIVE);
  fleet.end_of_run("a");
  EXPECT_EQ(life_in(page.after(0.1)).state(), live::Life::ALIVE) << "b is not stopped";
  fleet.end_of_run("b");
  fleet.hear(AgentStatus{.robot = "a", .mission = 1, .phase = Phase::stopped, .arrival_time = 3});
  fleet.status("b", Phase::stopped);
  const auto told = page.after(60);
  EXPECT_EQ(life_in(told).state(), live::Life::ENDED) << "also when no robot is heard any more";
  EXPECT_EQ(life_in(told).robots(), 2u);
  EXPECT_EQ(life_in(told).arrived(), 1u);
  EXPECT_EQ(told.back().frame().phase(), std::string({live::ARRIVED, live::STOPPED}));
  EXPECT_EQ(fleet.view.figures(fleet.now).arrived, 1u);
}

TEST_F(PageFeedTest, AReplayIsMarkedAsOne) {
  fleet.map();
  fleet.mission("a");
  fleet.state("a", {1, 1});
  EXPECT_FALSE(life_in(page.after(0.1)).replayed());
  live.show_replayed(true);
  EXPECT_TRUE(life_in(page.after(0.1)).replayed());
}

TEST_F(PageFeedTest, TheWayToGoIsTheRestOfThePath) {
  fleet.map();
  fleet.mission("a");
  fleet.state("a", {0.5, 0.5});
  fleet.status("a", Phase::driving, 12);  // after a detour: more than the length of its path
  EXPECT_TRUE(std::isnan(page.after(0.1).back().frame().to_go(0))) << "without a path";
  fleet.path("a", {{0.5, 0.5}, {3.5, 0.5}, {3.5, 2.5}});
  EXPECT_FLOAT_EQ(page.after(0.1).back().frame().to_go(0), 5);
  fleet.state("a", {2.5, 1});  // it was pushed aside
  EXPECT_FLOAT_EQ(page.after(0.1).back().frame().to_go(0), 3.5F);
  fleet.path("a", {{2.5, 1}, {3.5, 1}});
  EXPECT_FLOAT_EQ(page.after(0.1).back().frame().to_go(0), 1);
}

TEST_F(PageFeedTest, ARobotWithoutProgressShowsItsWaitCauseAndDuration) {
  fleet.map();
  fleet.mission("a");
  fleet.now = 112;
  fleet.state("a", {1, 1});
  fleet.hear(AgentStatus{.robot = "a",
                         .mission = 1,
                         .phase = Phase::driving,
                         .wait_cause = "no odometry came",
                         .came_on_at = 5,
                         .waits = {.startup = 2, .gate = 7}});
  const auto told = page.after(0);
  const auto statuses = std::ranges::find(told, ToPage::kStatuses, &ToPage::what_case);
  ASSERT_NE(statuses, told.end());
  EXPECT_EQ(statuses->statuses().statuses(0).wait_cause(), "no odometry came");
  EXPECT_DOUBLE_EQ(statuses->statuses().statuses(0).waited(), 9);
  EXPECT_FLOAT_EQ(told.back().frame().waiting(0), 7);
}

}  // namespace
}  // namespace coppice
