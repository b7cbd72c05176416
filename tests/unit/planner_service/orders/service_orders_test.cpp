// Tests of the planner service that carries out orders, message by message. The agents of these tests are at
// their goals as soon as they hear of them.
#include <algorithm>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "planner_service/run/saved_run.h"
#include "tests/unit/messages/kept.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

/// Robot a stands at {20, 60} on the left of the wall, and b at {20, 20}.
Scenario site() {
  Scenario scenario = two_robots();
  for (RobotTask& robot : scenario.robots) robot.goal = robot.start;
  return scenario;
}

const ServiceSettings serves{.waits_for_goals = true};

struct Serving {
  explicit Serving(const Scenario& scenario = site()) : service(scenario, serves, 0) { begin(); }
  /// A new run of a fleet that was ended.
  explicit Serving(const FleetMemory& memory, const Scenario& scenario = site())
      : service(scenario, {.waits_for_goals = true, .starts = memory.poses}, 0) {
    service.remember(memory);
    begin();
  }
  void begin() {
    for (const Message& message : map_and_missions(service)) save_and_obey(message);
  }
  /// Goes on after a service that left these messages.
  explicit Serving(const std::vector<Message>& saved) : service(site(), serves, now) {
    EXPECT_TRUE(service.recall(saved, now));
    kept.keeper = Keeper(
        [&] {
          RunKeeper keeper;
          keeper.recall(saved);
          return keeper;
        }(),
        &kept.store);
    kept.store.messages = saved;
  }

  void save_and_obey(const Message& message) {
    kept.keeper.said(message);
    if (const auto* status = std::get_if<OrderStatus>(&message)) orders[status->order.id] = *status;
    const auto* const mission = std::get_if<Mission>(&message);
    if (mission == nullptr) return;
    missions[mission->robot] = *mission;
    if (obeys) arrive(*mission);
  }
  void arrive(const Mission& mission) {
    now += 0.1;
    const std::uint32_t index = points[mission.robot]++;
    hear(TrackMessage{
        mission.robot, mission.number, index, {{now, mission.goal, {0, 0}}}, mission.clock.run()});
    AgentStatus status{.robot = mission.robot, .mission = mission.number, .phase = Phase::arrived};
    status.arrival_time = now;
    status.run = mission.clock.run();
    hear(status);
  }
  void hear(const Message& message) {
    kept.keeper.heard(message);
    service.on(arrival_of(message, now));
  }
  void give(const OrderMessage& order) { hear(order); }
  void step(int times = 1) {
    for (int k = 0; k < times; ++k) {
      now += 0.1;
      for (const Message& message : service.step(now)) save_and_obey(message);
    }
  }

  double now = 0;
  bool obeys = true;  ///< robots arrive at once; else they never do
  PlannerService service;
  Kept<RunKeeper> kept{};
  std::map<std::string, OrderStatus> orders;
  std::map<RobotName, Mission> missions;
  std::map<RobotName, std::uint32_t> points;
};

OrderMessage go(const char* id, std::vector<RobotName> robots, const Point2& place) {
  return {.id = id, .robots = std::move(robots), .visits = {{place}}};
}

TEST(ServiceOrders, AnOrderBecomesAMissionAndIsDone) {
  Serving run;
  run.give(go("1", {"a"}, {40, 60}));
  run.step(3);
  EXPECT_EQ(run.missions.at("a").goal, Point2(40, 60));
  EXPECT_EQ(run.orders.at("1").state, OrderState::done);
  EXPECT_EQ(run.orders.at("1").mission, 0u);
  EXPECT_GT(run.orders.at("1").begun_at, 0);
}

TEST(ServiceOrders, PlacesThatNobodyCanReachAreRefused) {
  Scenario closed = site();
  for (int j = 0; j < 80; ++j) {
    for (int i = 58; i < 62; ++i) closed.map.blocked[static_cast<std::size_t>(j * 120 + i)] = 1;
  }
  Serving run(closed);
  run.give(go("wall", {"a"}, {60, 40}));
  run.give(go("outside", {}, {-5, 3}));
  run.give(go("beyond", {"a"}, {100, 60}));
  run.give(go("one of two", {}, {40, 20}));
  run.step(3);
  for (const char* id : {"wall", "outside", "beyond"}) {
    EXPECT_EQ(run.orders.at(id).state, OrderState::failed) << id;
    EXPECT_NE(run.orders.at(id).reason.find("no way leads"), std::string::npos) << run.orders.at(id).reason;
  }
  EXPECT_EQ(run.orders.at("one of two").state, OrderState::done);
}

