// Each state says how far its robot will have come along its reservation at the decision time of its promise,
// whether the robot drives on, brakes or is late. Others count on it.
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/scenario_generator.h"
#include "motion/trajectory/polyline.h"
#include "motion/trajectory/space_time.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

/// Listens to a fleet, and compares what the robots say of their progress with where they are.
class ProgressCheck {
 public:
  void hear(const Message& message) {
    if (const auto* const reservation = std::get_if<ReservationMessage>(&message)) {
      if (!reservation->trajectory.empty())
        ways_.insert_or_assign({reservation->robot, reservation->number},
                               Polyline(path_of(reservation->trajectory)));
    } else if (const auto* const state = std::get_if<RobotState>(&message)) {
      compare(*state);
    }
  }
  int states() const { return states_; }
  /// Of those, how many braked.
  int braking() const { return braking_; }
  /// The worst of the states that told a wrong progress, in radii off the way.
  double worst() const { return worst_; }
  double worst_at() const { return worst_at_; }

 private:
  void compare(const RobotState& state) {
    const auto way = ways_.find({state.robot, state.reservation});
    if (state.passed_on || way == ways_.end()) return;
    ++states_;
    braking_ += state.promise.next_velocity.norm() < state.promise.velocity.norm();
    const Point2 said = way->second.at(state.reservation_progress);
    const double off = (said - state.promise.position_at_decision()).norm() / state.radius;
    if (off <= worst_) return;
    worst_ = off;
    worst_at_ = state.promise.stamp;
  }

  std::map<std::pair<RobotName, std::uint32_t>, Polyline> ways_{};
  int states_ = 0;
  int braking_ = 0;
  double worst_ = 0;
  double worst_at_ = 0;
};

struct TimedOrder {
  double time = 0;
  OrderMessage order{};
};

/// One robot is paused, then another one is stopped, then all are.
std::vector<TimedOrder> halts(const Scenario& scenario) {
  const std::vector<std::string> first{scenario.robots.front().name};
  const std::vector<std::string> last{scenario.robots.back().name};
  return {{6, {.id = "pause", .action = Action::pause, .robots = first}},
          {9, {.id = "stop", .action = Action::stop, .robots = last}},
          {12, {.id = "resume", .action = Action::resume, .robots = first}},
          {20, {.id = "release", .action = Action::release, .robots = last}},
          {30, {.id = "stop all", .action = Action::stop}},
          {36, {.id = "release all", .action = Action::release}}};
}

void expect_true_progress(const Scenario& scenario, const char* what) {
  const Faults faults{.bus = {.loss = 0.1, .delay = 0.05, .partitions = {{14, 16}, {25, 25.8}, {43, 47}}},
                      .pause_rate = 200,
                      .pause = 0.5};
  FleetSimulation simulation(scenario,
                             {.timeout = 300, .plan_budget = 0.1, .lifelong = 60, .faults = faults});
  ProgressCheck check;
  simulation.set_listener([&](const Message& message, double) { check.hear(message); });
  const std::vector<TimedOrder> orders = halts(scenario);
  auto next = orders.begin();
  simulation.run([&](const PlannerService&, double now) {
    for (; next != orders.end() && next->time <= now; ++next) simulation.give(next->order);
    return true;
  });
  EXPECT_GT(check.states(), 500) << what;
  EXPECT_GT(check.braking(), 50) << what;
  EXPECT_LE(check.worst(), reserved_stray_radii + 0.02) << what << " at " << check.worst_at();
  const auto broken = broken_invariants(scenario, simulation);
  EXPECT_TRUE(broken.empty()) << what << ": " << broken.front();
}

TEST(ReservationProgress, IsThatOfTheTurnForRobotsOfAnyBrakes) {
  for (const double braking : {0.5, 2.0, 5.0}) {
    for (std::uint32_t seed = 1; seed <= 2; ++seed) {
      Scenario scenario = make_scenario("rooms", 6, seed);
      for (RobotTask& robot : scenario.robots) robot.max_acceleration = robot.max_speed / braking;
      expect_true_progress(scenario, std::to_string(braking).c_str());
    }
  }
}

TEST(ReservationProgress, IsThatOfTheTurnForDifferentialRobots) {
  Scenario scenario = make_scenario("rooms", 6, 3);
  for (RobotTask& robot : scenario.robots) {
    robot.max_angular_speed = 2;
    robot.max_angular_acceleration = 8;
  }
  expect_true_progress(scenario, "differential");
}

// These drive two and a half radii in a control period.
TEST(ReservationProgress, IsThatOfTheTurnForRobotsThatAreFastForTheirSize) {
  for (const double braking : {0.5, 3.0}) {
    Scenario hall{.map_name = "hall", .map = test::open_map(1000, 60), .seed = 5, .robots = {}};
    test::block(hall.map, 400, 0, 420, 25);
    test::block(hall.map, 600, 20, 620, 60);
    const auto robot = [&](const char* name, const Point2& start, const Point2& goal) {
      hall.robots.push_back({name, start, goal, 2, 100, 100 / braking, 1});
    };
    robot("r1", {10, 10}, {990, 50});
    robot("r2", {990, 10}, {10, 50});
    robot("r3", {10, 30}, {990, 30});
    robot("r4", {500, 55}, {500, 5});
    expect_true_progress(hall, std::to_string(braking).c_str());
  }
}

}  // namespace
}  // namespace coppice
