// Tests of the sentences on made-up recordings: one for each thing that a robot does, and for each cause.

#include "monitor/recording/explanation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "monitor/recording/recorder.h"
#include "tests/support.h"
#include "tests/unit/monitor/recording/epoch.h"

namespace coppice {
namespace {

using test::epoch;

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << "\nin: " << text;
}
/// Each line has its part.
void expect_lines(const std::vector<std::string>& lines, const std::vector<std::string>& parts) {
  ASSERT_EQ(lines.size(), parts.size()) << fmt::format("{}", fmt::join(lines, "\n"));
  for (std::size_t k = 0; k < lines.size(); ++k) expect_in(lines[k], parts[k]);
}

/// Says what the robots of a made-up fleet say, and records it. Times are fleet times.
class Explanation : public testing::Test {
 protected:
  void say(Message message, double t) { said_.push_back(arrival_of(std::move(message), began_ + t)); }
  void mission(const char* robot, const Point2& goal, std::uint32_t number = 1, double t = 0) {
    say(Mission{.robot = robot,
                .number = number,
                .map_id = "m",
                .goal = goal,
                .radius = 0.5,
                .max_speed = 1,
                .max_acceleration = 2,
                .goal_tolerance = 0.2,
                .clock = {began_, 1}},
        t);
  }
  RobotState state(const char* robot, double t, const Point2& at,
                   const Point2& velocity = Point2::Zero()) const {
    return {.robot = robot,
            .sequence = static_cast<std::uint32_t>(20 * t),
            .promise = {.stamp = t,
                        .position = at,
                        .velocity = velocity,
                        .decision_time = t + control_period,
                        .next_velocity = velocity,
                        .expiry = t + 2 * control_period},
            .radius = 0.5,
            .max_speed = 1,
            .max_acceleration = 2,
            .phase = Phase::driving,
            .round = {},
            .run = {began_}};
  }
  using Change = std::function<void(RobotState&)>;
  /// The robot stands.
  void stands(const char* robot, double from, double until, const Point2& at, const Change& change = {}) {
    for (double t = from; t < until - 0.01; t += 0.1) {
      RobotState s = state(robot, t, at);
      if (change) change(s);
      say(s, t);
    }
  }
  /// The robot drives along x with 1 m/s.
  void drives(const char* robot, double from, double until, const Point2& at, const Change& change = {}) {
    for (double t = from; t < until - 0.01; t += 0.1) {
      RobotState s = state(robot, t, at + Point2(t - from, 0), {1, 0});
      if (change) change(s);
      say(s, t);
    }
  }
  /// Statuses twice a second, in which a wait of that kind grows.
  void waits(const char* robot, double from, double until, double WaitTimes::*kind,
             const std::string& words) {
    WaitTimes times;
    for (double t = from; t < until + 0.01; t += 0.5) {
      AgentStatus status{.robot = robot, .mission = 1, .phase = Phase::driving, .run = {began_}};
      times.*kind = t - from;
      status.waits = times;
      status.wait_cause = words;
      say(status, t);
    }
  }
  void reserve(const char* robot, std::uint32_t number, const Trajectory& trajectory, double t,
               double way = 0) {
    say(ReservationMessage{.robot = robot,
                           .number = number,
                           .first_number = number,
                           .radius = 0.5,
                           .way = way,
                           .trajectory = trajectory,
                           .run = {began_}},
        t);
  }