TEST(ServiceOrders, ARunThatEndsTakesNoOrders) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  service.on(arrival_of(go("1", {"a"}, {40, 60}), 1));
  const auto said = of<OrderStatus>(service.step(1));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].reason, "this run takes no orders: start the fleet with coppice serve");
  service.on(arrival_of(OrderMessage{.id = "2", .action = Action::stop}, 2));
  EXPECT_EQ(of<HaltMessage>(service.step(2)).at(0).everybody, Halt::stopped) << "everybody may be stopped";
}

TEST(ServiceOrders, TheFreeRobotsWithTheShortestWaysInAllGo) {
  Serving run;
  run.obeys = false;
  // b is nearer to both places. The sum is least if a, which is not far from the first one, goes there.
  run.give(go("1", {}, {40, 45}));
  run.give(go("2", {}, {40, 10}));
  run.step(2);
  EXPECT_EQ(run.orders.at("1").robot, "a");
  EXPECT_EQ(run.orders.at("2").robot, "b");
  run.give(go("3", {}, {30, 30}));
  run.step(2);
  EXPECT_EQ(run.orders.at("3").state, OrderState::accepted);
  EXPECT_EQ(run.orders.at("3").reason, "no robot is free");
}

TEST(ServiceOrders, ARobotWithoutWorkStepsAside) {
  Serving run;
  run.give(go("1", {"a"}, {20, 22}));  // where b stands
  run.step(3);
  EXPECT_EQ(run.orders.at("1").state, OrderState::done);
  EXPECT_GE((run.missions.at("b").goal - Point2(20, 22)).norm(), 10);
}

TEST(ServiceOrders, TwoRobotsChangePlaces) {
  Serving run;
  run.give(go("1", {"a"}, {20, 20}));
  run.give(go("2", {"b"}, {20, 60}));
  run.step(6);
  EXPECT_EQ(run.orders.at("1").state, OrderState::done) << run.orders.at("1").reason;
  EXPECT_EQ(run.orders.at("2").state, OrderState::done) << run.orders.at("2").reason;
}

TEST(ServiceOrders, AnOrderWaitsForABusyRobotToLeaveItsPlace) {
  Serving run;
  run.obeys = false;
  run.give(go("1", {"b"}, {40, 60}));
  run.step(2);
  run.give(go("2", {"a"}, {40, 62}));
  run.step(2);
  EXPECT_EQ(run.orders.at("2").state, OrderState::assigned);
  EXPECT_EQ(run.orders.at("2").reason, "it waits until b has left");
  run.obeys = true;
  run.arrive(run.missions.at("b"));
  run.step(3);
  EXPECT_EQ(run.orders.at("1").state, OrderState::done);
  EXPECT_EQ(run.orders.at("2").state, OrderState::done) << "b has stepped aside";
}

/// The statuses that a service saves for so many orders, whose places are two.
std::size_t statuses_saved(int orders, std::vector<RobotName> robots) {
  Serving run;
  for (int k = 0; k < orders; ++k)
    run.give(go(std::to_string(k).c_str(), robots, k % 2 == 0 ? Point2(40, 60) : Point2(100, 20)));
  for (int turn = 0; turn < 20 * orders; ++turn) {
    run.step();
    if (run.orders.size() == static_cast<std::size_t>(orders) &&
        std::ranges::all_of(run.orders, [](const auto& own) { return is_ended(own.second.state); }))
      break;
  }
  for (const auto& [id, status] : run.orders)
    EXPECT_EQ(status.state, OrderState::done) << id << status.reason;
  return of<OrderStatus>(run.kept.store.messages).size();
}

// A queue of 1,000 orders over two goals wrote 279,301 statuses.
TEST(ServiceOrders, AWaitingOrderIsSavedWhenItChanges) {
  EXPECT_LT(statuses_saved(200, {}), 200u * 8);
  EXPECT_LT(statuses_saved(200, {"a"}), 200u * 8);
}

TEST(ServiceOrders, AnOrderForAnyRobotTiesUpNoRobotWhileItsPlaceIsTaken) {
  Serving run;
  run.obeys = false;
  run.give(go("1", {"b"}, {40, 60}));
  run.give(go("2", {}, {40, 62}));
  run.step(2);
  EXPECT_EQ(run.orders.at("2").state, OrderState::accepted);
  EXPECT_EQ(run.orders.at("2").reason, "it waits until b has left");
  run.give(go("3", {}, {100, 20}));
  run.step(2);
  EXPECT_EQ(run.orders.at("3").robot, "a");
  run.obeys = true;
  for (const char* robot : {"a", "b"}) run.arrive(run.missions.at(robot));
  run.step(3);
  EXPECT_EQ(run.orders.at("2").state, OrderState::done);
  EXPECT_EQ(run.orders.at("2").robot, "b") << "it stands nearest";
}

