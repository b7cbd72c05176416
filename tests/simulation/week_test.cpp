// Tests of what a fleet saves while it stands and works for days: messages as its processes would keep them,
// fed into their journals as fast as that goes.
//
// CTest: PARALLEL
// CTest: TIMEOUT 900

#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "messages/validation.h"
#include "motion/body/driver.h"
#include "planner_service/run/planner_service.h"
#include "planner_service/run/saved_run.h"
#include "robot_agent/control/saved_state.h"
#include "runtime/journal.h"
#include "runtime/order_history.h"
#include "tests/support.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

constexpr double day = 24 * 3600;  // seconds
constexpr double hour = 3600;

/// A week is tested where long tests are wanted, else an hour, with the same limits.
double time_of_test(double usual) {
  return test::wants_long_tests() ? 7 * day : usual;
}

std::size_t size_of(const std::filesystem::path& folder) {
  std::size_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    bytes += entry.is_regular_file() ? entry.file_size() : 0;
  return bytes;
}

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// An agent whose robot drives for 20 s in each minute, and stands. Another robot falls silent now and then.
class WorkingAgent {
 public:
  explicit WorkingAgent(const std::filesystem::path& file) : journal_(file, 64 << 10) {
    Mission mission{.robot = "r1", .number = 1, .map_id = "hall", .radius = 0.5, .max_speed = 2};
    mission.max_acceleration = 2;
    mission.goal_tolerance = 0.25;
    mission.clock = {1000, 1};
    EXPECT_EQ(problem_with(Message(mission)), std::nullopt);
    keeper_.heard(mission);
  }

  void work(double until) {
    for (; time_ < until; time_ += 0.05, ++tick_) {
      const double of_minute = std::fmod(time_, 60);
      const bool drives = of_minute < 20;
      if (!drives && tick_ % 4 != 0) continue;  // a heartbeat
      RobotState state{.robot = "r1", .sequence = tick_, .radius = 0.5, .max_speed = 2};
      state.max_acceleration = 2;
      const Point2 velocity(drives && of_minute > 0.1 && of_minute < 19.9 ? std::cos(time_ / 10) : 0, 0);
      state.promise = {.stamp = time_,
                       .position = {10 * std::sin(time_ / 10), 3},
                       .velocity = velocity,
                       .decision_time = time_ + 0.05,
                       .next_velocity = velocity,
                       .expiry = time_ + 0.1};
      state.run = {1000};
      state.echoes = std::vector<Echo>(6, Echo{"r2", time_, time_});
      state.knows = std::vector<ReservationId>(6, ReservationId{"r2", 7});
      EXPECT_EQ(problem_with(Message(state)), std::nullopt);
      last_ = state;
      keeper_.said(state);
      if (tick_ % 12000 == 0) {
        RobotState of_peer = state;
        of_peer.robot = "r2";
        of_peer.passed_on = true;
        keeper_.said(of_peer);
      }
      keeper_.sync();
      keeper_.tidy();
    }
  }
  const RobotState& last() const { return last_; }

 private:
  Journal journal_;
  Keeper<StateKeeper, Journal> keeper_{StateKeeper("r1"), &journal_};
  double time_ = 0;
  std::uint32_t tick_ = 0;
  RobotState last_;
};

TEST(Week, AnAgentsJournalDoesNotGrowAndIsReadAtOnce) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "robot-r1.journal";
  RobotState last;
  {
    WorkingAgent agent(file);
    agent.work(time_of_test(2 * hour));
    last = agent.last();
  }
  EXPECT_LT(size_of(folder.path()), 200'000u);
  StateKeeper successor("r1");
  const double restart = seconds_of([&] {
    Journal(file, 64 << 10).for_each([&](const Message& message) { successor.restore({&message, 1}); });
  });
  EXPECT_LT(restart, 0.5);
  const auto saved = successor.saved_state();
  ASSERT_TRUE(saved.has_value());
  EXPECT_EQ(saved->sequence, last.sequence);
  EXPECT_EQ(saved->body.promise().position, last.promise.position);
  ASSERT_EQ(saved->silent.size(), 1u);
  EXPECT_EQ(saved->track.size(), track_points_kept);
}

