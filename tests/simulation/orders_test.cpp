// A fleet that takes orders, simulated: service and agents are killed, messages are lost. Each order ends
// once, a robot has been where its order sent it, and nothing touches.
#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "coppice/planning/random.h"
#include "planning/geometry/reachability.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/support.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

struct Standing {
  explicit Standing(const Scenario& site, const SimulationSettings& settings)
      : scenario(site), simulation(scenario, settings) {
    simulation.set_listener([this](const Message& message, double now) {
      const auto* const status = std::get_if<OrderStatus>(&message);
      if (status == nullptr) return;
      OrderStatus& last = said[status->order.id];
      // What a restarted service tells again is what it has told before.
      if (is_ended(last.state)) {
        EXPECT_EQ(last.state, status->state) << status->order.id;
      }
      if (!is_ended(last.state) && is_ended(status->state)) ended_at[status->order.id] = now;
      last = *status;
    });
  }
  OrderState state(const std::string& id) const { return said.at(id).state; }

  Scenario scenario;
  FleetSimulation simulation;
  std::map<std::string, OrderStatus> said{};
  std::map<std::string, double> ended_at{};
};

Scenario site(const char* name) {
  return read_scenario(test::scenarios() / name, {.is_site = true});
}

/// All robots stand at home at first.
Scenario at_home(Scenario scenario) {
  for (RobotTask& robot : scenario.robots) {
    robot.goal = robot.start;
    robot.goal_yaw_tolerance = 0;
  }
  return scenario;
}

std::size_t index_of(const Scenario& scenario, const std::string& robot) {
  return static_cast<std::size_t>(std::ranges::find(scenario.robots, robot, &RobotTask::name) -
                                  scenario.robots.begin());
}

/// Whether the robot stood there at some time before `until`.
bool was_at(const NamedTrack& named, const Point2& place, double within, double until) {
  return std::ranges::any_of(named.track.points, [&](const TrackPoint& p) {
    return p.time <= until && p.velocity.norm() < 1e-6 && (p.position - place).norm() <= within;
  });
}

void expect_each_order_is_done(Standing& fleet, std::size_t orders) {
  EXPECT_EQ(fleet.said.size(), orders);
  for (const auto& [id, status] : fleet.said) {
    ASSERT_EQ(status.state, OrderState::done) << id << ": " << status.reason;
    const std::size_t robot = index_of(fleet.scenario, status.robot);
    const double until = fleet.ended_at.at(id);
    for (const Visit& visit : status.order.visits) {
      EXPECT_TRUE(was_at(fleet.simulation.tracks()[robot], visit.position,
                         fleet.scenario.robots[robot].goal_tolerance, until))
          << id;
    }
  }
  const auto broken = broken_invariants(fleet.scenario, fleet.simulation);
  EXPECT_TRUE(broken.empty()) << broken.front();
}

constexpr double patience = 1000;  // seconds until the last orders are done

/// Orders for named and for any robots, at random places, as fast as the fleet does them, for so many
/// seconds. Returns how many.
std::size_t keep_busy(Standing& fleet, double seconds, double restart_every) {
  const ClearanceField field(fleet.scenario.map, fleet.scenario.margin);
  const double radius = driving_radius(fleet.scenario.robots.front());
  const ReachablePart part = ReachablePart::around(field, radius, fleet.scenario.robots.front().start);
  Random random(7);
  std::size_t given = 0;
  double next_restart = restart_every;
  fleet.simulation.run([&](const PlannerService&, double now) {
    const auto open =
        std::ranges::count_if(fleet.said, [](const auto& entry) { return !is_ended(entry.second.state); });
    for (auto k = static_cast<std::size_t>(open); k < fleet.scenario.robots.size() && now < seconds; ++k) {
      OrderMessage order{.id = std::to_string(++given)};
      order.visits.push_back({.position = part.place(random.index(part.size())), .wait = random.uniform()});
      if (given % 2 == 0)
        order.robots = {fleet.scenario.robots[random.index(fleet.scenario.robots.size())].name};
      fleet.said[order.id].order = order;
      fleet.simulation.give(std::move(order));
    }
    if (now > next_restart) {
      fleet.simulation.restart_service();
      next_restart += restart_every;
      // The service that was killed has not answered these. The dispatcher's bus gives them to the next one.
      for (const auto& [id, status] : fleet.said) {
        if (status.accepted_at == 0) fleet.simulation.give(status.order);
      }
    }
    return (now < seconds || open > 0) && now < seconds + patience;
  });
  return given;
}

TEST(Orders, ABusyFleetDoesEachOrderOnceThroughKillsAndLoss) {
  SimulationSettings settings{.takes_orders = true};
  settings.faults = {
      .bus = {.loss = 0.1, .delay = 0.05, .jitter = 0.03}, .kill_rate = 20, .restart_after = 2};
  Standing fleet(at_home(site("rooms-20.json")), settings);
  const std::size_t given = keep_busy(fleet, 120, 7.3);
  EXPECT_GT(given, 100u);
  expect_each_order_is_done(fleet, given);
}

TEST(Orders, DifferentialRobotsDoThemToo) {
  Standing fleet(at_home(site("storehouse-10.json")), {.takes_orders = true});
  expect_each_order_is_done(fleet, keep_busy(fleet, 60, 31));
}