TEST(ServiceOrders, ACancelledOrderStopsItsRobotWhereItCanBrake) {
  Serving run;
  run.obeys = false;
  run.give(go("1", {"a"}, {40, 60}));
  run.step(2);
  run.hear(TrackMessage{"a", 2, run.points["a"]++, {{run.now, {30, 60}, {10, 0}}}});
  run.give({.id = "2", .action = Action::cancel, .cancels = "1"});
  run.step(2);
  EXPECT_EQ(run.orders.at("1").state, OrderState::cancelled);
  EXPECT_NEAR(run.service.task("a").goal.x(), 30 + 10.0 * 10 / (2 * 40), 1e-9);
}

TEST(ServiceOrders, OrdersThatAreOpenWhenTheFleetEndsAreCancelled) {
  Serving run;
  run.obeys = false;
  run.give(go("1", {"a"}, {40, 60}));
  run.give(go("2", {"a"}, {20, 40}));
  run.step(2);
  run.service.interrupt();
  run.step();
  for (const char* id : {"1", "2"}) {
    EXPECT_EQ(run.orders.at(id).state, OrderState::cancelled);
    EXPECT_EQ(run.orders.at(id).reason, "the fleet has ended");
  }
}

/// As a wall with a door that only robot b passes.
Scenario with_a_large_robot() {
  Scenario scenario = site();
  for (int j = 0; j < 80; ++j) {
    for (int i = 58; i < 62; ++i)
      scenario.map.blocked[static_cast<std::size_t>(j * 120 + i)] = j < 10 || j > 23;
  }
  scenario.robots[0].radius = 9;
  return scenario;
}

TEST(ServiceOrders, AnOrderForAnyRobotGoesToOneThatReachesAllPlaces) {
  Serving run(with_a_large_robot());
  OrderMessage order = go("1", {}, {22, 58});  // a is near
  order.visits.push_back({{100, 40}});
  run.give(order);
  run.step(5);
  EXPECT_EQ(run.orders.at("1").robot, "b");
  EXPECT_EQ(run.orders.at("1").state, OrderState::done) << run.orders.at("1").reason;
}

TEST(ServiceOrders, AnOrderWhosePlacesNoRobotReachesAllIsRefusedAtOnce) {
  Scenario scenario = with_a_large_robot();
  scenario.robots[1].start = scenario.robots[1].goal = {100, 40};
  for (int j = 0; j < 80; ++j) {
    for (int i = 58; i < 62; ++i) scenario.map.blocked[static_cast<std::size_t>(j * 120 + i)] = 1;
  }
  Serving run(scenario);
  OrderMessage order = go("1", {}, {30, 40});
  order.visits.push_back({{90, 40}});
  run.give(order);
  run.step();
  EXPECT_EQ(run.orders.at("1").state, OrderState::failed);
  EXPECT_EQ(run.orders.at("1").reason,
            "no robot reaches all places: none that reaches those before reaches (90, 40)");
  EXPECT_EQ(run.missions.at("a").number, 1u);
}

TEST(ServiceOrders, AnOrderThatNoFreeRobotCanDoHoldsUpNoOther) {
  Serving run(with_a_large_robot());
  run.obeys = false;
  run.give(go("1", {"b"}, {100, 60}));
  run.step(2);
  run.give(go("2", {}, {100, 20}));  // for b alone
  run.give(go("3", {}, {30, 40}));
  run.step(2);
  EXPECT_EQ(run.orders.at("2").state, OrderState::accepted);
  EXPECT_EQ(run.orders.at("3").robot, "a");
}

TEST(ServiceOrders, AnOrderForAnyRobotThatARobotNeverTookUpGoesToAnother) {
  Serving run;
  run.step();
  run.obeys = false;
  run.give(go("1", {}, {30, 20}));
  run.step(2);
  ASSERT_EQ(run.orders.at("1").robot, "b");
  const Mission lost = run.missions.at("b");
  // b hangs, and a goes on.
  for (int k = 0; k < 80; ++k) {
    if (run.missions.at("a").number == 1)
      run.hear(AgentStatus{.robot = "a", .mission = 1, .phase = Phase::arrived, .run = lost.clock.run()});
    run.step();
  }
  ASSERT_EQ(run.orders.at("1").robot, "a");
  run.arrive(run.missions.at("a"));
  run.step();
  EXPECT_EQ(run.orders.at("1").robot, "a");
  EXPECT_EQ(run.orders.at("1").state, OrderState::done) << run.orders.at("1").reason;
  EXPECT_GT(run.missions.at("b").number, lost.number);
  EXPECT_EQ(run.missions.at("b").goal, Point2(20, 20)) << "should it be heard again, it stays";
}