  std::string write() {
    std::ranges::stable_sort(said_, {}, &Arrival::at);
    Recorder recorder;
    recorder.on(said_);
    const std::string bytes = recorder.step(epoch + 1000) + recorder.finish();
    return folder_.write("r.mcap", bytes).string();
  }
  std::vector<std::string> all_of(const char* robot) {
    const Recording recording(write());
    return explain_run(stories_of(recording), robot);
  }
  /// All sentences but that of the mission.
  std::vector<std::string> story_of(const char* robot) {
    std::vector<std::string> lines = all_of(robot);
    if (!lines.empty()) lines.erase(lines.begin());
    return lines;
  }
  std::string moment_of(const char* robot, double t) {
    const Recording recording(write());
    return fmt::format("{}", fmt::join(explain_moment(recording, stories_of(recording), robot, t), "\n"));
  }
  std::string problem_with(const std::function<void()>& what) {
    try {
      what();
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "no problem";
  }

  /// r5 crosses the way of r2 first, which waits from 3 s to 6 s.
  void cross(const Point2& goal = {9, 0}) {
    mission("r2", goal);
    mission("r5", {5, 9});
    const Change reserved = [](RobotState& s) {
      s.reservation = 1;
      s.reservation_progress = s.promise.position.x();
    };
    reserve("r2", 1, {{0, {0, 0}}, {3, {3, 0}}, {6, {3, 0}}, {12, {9, 0}}}, 0.01);
    reserve("r5", 1, {{0, {5, -4}}, {8, {5, 4}}}, 0.01);
    drives("r2", 0.1, 3.1, {0, 0}, reserved);
    stands("r2", 3.1, 6, {3, 0}, [&](RobotState& s) {
      reserved(s);
      s.waits_for = "r5";
    });
    drives("r2", 6, 12, {3, 0}, reserved);
    for (double t = 0.1; t < 8; t += 0.1) {
      RobotState s = state("r5", t, {5, -4 + t}, {0, 1});
      s.reservation = 1;
      s.reservation_progress = t;
      say(s, t);
    }
  }

  test::TemporaryFolder folder_;
  WallTime began_ = epoch;
  std::vector<Arrival> said_;
};

TEST_F(Explanation, ARobotWaitsAtItsGateForTheOneThatGoesFirst) {
  cross();
  const std::vector<std::string> lines = all_of("r2");
  ASSERT_EQ(lines.size(), 4u) << fmt::format("{}", fmt::join(lines, "\n"));
  EXPECT_EQ(lines[0], "0.10 s at (0.0, 0.0): r2 got mission 1, to (9.0, 0.0).");
  EXPECT_EQ(lines[1], "0.10 s to 3.10 s from (0.0, 0.0) to (3.0, 0.0): r2 drove 3.0 m.");
  expect_in(lines[2], "3.10 s to 6.00 s at (3.0, 0.0): r2 stood and waited for r5 to pass at the gate ");
  expect_in(lines[2], "r5 went first by their reservations, and had ");
  expect_in(lines[3], "6.00 s to 11.90 s from (3.0, 0.0) to (8.9, 0.0): r2 drove 5.9 m.");
}

TEST_F(Explanation, WithoutReservationsTheGateIsNotDescribed) {
  mission("r2", {9, 0});
  stands("r2", 1, 3, {3, 0}, [](RobotState& s) { s.waits_for = "r5"; });
  expect_lines(story_of("r2"),
               {"1.00 s to 2.90 s at (3.0, 0.0): r2 stood and waited for r5, which went first."});
}

TEST_F(Explanation, ARobotStandsBecauseAnotherOneIsInTheWay) {
  mission("r2", {9, 0});
  mission("r5", {9, 0});
  mission("r7", {9, 0});
  reserve("r2", 1, {{0, {0, 0}}, {9, {9, 0}}}, 0.5);
  stands("r2", 1, 6, {3, 0});
  stands("r5", 1, 3, {4.2, 0});
  stands("r5", 3, 6, {9, 9});
  stands("r7", 1, 3, {9, 5});
  stands("r7", 3, 6, {4.1, 0});
  waits("r2", 0, 6, &WaitTimes::promise, "r5 is in the way");
  expect_lines(story_of("r2"), {"s at (3.0, 0.0): r2 stood: r5 and then r7 were in the way."});
}

TEST_F(Explanation, ARobotStandsThoughNobodyIsNear) {
  mission("r2", {9, 0});
  reserve("r2", 1, {{0, {0, 0}}, {9, {9, 0}}}, 0.5);
  stands("r2", 1, 3, {3, 0});
  waits("r2", 0, 4, &WaitTimes::promise, "other robots may come where it wants to go");
  expect_lines(story_of("r2"), {"r2 stood: others might have come where it wanted to go."});
}

TEST_F(Explanation, ARobotWaitsForItsTurnToReserve) {
  mission("r2", {9, 0});
  reserve("r2", 1, {}, 0.5, 9);
  stands("r2", 1, 3, {3, 0});
  waits("r2", 0, 4, &WaitTimes::reservation, "");
  expect_lines(story_of("r2"), {"r2 stood and waited for its turn to reserve a trajectory."});
}

TEST_F(Explanation, ARobotHasGivenUpItsReservation) {
  mission("r2", {9, 0});
  reserve("r2", 1, {{0, {0, 0}}, {9, {9, 0}}}, 0.4);
  reserve("r2", 2, {}, 0.5);
  stands("r2", 1, 3, {3, 0});
  waits("r2", 0, 4, &WaitTimes::reservation, "others may not have heard yet that it gave up its reservation");
  expect_lines(story_of("r2"),
               {"r2 stood: it had given up its reservation, and needed another one. Its agent "
                "said: \"others may not have heard yet that it gave up its reservation\"."});
}

TEST_F(Explanation, ARobotHasAReservationThatIsUseless) {
  mission("r2", {9, 0});
  reserve("r2", 1, {{0, {0, 0}}, {9, {9, 0}}}, 0.4);
  stands("r2", 1, 3, {3, 0});
  waits("r2", 0, 4, &WaitTimes::reservation, "");
  expect_lines(story_of("r2"), {"r2 stood: its reservation led where it might not go any more."});
}

TEST_F(Explanation, ARobotStandsUntilThereIsAJointPlan) {
  mission("r2", {9, 0});
  const auto in_round_of = [](const char* leader) {
    return [leader](RobotState& s) {
      s.stage = Stage::waiting;
      s.round = {.epoch = 3, .leader = leader};
    };
  };
  stands("r2", 1, 3, {3, 0}, in_round_of("r5"));
  stands("r2", 3, 5, {3, 0}, in_round_of("r2"));
  expect_lines(story_of("r2"), {"1.00 s to 3.00 s at (3.0, 0.0): r2 stood until r5 had made a joint "
                                "plan.",
                                "r2 stood and made a joint plan for the robots around it."});
}

TEST_F(Explanation, ARobotIsStrandedByAJointPlan) {
  mission("r2", {9, 0});
  const RoundId round{.epoch = 3, .leader = "r5"};
  say(JointPlanMessage{.round = round, .members = {{"r2", 0.5, true}}, .run = {began_}}, 0.5);
  stands("r2", 1, 3, {3, 0}, [&](RobotState& s) { s.round = round; });
  waits("r2", 0, 4, &WaitTimes::joint_plan, "");
  expect_lines(story_of("r2"), {"r2 stood: the joint plan of r5 did not bring it to its goal."});
}

TEST_F(Explanation, ARobotDrivesAsAJointPlanSays) {
  mission("r2", {9, 0});
  ReservationMessage part{.robot = "r2", .number = 1, .first_number = 1, .radius = 0.5, .run = {began_}};
  part.trajectory = {{0, {0, 0}}, {9, {9, 0}}};
  part.plan = {"r5", 3, 0};
  say(part, 0.5);
  drives("r2", 1, 3, {0, 0}, [](RobotState& s) { s.stage = Stage::executing; });
  expect_lines(story_of("r2"), {"r2 drove 1.9 m, as the joint plan of r5 said."});
}

TEST_F(Explanation, ARobotDoesNotKnowAllOthersYet) {
  mission("r2", {9, 0});
  stands("r2", 1, 3, {3, 0});
  waits("r2", 0, 4, &WaitTimes::startup, "it has not heard where r9 is");
  expect_lines(story_of("r2"), {"r2 stood: it did not know yet where all others were. Its agent "
                                "said: \"it has not heard where r9 is\"."});
}

TEST_F(Explanation, ARobotIsCutOff) {
  mission("r2", {9, 0});
  stands("r2", 1, 3, {3, 0});
  waits("r2", 0, 4, &WaitTimes::connection, "cut off: it hears nothing of r9");
  expect_lines(story_of("r2"), {"r2 stood: it was cut off, or had been"});
}

TEST_F(Explanation, ARobotJoinsInMidRun) {
  mission("r2", {9, 0});
  stands("r2", 1, 3, {3, 0}, [](RobotState& s) { s.is_new = true; });
  waits("r2", 0, 4, &WaitTimes::connection, "");
  expect_lines(story_of("r2"), {"r2 stood: its agent had been started or had woken in mid-run"});
}

TEST_F(Explanation, ARobotWaitsForItsBody) {
  mission("r2", {9, 0});
  stands("r2", 1, 3, {3, 0});
  waits("r2", 0, 4, &WaitTimes::odometry, "no odometry came");
  expect_lines(story_of("r2"), {"Its agent said: \"no odometry came\"."});
}

TEST_F(Explanation, AnOperatorHaltsARobot) {
  mission("r2", {9, 0});
  drives("r2", 0.1, 1, {2, 0});
  const OrderMessage order{.id = "halt-7", .action = Action::stop, .robots = {"r2"}, .by = "Ann"};
  say(OrderStatus{.order = order, .state = OrderState::done, .accepted_at = began_ + 1}, 1);
  stands("r2", 1, 3, {3, 0}, [](RobotState& s) { s.phase = Phase::halted; });
  say(
      AgentStatus{
          .robot = "r2", .phase = Phase::halted, .reason = "stopped by the operator", .run = {began_}},
      1.01);
  const std::vector<std::string> lines = story_of("r2");
  ASSERT_FALSE(lines.empty());
  expect_in(lines.back(), "r2 was halted (order halt-7 of Ann): stopped by the operator.");
}

TEST_F(Explanation, ARobotGivesUp) {
  mission("r2", {9, 0});
  stands("r2", 1, 3, {3, 0}, [](RobotState& s) { s.phase = Phase::gave_up; });
  say(AgentStatus{.robot = "r2", .phase = Phase::gave_up, .reason = "a way was not found", .run = {began_}},
      1.01);
  expect_lines(story_of("r2"), {"r2 gave up and stood: a way was not found."});
}

TEST_F(Explanation, ARobotHasNoPath) {
  mission("r2", {9, 0});
  stands("r2", 1, 2, {3, 0}, [](RobotState& s) { s.phase = Phase::planning; });
  stands("r2", 2, 3, {3, 0}, [](RobotState& s) { s.phase = Phase::no_path; });
  say(AgentStatus{.robot = "r2", .phase = Phase::no_path, .reason = "no path: walls", .run = {began_}}, 2.01);
  expect_lines(story_of("r2"),
               {"r2 looked for a path to (9.0, 0.0).", "r2 stood without a path: no path: walls."});
}

TEST_F(Explanation, ARobotArrivesAndItsRunEnds) {
  mission("r2", {9, 0});
  stands("r2", 1, 2, {9, 0}, [](RobotState& s) { s.phase = Phase::arrived; });
  drives("r2", 2, 3, {9, 0}, [](RobotState& s) { s.phase = Phase::arrived; });
  stands("r2", 3, 4, {10, 0}, [](RobotState& s) { s.phase = Phase::stopped; });
  expect_lines(story_of("r2"),
               {"r2 stood at its goal.", "r2 had no way of its own, and moved 1.0 m out of the others' way.",
                "r2 stood: its run had ended."});
}

TEST_F(Explanation, AKilledRobotIsNotHeard) {
  mission("r2", {9, 0});
  mission("r5", {9, 9});
  drives("r2", 0, 2, {0, 0});
  stands("r5", 0, 12, {9, 9});
  for (double t = 4; t < 6; t += 0.5) {
    RobotState relayed = state("r2", 1.9, {1.9, 0}, {1, 0});
    relayed.passed_on = relayed.counts_as_failed = true;
    say(relayed, t);
  }
  const std::vector<std::string> lines = story_of("r2");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[1],
            "1.90 s to 11.90 s at (1.9, 0.0): r2 was not heard: its agent had ended, hung, or could not be "
            "reached. "
            "Others counted it as failed from 4.00 s on.");
}

TEST_F(Explanation, ARobotTurnsOnTheSpot) {
  mission("r2", {9, 0});
  stands("r2", 1, 3, {3, 0}, [](RobotState& s) {
    s.max_angular_speed = s.max_angular_acceleration = 1;
    s.promise.angular_velocity = 0.5;
  });
  expect_lines(story_of("r2"), {"r2 turned on the spot."});
}

TEST_F(Explanation, ABriefHaltIsPartOfTheDrive) {
  mission("r2", {9, 0});
  reserve("r2", 1, {{0, {0, 0}}, {9, {9, 0}}}, 0.5);
  drives("r2", 1, 2, {0, 0});
  stands("r2", 2, 2.2, {1, 0});
  drives("r2", 2.2, 3, {1, 0});
  expect_lines(story_of("r2"), {"1.00 s to 2.90 s from (0.0, 0.0) to (1.7, 0.0): r2 drove 1.7 m."});
}

TEST_F(Explanation, EachMissionIsNamedWithItsOrder) {
  mission("r2", {9, 0});
  drives("r2", 1, 2, {0, 0});
  mission("r2", {0, 9}, 2, 2);
  OrderMessage order{.id = "fetch", .visits = {{.position = {0, 9}}}, .by = "Bob"};
  say(
      OrderStatus{
          .order = order, .state = OrderState::under_way, .robot = "r2", .mission = 2, .accepted_at = began_},
      2.05);
  drives("r2", 2, 3, {1, 0});
  const std::vector<std::string> lines = all_of("r2");
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[2], "2.10 s at (1.1, 0.0): r2 got mission 2, to (0.0, 9.0) (order fetch of Bob).");
}

