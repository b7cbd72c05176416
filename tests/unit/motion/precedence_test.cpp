// Tests of robots that drive a joint plan at very different speeds and stop now and then. Each passes its
// gates only in the order of the plan. So the robots never come near each other, and all reach the end.
#include "motion/precedence.h"

#include <gtest/gtest.h>

#include "motion/joint_planner.h"
#include "motion/way_follower.h"
#include "planning/map_generator.h"

namespace coppice {
namespace {

constexpr double period = 0.05;

TEST(Precedence, NoRobotWaitsForALaterMove) {
  const std::vector<Move> moves{{0, {{0, 0}, {100, 0}}}, {1, {{50, -50}, {50, 50}}}};
  const std::vector<double> radii{5, 5};
  EXPECT_TRUE(gates_of(0, moves, radii).empty());
  const std::vector<Gate> gates = gates_of(1, moves, radii);
  ASSERT_FALSE(gates.empty());
  EXPECT_EQ(gates.front().robot, 0u);
  EXPECT_LT(gates.front().at, 50 - 10);  // before the discs could touch
  EXPECT_GT(gates.back().needed, 50 + 10);
}

TEST(Precedence, DistantPathsHaveNoGates) {
  const std::vector<Move> moves{{0, {{0, 0}, {100, 0}}}, {1, {{0, 15}, {100, 15}}}};
  EXPECT_TRUE(gates_of(1, moves, std::vector<double>{5, 5}).empty());
}

TEST(Precedence, AWaitTellsHowFarTheOtherRobotHasStillToDrive) {
  // The second robot crosses the path of the first one once that is through.
  const std::vector<Move> moves{{0, {{0, 0}, {100, 0}}}, {1, {{50, -40}, {50, 40}}}};
  const std::vector<double> radii{5, 5};
  const std::vector<Gate> gates = gates_of(1, moves, radii);
  WayFollower second(legs_of(1, moves), 5, stray_radii * 5);
  Gates ahead(gates);
  double open = 0;
  double first = 0;
  Point2 position = moves[1].path.front();
  const auto drive = [&] {
    for (int k = 0; k < 200; ++k) {
      open = ahead.open(second.progress(), gate_slack_radii * 5, [&](std::size_t) { return first; });
      position += period * second.preferred_velocity(position, {20, 40}, period, open);
    }
  };
  for (const double come : {0.0, 0.5}) {
    first = come * gates.front().needed;
    drive();
    EXPECT_NEAR(second.progress(), open, 0.05);
    EXPECT_EQ(ahead.wait().robot, 0u);
    EXPECT_DOUBLE_EQ(ahead.wait().metres, gates.front().needed - first);
  }
  first = gates.back().needed;
  drive();
  EXPECT_TRUE(ahead.all_open());
  EXPECT_TRUE(second.finished());
}

/// The gates by their definition: all pieces are compared with all, and are shorter than those of gates_of.
TEST(Precedence, EveryPlaceWherePathsComeNearHasAGate) {
  Random random(1);
  for (int round = 0; round < 1000; ++round) {
    const double scale = std::pow(10, random.uniform(-1, 3));
    const auto anywhere = [&] {
      return Point2(random.uniform(-scale, scale), random.uniform(-scale, scale));
    };
    std::vector<Move> moves{{0, {anywhere(), anywhere()}}, {1, {anywhere(), anywhere(), anywhere()}}};
    if (round % 3 == 0) moves[1].path = {{0.3, -scale}, {0.3, scale}};
    const std::vector<double> radii{3, 5};
    const std::vector<Gate> gates = gates_of(1, moves, radii);
    EXPECT_TRUE(gates_of(0, moves, radii).empty());  // it moves first
    const double length = length_of(moves[0].path);
    const Point2 step = (moves[0].path[1] - moves[0].path[0]) / 200;
    double nearest = std::numeric_limits<double>::infinity();
    double needed = 0;
    for (int k = 0; k <= 200; ++k) {
      const double distance = point_path_distance(moves[0].path[0] + k * step, moves[1].path);
      nearest = std::min(nearest, distance);
      if (distance < 8) needed = length * k / 200;
    }
    if (nearest < 8) {
      ASSERT_FALSE(gates.empty());
      EXPECT_GE(gates.back().needed, std::min(length, needed) - 1e-9);
    }
    for (std::size_t k = 1; k < gates.size(); ++k) EXPECT_GT(gates[k].needed, gates[k - 1].needed);
  }
}

/// A move to and fro. Each edge is one piece at radius 1.
Move shuttle(std::size_t robot, const Point2& at, std::size_t edges) {
  Move move{robot, {at}};
  for (std::size_t k = 0; k < edges; ++k) move.path.push_back(at + Point2(k % 2 == 0 ? 0.1 : 0, 0));
  return move;
}

// Piece by piece, the comparison of a hostile leader's plan would take minutes.
TEST(Precedence, ARobotWaitsForAllEarlierMovesIfTheComparisonTakesTooLong) {
  const std::vector<double> radii{1, 1, 1};
  const auto moves = [](std::size_t edges) {
    // The moves are side by side, a little too far away to touch. The first move spans the second
    // one.
    return std::vector<Move>{{1, {{0, 9}, {0, 0}}},
                             shuttle(0, {0, 2.9}, edges),
                             {2, {{50, 0}, {60, 0}}},
                             shuttle(1, {0, 0}, edges),
                             shuttle(0, {0, 2.9}, 10)};
  };
  EXPECT_TRUE(gates_of(1, moves(100), radii).empty());
  const std::vector<Move> many = moves(10'000);
  const std::vector<Gate> gates = gates_of(1, many, radii);
  ASSERT_EQ(gates.size(), 2u);
  EXPECT_GT(gates[0].at, 9) << "within the second of its moves";
  for (const std::size_t k : {0u, 1u}) {
    EXPECT_EQ(gates[k].at, gates[0].at);
    EXPECT_EQ(gates[k].robot, 2 * k);
    EXPECT_NEAR(gates[k].needed, length_of(many[k + 1].path), 1e-6) << "and no later move";
  }
}

TEST(Precedence, ARobotThatPassesAfterAMillionPiecesIsWaitedFor) {
  const std::vector<Move> moves{
      {1, {{0, 9}, {0, 0}}}, shuttle(0, {0, 2.9}, 1'100'000), {2, {{-5, 0}, {5, 0}}}, {1, {{0, 0}, {0, -9}}}};
  const std::vector<Gate> gates = gates_of(1, moves, std::vector<double>{1, 1, 1});
  const auto last = std::ranges::find(gates, 2u, &Gate::robot);
  ASSERT_NE(last, gates.end());
  EXPECT_LE(last->at, 9 + 0.1);
  EXPECT_NEAR(last->needed, 10, 1e-9);
}

TEST(Precedence, RobotsKeepTheOrderOfThePlanAtAnySpeed) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const OccupancyMap map = generate_map(MapKind::room, 256, 256, random);
    const ClearanceField field(map);
    std::vector<JointTask> tasks;
    for (const StartAndGoal& task : random_tasks(field, 8, 5, 0.2, random))
      tasks.push_back({task.start, task.goal, 5});
    MapRoadmaps places(field);
    JointPlanner planner(places, tasks, Random(seed));
    while (!planner.step()) {
    }
    const JointPlan& plan = planner.plan();
    ASSERT_TRUE(plan.stranded.empty()) << seed;

    const std::vector<double> radii(tasks.size(), 5.0);
    struct Runner {
      WayFollower follower;
      Gates gates;
      Point2 position;
      double pace;
      int pause = 0;
    };
    std::vector<std::optional<Runner>> runners(tasks.size());
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const std::vector<Path> legs = legs_of(i, plan.moves);
      if (!legs.empty())
        runners[i] = Runner{WayFollower(legs, 5, stray_radii * 5), Gates(gates_of(i, plan.moves, radii)),
                            tasks[i].position, random.uniform(2, 20)};
    }
    const auto passed = [&](std::size_t k) { return runners[k] ? runners[k]->follower.progress() : 0.0; };
    bool all_there = false;
    for (int step = 0; step < 40'000 && !all_there; ++step) {
      all_there = true;
      for (auto& runner : runners) {
        if (!runner || runner->follower.finished()) continue;
        all_there = false;
        if (runner->pause == 0 && random.uniform() < 0.002) runner->pause = 200;
        if (runner->pause > 0 && --runner->pause > 0) continue;
        const Limits limits{runner->pace, 2 * runner->pace};
        const double open = runner->gates.open(runner->follower.progress(), gate_slack_radii * 5, passed);
        const Point2 v = runner->follower.preferred_velocity(runner->position, limits, period, open);
        runner->position += period * v;
      }
      for (std::size_t a = 0; a < runners.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          const Point2 pa = runners[a] ? runners[a]->position : tasks[a].position;
          const Point2 pb = runners[b] ? runners[b]->position : tasks[b].position;
          ASSERT_GE((pa - pb).norm(), 10) << "seed " << seed << " step " << step << ": " << a << " and " << b;
        }
      }
    }
    EXPECT_TRUE(all_there) << seed;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const Point2 end = runners[i] ? runners[i]->position : tasks[i].position;
      EXPECT_LT((end - *tasks[i].goal).norm(), 0.1) << seed;
    }
  }
}

}  // namespace
}  // namespace coppice