TEST(ServiceOrders, AFleetThatStandsUpAgainHoldsItsHaltsAndDoesNoOrderAgain) {
  Serving before;
  before.give(go("done", {"a"}, {40, 60}));
  before.step(3);
  before.obeys = false;
  before.give(go("open", {"b"}, {40, 20}));
  before.give({.id = "stop", .action = Action::stop});
  before.step(2);
  before.service.interrupt();
  before.step(2);
  ASSERT_EQ(before.orders.at("open").reason, "the fleet has ended");

  Serving after(before.service.memory());
  EXPECT_EQ(after.missions.at("a").start, Point2(40, 60));
  EXPECT_EQ(after.missions.at("a").goal, Point2(40, 60)) << "it stays";
  after.give(go("done", {"a"}, {40, 60}));
  after.give(go("open", {"b"}, {40, 20}));
  after.give(go("new", {"b"}, {20, 40}));
  after.step(3);
  EXPECT_EQ(after.orders.at("done").state, OrderState::done);
  EXPECT_EQ(after.orders.at("open").state, OrderState::cancelled);
  EXPECT_EQ(after.orders.at("new").reason, "b is stopped by the operator");
  EXPECT_EQ(after.missions.at("a").number, 1u);
  EXPECT_EQ(after.missions.at("b").number, 1u);
  after.give({.id = "release", .action = Action::release});
  after.step(3);
  EXPECT_EQ(after.orders.at("new").state, OrderState::done);
}

// Its agent knows better where the robot is.
TEST(ServiceOrders, ARobotThatIsSeenElsewhereStaysThere) {
  EXPECT_TRUE(Serving().missions.at("a").starts_where_it_stands);
  PlannerService service(site(), serves, 0);
  const auto missions = of<Mission>(map_and_missions(service));
  service.on(arrival_of(TrackMessage{"a", 1, 0, {{0.05, {33, 44}, {0, 0}}}, missions[0].clock.run()}, 1));
  EXPECT_EQ(service.task("a").goal, Point2(33, 44));
  EXPECT_EQ(service.task("b").goal, Point2(20, 20));
  service.on(arrival_of(TrackMessage{"a", 1, 1, {{0.1, {34, 44}, {0, 0}}}, missions[0].clock.run()}, 1.1));
  EXPECT_EQ(service.task("a").goal, Point2(33, 44)) << "only where it was seen first";
  EXPECT_EQ(service.memory().poses.at(0).position, Point2(34, 44));
}

TEST(ServiceOrders, PosesThatAreGivenBind) {
  PlannerService service(
      site(), {.waits_for_goals = true, .starts = {{"a", {33, 44}, 0}}, .starts_are_given = true}, 0);
  const auto missions = of<Mission>(map_and_missions(service));
  EXPECT_EQ(missions[0].start, Point2(33, 44));
  EXPECT_FALSE(missions[0].starts_where_it_stands);
}

// As a scenario that has such a start.
TEST(ServiceOrders, ARobotWhosePoseIsALittleTooNearToAWallDrivesOutAndStaysThere) {
  const ServiceSettings settings{.waits_for_goals = true, .starts = {{"a", {4.5, 60}, 0}}};
  PlannerService service(site(), settings, 0);
  const auto said = map_and_missions(service);
  const Mission mission = of<Mission>(said).at(0);
  EXPECT_EQ(mission.start, Point2(4.5, 60));
  EXPECT_GE(mission.goal.x(), 5);
  EXPECT_LT(mission.goal.x(), 5.5);
  PlannerService after(site(), settings, 1);
  EXPECT_TRUE(after.recall(said, 1));
  for (PlannerService* const each : {&service, &after}) {
    TrackMessage track{"a", 1, 0, {{0.05, {4.5, 60}, {0, 0}}}, mission.clock.run()};
    for (int k = 1; k <= 6; ++k) track.points.push_back({0.05 + k, {4.5 + 0.1 * k, 60}, {0.1, 0}});
    each->on(arrival_of(track, 8));
    EXPECT_EQ(each->report().collisions(), 0u) << "it drove out";
    EXPECT_EQ(each->task("a").goal, mission.goal);
  }
}