TEST_F(Explanation, TimesOfALaterRunGoOn) {
  mission("r2", {9, 0});
  drives("r2", 1, 2, {0, 0});
  began_ += 100;
  mission("r2", {0, 9}, 2, 0);
  drives("r2", 1, 2, {1, 0});
  expect_in(story_of("r2").back(), "101.00 s to 101.90 s");
}

TEST_F(Explanation, ARobotThatSaidNothingHasNoStory) {
  mission("r2", {9, 0});
  expect_lines(all_of("r2"), {"r2 said nothing of where it was: it never set out."});
}

TEST_F(Explanation, AMomentTellsPlaceTaskDecisionAndReservation) {
  cross();
  const std::string text = moment_of("r2", 4);
  expect_in(text, "r2 at 4.00 s\n");
  expect_in(text, "Place: (3.0, 0.0). It stood.");
  expect_in(text, "Task: mission 1, to (9.0, 0.0). Phase: driving.");
  expect_in(text, "Decision: 3.10 s to 6.00 s at (3.0, 0.0): r2 stood and waited for r5");
  expect_in(text, "\n  0.10 s to 8.00 s from (5.0, -3.9) to (5.0, 4.0): r5 drove 7.9 m.");
  expect_in(text,
            "Reservation: number 1, from (0.0, 0.0) at 0.00 s to (9.0, 0.0) at 12.00 s. It had come "
            "3.0 m along it");
  expect_in(text, "Contact: it was connected.");
  expect_in(text, "Failed: nobody.");
  expect_in(moment_of("r2", 2), "It drove with 1.00 m/s (at most 1.00)");
  expect_in(moment_of("r2", 0.05), "it had not said yet where it was");
}