/// A service whose robots arrive a step after they hear of a mission. They send their tracks twice a second.
class WorkingService {
 public:
  explicit WorkingService(const std::filesystem::path& folder)
      : folder_(folder),
        journal_(folder / "planner_service.journal", 512 << 10),
        history_(folder / "orders.jsonl"),
        service_(site(), {.waits_for_goals = true}, 0) {
    for (const Message& message : map_and_missions(service_)) take(message);
  }
  static Scenario site() {
    Scenario scenario = two_robots();
    for (RobotTask& robot : scenario.robots) robot.goal = robot.start;
    return scenario;
  }

  /// Gives an order every `pause` seconds.
  void work(double until, double pause) {
    for (; now_ < until; now_ += 0.5) {
      if (now_ >= next_order_) {
        next_order_ = now_ + pause;
        const Point2 place = given_ % 2 == 0 ? Point2(40, 60) : Point2(40, 20);
        hear(OrderMessage{.id = "order-" + std::to_string(given_++), .visits = {{place}}, .by = "mes"});
      }
      for (auto& [robot, mission] : missions_) tell_of(mission);
      for (const Message& message : service_.step(now_)) take(message);
      keeper_.sync();
      if (!journal_.wants_rewriting()) continue;
      const PlannerService::Snapshot all = service_.snapshot();
      journal_.rewrite(all.messages, all.figures.SerializeAsString());
    }
  }
  std::size_t given() const { return given_; }

 private:
  void take(const Message& message) {
    keeper_.said(message);
    history_.said(message);
    if (const auto* mission = std::get_if<Mission>(&message)) missions_[mission->robot] = *mission;
  }
  void hear(const Message& message) {
    keeper_.heard(message);
    service_.on(arrival_of(message, now_));
  }
  void tell_of(const Mission& mission) {
    TrackMessage batch{mission.robot, mission.number, points_[mission.robot], {}, mission.clock.run()};
    for (int k = 0; k < 10; ++k) batch.points.push_back({now_ + 0.05 * k, mission.goal, {0, 0}});
    points_[mission.robot] += 10;
    hear(batch);
    AgentStatus status{.robot = mission.robot, .mission = mission.number, .phase = Phase::arrived};
    status.arrival_time = now_;
    status.run = mission.clock.run();
    status.track_points = points_[mission.robot];
    hear(status);
  }

  std::filesystem::path folder_;
  Journal journal_;
  OrderHistory history_;
  Keeper<RunKeeper, Journal> keeper_{RunKeeper(), &journal_};
  PlannerService service_;
  std::map<RobotName, Mission> missions_;
  std::map<RobotName, std::uint32_t> points_;
  double now_ = 1;
  double next_order_ = 1;
  std::size_t given_ = 0;
};

TEST(Week, TheStateOfAServiceIsAKilobyteAnOrderAndItGoesOnWithinTwoSeconds) {
  const test::TemporaryFolder folder;
  std::size_t orders = 0;
  {
    WorkingService service(folder.path());
    service.work(time_of_test(3 * hour), 4);
    orders = service.given();
  }
  ASSERT_GT(orders, 1000u);
  EXPECT_LT(size_of(folder.path()), 8'000'000 + 1000 * orders);
  PlannerService again(WorkingService::site(), {.waits_for_goals = true}, 0);
  std::map<std::string, OrderState> states;
  const double restart = seconds_of([&] {
    const Journal journal(folder.path() / "planner_service.journal", 512 << 10);
    RunKeeper keeper;
    journal.for_each(
        [&](const Message& message) {
          EXPECT_TRUE(again.recall({&message, 1}, 0));
          keeper.recall({&message, 1});
          if (const auto* order = std::get_if<OrderStatus>(&message)) states[order->order.id] = order->state;
        },
        [&](const std::string& note) {
          proto::SavedRun figures;
          EXPECT_TRUE(figures.ParseFromString(note) && again.recall(figures));
        });
  });
  EXPECT_LT(restart, 2);
  EXPECT_EQ(states.size(), orders) << "none is forgotten";
  std::size_t done = 0;
  for (const auto& [id, state] : states) done += state == OrderState::done;
  EXPECT_GE(done + 3, orders);
}

}  // namespace
}  // namespace coppice