TEST(ServiceOrders, APoseCountsBeforeAStartAtAWall) {
  Scenario scenario = site();
  scenario.robots[0].stands_at = Point2(4.5, 60);
  scenario.robots[0].start = scenario.robots[0].goal = {5.1, 60};
  PlannerService service(scenario, {.waits_for_goals = true, .starts = {{"a", {33, 44}, 0}}}, 0);
  const Mission mission = of<Mission>(map_and_missions(service)).at(0);
  EXPECT_EQ(mission.start, Point2(33, 44));
  EXPECT_EQ(mission.goal, Point2(33, 44));
}

TEST(ServiceOrders, AnOrderFromBeforeTheFleetIsNotCarriedOut) {
  Serving run;
  run.service.takes_orders_since(run.now);
  run.service.on(arrival_of(go("1", {"a"}, {40, 60}), run.now + 0.1, run.now - 50));
  run.step(20);
  EXPECT_FALSE(run.orders.contains("1")) << "its sender may repeat it";
  run.step(20);
  EXPECT_EQ(run.orders.at("1").state, OrderState::failed);
  EXPECT_NE(run.orders.at("1").reason.find("before this fleet began"), std::string::npos);
  EXPECT_EQ(run.missions.at("a").number, 1u);
}

TEST(ServiceOrders, WhatIsSaidAgainIsNotSavedAgain) {
  Serving run;
  run.give(go("1", {"a"}, {40, 60}));
  run.give(go("no", {"c"}, {40, 60}));
  run.step(3);
  const auto count = [&] { return of<OrderStatus>(run.kept.store.messages).size(); };
  const std::size_t saved = count();
  for (int k = 0; k < 10; ++k) {
    run.orders.clear();
    run.give(go("1", {"a"}, {40, 60}));
    run.give(go("no", {"c"}, {40, 60}));
    run.step();
    EXPECT_EQ(run.orders.size(), 2u) << "both are answered";
  }
  EXPECT_EQ(count(), saved);
}

/// Whatever the service had saved when it was killed: the next one does each order once.
TEST(ServiceOrders, AServiceThatIsKilledAtAnyInstantDoesEachOrderOnce) {
  Serving whole;
  whole.give(go("1", {"a"}, {40, 60}));
  whole.give(go("2", {}, {40, 20}));
  whole.give(go("3", {"a"}, {20, 40}));
  whole.step(8);
  const std::vector<Message> saved = whole.kept.store.messages;
  ASSERT_EQ(whole.orders.size(), 3u);
  std::size_t begins = 0;
  while (!std::holds_alternative<OrderStatus>(saved[begins])) ++begins;
  for (std::size_t cut = begins; cut <= saved.size(); ++cut) {
    Serving after(std::vector<Message>(saved.begin(), saved.begin() + static_cast<std::ptrdiff_t>(cut)));
    after.now = whole.now + 1;
    after.points = whole.points;  // the agents were not killed
    // The senders of orders repeat what was not answered. The agents say again where they are.
    after.step();
    after.give(go("1", {"a"}, {40, 60}));
    after.give(go("2", {}, {40, 20}));
    after.give(go("3", {"a"}, {20, 40}));
    after.step(10);
    std::size_t missions = 0;
    for (const RobotName robot : {"a", "b"}) missions += after.missions[robot].number - 1;
    for (const char* id : {"1", "2", "3"})
      EXPECT_EQ(after.orders.at(id).state, OrderState::done) << id << " " << cut;
    EXPECT_EQ(missions, 3u) << "a mission for each order, after message " << cut;
  }
}

TEST(ServiceOrders, NewOrdersAreRefusedWhileThereIsNoRoomAndAllOthersGoOn) {
  Serving run;
  run.obeys = false;
  run.give(go("1", {"a"}, {40, 60}));
  run.step(2);
  run.service.refuse_orders("it cannot be saved: the disk of x is full");
  run.give(go("2", {"b"}, {100, 20}));
  run.give(OrderMessage{.id = "3", .action = Action::pause, .robots = {"b"}});
  run.step(2);
  EXPECT_EQ(run.orders.at("2").state, OrderState::failed);
  EXPECT_EQ(run.orders.at("2").reason, "it cannot be saved: the disk of x is full");
  EXPECT_FALSE(is_ended(run.orders.at("3").state)) << "it is taken up";
  EXPECT_EQ(run.orders.at("1").state, OrderState::under_way);
  run.service.refuse_orders({});
  run.give(go("4", {"b"}, {100, 20}));
  run.step(2);
  EXPECT_FALSE(is_ended(run.orders.at("4").state));
}

}  // namespace
}  // namespace coppice