TEST_F(Explanation, AMomentFollowsTheChainOfWaitsToItsEnd) {
  mission("a", {9, 0});
  stands("a", 1, 3, {1, 0}, [](RobotState& s) { s.waits_for = "b"; });
  stands("b", 1, 3, {3, 0}, [](RobotState& s) { s.waits_for = "c"; });
  stands("c", 1, 3, {5, 0}, [](RobotState& s) { s.phase = Phase::arrived; });
  const std::string text = moment_of("a", 2);
  expect_in(text,

            "\n  1.00 s to 2.90 s at (3.0, 0.0): b stood and waited for c, which went first.\n  1.00 s to "
            "2.90 s at (5.0, 0.0): c stood at its goal.\n");
}

TEST_F(Explanation, AMomentTellsOfRobotsThatWaitForEachOther) {
  mission("a", {9, 0});
  stands("a", 1, 3, {1, 0}, [](RobotState& s) { s.waits_for = "b"; });
  stands("b", 1, 3, {3, 0}, [](RobotState& s) { s.waits_for = "a"; });
  expect_in(moment_of("a", 2), "  a again: these robots waited for each other.");
}

TEST_F(Explanation, AMomentTellsWhatTheRobotHeardAndLacked) {
  mission("a", {9, 0});
  reserve("b", 4, {{0, {9, 9}}, {1, {9, 8}}}, 0.5);
  stands("b", 1, 3, {3, 0});
  stands("a", 1, 3, {1, 0}, [](RobotState& s) {
    s.waits_for = "b";
    s.misses = {"c"};
    s.echoes = {{"b", s.promise.stamp - 0.2, s.promise.stamp - 0.15}};
    s.knows = {{"b", 4}};
  });
  const std::string text = moment_of("a", 2);
  expect_in(text, "Contact: it heard nothing of c.");
  expect_in(text, "Heard: it confirmed states of 1 robots");
  expect_in(text, "It heeded reservation 4 of b, the newest one.");
}

