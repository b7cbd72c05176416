// Cost of one robot's control step: the half planes of its neighbours and of obstacles, and the linear
// programme.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>

#include "coppice/motion/reciprocal_velocity.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/random.h"

namespace coppice {
namespace {

constexpr double radius = 5;
constexpr double max_speed = 20;
constexpr double horizon = 2;
constexpr double time_step = 0.05;
constexpr double obstacle_horizon = 0.25;
constexpr std::size_t scenes = 256;

Point2 at_angle(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

struct Scene {
  MovingDisc self;
  std::vector<MovingDisc> others;
  Point2 preferred;
};

/// Neighbours at 11 to 40 m, all moving, as in the middle of a circle swap.
std::vector<Scene> clusters(std::size_t neighbours) {
  Random random(1);
  const auto velocity = [&] { return Point2(random.uniform(5, max_speed) * at_angle(random.uniform(0, 7))); };
  std::vector<Scene> clusters;
  for (std::size_t n = 0; n < scenes; ++n) {
    Scene scene{{Point2::Zero(), velocity(), radius}, {}, velocity()};
    for (std::size_t k = 0; k < neighbours; ++k) {
      scene.others.push_back({random.uniform(11, 40) * at_angle(random.uniform(0, 7)), velocity(), radius});
    }
    clusters.push_back(scene);
  }
  return clusters;
}

void agent_step(benchmark::State& state) {
  const std::vector<Scene> all = clusters(static_cast<std::size_t>(state.range(0)));
  std::vector<HalfPlane> planes;
  std::size_t n = 0;
  for (auto _ : state) {
    const Scene& scene = all[n++ % scenes];
    planes.clear();
    for (const MovingDisc& other : scene.others) {
      planes.push_back(orca_half_plane(scene.self, other, horizon, time_step));
    }
    benchmark::DoNotOptimize(safe_velocity(scene.preferred, max_speed, {}, planes));
  }
}

/// Blocks of up to 24 by 24 cells. The disc fits between many of them.
ClearanceField blocks() {
  constexpr std::size_t side = 512;
  OccupancyMap map;
  map.width = map.height = static_cast<int>(side);
  map.blocked.assign(side * side, 0);
  Random random(2);
  for (int n = 0; n < 150; ++n) {
    const std::size_t i = random.index(side - 24);
    const std::size_t j = random.index(side - 24);
    const std::size_t right = i + random.index(24);
    const std::size_t top = j + random.index(24);
    for (std::size_t y = j; y <= top; ++y) {
      for (std::size_t x = i; x <= right; ++x) map.blocked[y * side + x] = 1;
    }
  }
  return ClearanceField(map);
}

/// At positions where an obstacle is near enough to matter.
void obstacles(benchmark::State& state) {
  const ClearanceField field = blocks();
  Random random(3);
  std::vector<Point2> places;
  while (places.size() < scenes) {
    const Point2 p(random.uniform(0, 512), random.uniform(0, 512));
    if (field.is_free(p, radius) && !field.is_free(p, radius + max_speed * obstacle_horizon))
      places.push_back(p);
  }
  std::vector<HalfPlane> planes;
  double total = 0;
  std::size_t n = 0;
  for (auto _ : state) {
    planes.clear();
    obstacle_half_planes(field, places[n++ % scenes], radius, max_speed * obstacle_horizon, obstacle_horizon,
                         planes);
    benchmark::DoNotOptimize(safe_velocity({max_speed, 0}, max_speed, planes, {}));
    total += static_cast<double>(planes.size());
  }
  state.counters["planes"] = benchmark::Counter(total, benchmark::Counter::kAvgIterations);
}

BENCHMARK(agent_step)->Arg(1)->Arg(3)->Arg(10)->Arg(30);
BENCHMARK(obstacles);

}  // namespace
}  // namespace coppice
