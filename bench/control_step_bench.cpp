// Cost of a control step of one robot among 50 others, avoidance and the check of promises together: when the
// robot chooses its velocity, and when it follows a joint plan.
#include <cmath>
#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/random.h"
#include "motion/body/driver.h"

namespace coppice {
namespace {

constexpr double radius = 5;
constexpr double period = 0.05;
constexpr Limits limits{20, 40};
constexpr std::size_t neighbours = 50;
constexpr std::size_t scenes = 64;
constexpr double centre = 256;

struct Scene {
  Driver body;
  Point2 preferred;
  std::vector<Neighbour> others;
};

Point2 anywhere(double most, Random& random) {
  return {random.uniform(-most, most), random.uniform(-most, most)};
}

/// 50 other robots that do not overlap, as dense as in the middle of a circle swap. `share` of them move.
/// Their states are up to 0.15 s old.
std::vector<Scene> clusters(double share) {
  Random random(1);
  std::vector<Scene> clusters;
  while (clusters.size() < scenes) {
    Scene scene{Driver({centre, centre}, 1, radius, limits, period), anywhere(20, random), {}};
    std::vector<Point2> places{scene.body.position()};
    while (scene.others.size() < neighbours) {
      const Point2 p = scene.body.position() + anywhere(60, random);
      const auto touches = [&](const Point2& q) { return (p - q).norm() < 2.1 * radius; };
      if (std::ranges::any_of(places, touches)) continue;
      places.push_back(p);
      const Point2 v = random.uniform() < share ? anywhere(12, random) : Point2::Zero();
      const double stamp = 1 - 0.05 * static_cast<double>(random.index(4));
      const Promise c{.stamp = stamp,
                      .position = p,
                      .velocity = v,
                      .decision_time = stamp + period,
                      .next_velocity = v,
                      .expiry = stamp + (v.isZero(0) ? 0.5 : 2 * period)};
      scene.others.push_back({.promise = c, .radius = radius, .limits = limits, .clock_error = 0.001});
    }
    clusters.push_back(std::move(scene));
  }
  return clusters;
}

template <class Step>
void run(benchmark::State& state, Step&& step) {
  const OccupancyMap map{.width = 512, .height = 512, .blocked = std::vector<std::uint8_t>(512 * 512, 0)};
  const ClearanceField field(map);
  std::vector<Scene> all = clusters(static_cast<double>(state.range(0)) / 100);
  std::size_t n = 0;
  for (auto _ : state) {
    Scene& scene = all[n++ % scenes];
    step(scene, field);
    benchmark::DoNotOptimize(scene.body);
  }
}

void evade(benchmark::State& state) {
  run(state, [](Scene& s, const ClearanceField& field) {
    s.body.take(s.body.evading(s.preferred, s.others, field));
  });
}

void follow(benchmark::State& state) {
  run(state, [](Scene& s, const ClearanceField& field) {
    s.body.take(s.body.following(s.preferred, s.others, field).next);
  });
}

// The argument: the percentage of moving robots.
BENCHMARK(evade)->Arg(0)->Arg(50)->Arg(100);
BENCHMARK(follow)->Arg(0)->Arg(50)->Arg(100);

}  // namespace
}  // namespace coppice