TEST_F(Explanation, AMomentNamesTheFailedRobotThatClosesTheWay) {
  cross();
  mission("r8", {9, 9});
  mission("r9", {9, 9});
  stands("r8", 0, 1, {6, 0.2});
  stands("r9", 0, 1, {6, 5});
  const std::string text = moment_of("r2", 5);
  expect_in(text,
            "Failed: r8 was last heard at 0.90 s. It rests at about (6.0, 0.2). It closes the way of r2, "
            "2.0 m ahead.");
  expect_in(text,
            "Failed: r9 was last heard at 0.90 s. It rests at about (6.0, 5.0). It does not stand on "
            "the way of r2.");
  expect_in(moment_of("r8", 5), "Place: not known. It was last heard at (6.0, 0.2), 4.1 s before.");
}

TEST_F(Explanation, AWrongNameGetsTheNearestOne) {
  for (const char* robot : {"lift", "r2"}) mission(robot, {9, 0});
  const Recording recording(write());
  const Stories stories = stories_of(recording);
  EXPECT_EQ(problem_with([&] { check_robot(stories, "lfit"); }),
            "there is no robot \"lfit\" (did you mean lift?): the recording holds lift, r2");
  EXPECT_EQ(problem_with([&] { check_robot(stories, "Mary"); }),
            "there is no robot \"Mary\": the recording holds lift, r2");
  EXPECT_EQ(problem_with([&] { check_robot(stories, "r2"); }), "no problem");
}

TEST_F(Explanation, ATimeThatTheRecordingDoesNotHoldIsRefused) {
  cross();
  const Recording recording(write());
  const Stories stories = stories_of(recording);
  EXPECT_EQ(problem_with([&] { check_time(stories, 99); }),
            "time 99: expected a fleet time of the recording, 0.00 to 11.90 s");
  expect_in(problem_with([&] { check_time(stories, std::nan("")); }), "expected a fleet time");
  EXPECT_EQ(problem_with([&] { check_time(stories, 5); }), "no problem");
}

TEST_F(Explanation, ARecordingWithoutAFleetIsRefused) {
  say(BrokerStatus{.broker = 7}, 1);
  const Recording recording(write());
  expect_in(problem_with([&] { stories_of(recording); }), "holds no mission");
}

}  // namespace
}  // namespace coppice