class AnHourOfOrders : public testing::TestWithParam<const char*> {};
TEST_P(AnHourOfOrders, EachIsDoneOnceThroughKillsAndLoss) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  SimulationSettings settings{.takes_orders = true};
  settings.faults = {.bus = {.loss = 0.1, .delay = 0.05, .jitter = 0.03}, .kill_rate = 6, .restart_after = 2};
  Standing fleet(at_home(site(GetParam())), settings);
  const std::size_t given = keep_busy(fleet, 3600, 47);
  RecordProperty("orders", static_cast<int>(given));
  expect_each_order_is_done(fleet, given);
}
INSTANTIATE_TEST_SUITE_P(Sites, AnHourOfOrders,
                         testing::Values("rooms-20.json", "warehouse.json", "maze-10.json", "dense-8.json",
                                         "office-20.json", "storehouse-mixed-20.json"));

/// The time at which all robots stand, after `from`.
double all_stand_at(const FleetSimulation& simulation, double from) {
  double last = from;
  for (const NamedTrack& named : simulation.tracks()) {
    for (const TrackPoint& p : named.track.points) {
      if (p.time > from && p.velocity.norm() > 1e-9) last = std::max(last, p.time);
    }
  }
  return last;
}

TEST(Orders, AfterStopAllEverybodyBrakesAtOnceAndStandsUntilReleased) {
  SimulationSettings settings{.takes_orders = true};
  settings.faults = {.bus = {.loss = 0.2}};
  Scenario scenario = at_home(site("rooms-20.json"));
  Standing fleet(scenario, settings);
  const Scenario goals = read_scenario(test::scenarios() / "rooms-20.json", {});
  double stopped_at = 0;
  int phase = 0;
  double released_at = 0;
  std::map<std::string, Point2> stood;
  fleet.simulation.run([&](const PlannerService& service, double now) {
    const double fleet_now = service.progress(now).elapsed;
    if (phase == 0 && now > 5) {
      for (const RobotTask& robot : goals.robots)
        fleet.simulation.give({.id = "to " + robot.name, .robots = {robot.name}, .visits = {{robot.goal}}});
      phase = 1;
    } else if (phase == 1 && now > 8) {
      fleet.simulation.give({.id = "stop", .action = Action::stop});
      stopped_at = fleet_now;
      phase = 2;
    } else if (phase == 2 && now > 20) {
      EXPECT_EQ(fleet.state("stop"), OrderState::done);
      fleet.simulation.restart_service();
      phase = 3;
    } else if (phase == 3 && now > 40) {
      fleet.simulation.give({.id = "release", .action = Action::release});
      released_at = fleet_now;
      phase = 4;
    }
    if (phase < 4) return true;
    const bool all_done = std::ranges::all_of(
        fleet.said, [](const auto& entry) { return entry.second.state == OrderState::done; });
    return !all_done && now < 1000;
  });
  for (const auto& [id, status] : fleet.said) EXPECT_EQ(status.state, OrderState::done) << id;
  double braking = 0;
  for (const RobotTask& robot : scenario.robots) braking = std::max(braking, braking_time(limits_of(robot)));
  // A lost message is sent again after 0.1 s; of twenty messages some are lost four times.
  const double network = 0.5;
  for (const NamedTrack& named : fleet.simulation.tracks()) {
    double last = 0;
    for (const TrackPoint& p : named.track.points) {
      if (p.time < released_at && p.velocity.norm() > 1e-9) last = std::max(last, p.time);
    }
    EXPECT_LT(last, stopped_at + 2 * control_period + braking + network) << named.robot;
  }
  EXPECT_GT(all_stand_at(fleet.simulation, released_at), released_at + 1);
  const auto broken = broken_invariants(scenario, fleet.simulation);
  EXPECT_TRUE(broken.empty()) << broken.front();
}

TEST(Orders, ARobotKeepsTheMarginFromOneThatIsPausedInItsWay) {
  Scenario aisle{.map_name = "aisle", .map = test::open_map(300, 12), .seed = 1, .robots = {}};
  aisle.margin = 0.5;
  aisle.robots = {{"behind", {20, 6}, {20, 6}, 5, 20, 40, 1}, {"ahead", {60, 6}, {60, 6}, 5, 20, 40, 1}};
  Standing fleet(aisle, {.takes_orders = true});
  const auto give = [&](OrderMessage order) { fleet.simulation.give(std::move(order)); };
  const auto place = [&](std::size_t robot) {
    return fleet.simulation.tracks()[robot].track.points.back().position;
  };
  int phase = 0;
  double apart = 0;
  fleet.simulation.run([&](const PlannerService&, double now) {
    if (phase == 0 && now > 3) {
      give({.id = "far", .robots = {"ahead"}, .visits = {{{280, 6}}}});
      give({.id = "near", .robots = {"behind"}, .visits = {{{240, 6}}}});
      phase = 1;
    } else if (phase == 1 && now > 7) {
      give({.id = "pause", .action = Action::pause, .robots = {"ahead"}});
      phase = 2;
    } else if (phase == 2 && now > 30) {
      apart = place(1).x() - place(0).x() - 10;
      give({.id = "resume", .action = Action::resume, .robots = {"ahead"}});
      phase = 3;
    }
    const bool all_ended =
        std::ranges::all_of(fleet.said, [](const auto& entry) { return is_ended(entry.second.state); });
    return now < 100 && !(phase == 3 && all_ended);
  });
  EXPECT_GT(apart, 0.49);
  EXPECT_LT(apart, 1) << "the robot behind has come as close as it may";
  EXPECT_EQ(fleet.state("far"), OrderState::done);
  EXPECT_EQ(fleet.state("near"), OrderState::done);
}

}  // namespace
}  // namespace coppice
