// Costs of the clearance field: building it, a look-up, a disc and a segment, in open space and between
// obstacles.
#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/random.h"

namespace coppice {
namespace {

constexpr std::size_t side = 512;
constexpr double radius = 5;
constexpr std::size_t samples = 1 << 12;

OccupancyMap blank() {
  OccupancyMap map;
  map.width = map.height = static_cast<int>(side);
  map.blocked.assign(side * side, 0);
  return map;
}

/// A map with `count` blocks of up to 32 by 32 cells.
OccupancyMap cluttered(int count) {
  OccupancyMap map = blank();
  Random random(1);
  for (int n = 0; n < count; ++n) {
    const std::size_t i = random.index(side - 32);
    const std::size_t j = random.index(side - 32);
    const std::size_t right = i + random.index(32);
    const std::size_t top = j + random.index(32);
    for (std::size_t y = j; y <= top; ++y) {
      for (std::size_t x = i; x <= right; ++x) map.blocked[y * side + x] = 1;
    }
  }
  return map;
}

OccupancyMap map_for(const benchmark::State& state) {
  return cluttered(static_cast<int>(state.range(0)));
}

std::vector<Point2> random_points(Random& random) {
  std::vector<Point2> points(samples);
  for (Point2& p : points) p = {random.uniform(20, side - 20), random.uniform(20, side - 20)};
  return points;
}

void build(benchmark::State& state) {
  const OccupancyMap map = map_for(state);
  for (auto _ : state) benchmark::DoNotOptimize(ClearanceField(map));
}

void look_up(benchmark::State& state) {
  const ClearanceField field(map_for(state));
  Random random(2);
  const std::vector<Point2> points = random_points(random);
  std::size_t n = 0;
  for (auto _ : state) benchmark::DoNotOptimize(field.lower_bound(points[n++ % samples]));
}

void disc(benchmark::State& state) {
  const ClearanceField field(map_for(state));
  Random random(3);
  const std::vector<Point2> points = random_points(random);
  std::size_t n = 0;
  for (auto _ : state) benchmark::DoNotOptimize(field.is_free(points[n++ % samples], radius));
}

void exact_clearance(benchmark::State& state) {
  const ClearanceField field(map_for(state));
  Random random(4);
  const std::vector<Point2> points = random_points(random);
  std::size_t n = 0;
  for (auto _ : state) benchmark::DoNotOptimize(field.clearance(points[n++ % samples]));
}

/// Segments of 10 m that begin where the disc is free.
void segment(benchmark::State& state) {
  const ClearanceField field(map_for(state));
  Random random(5);
  std::vector<Point2> from;
  std::vector<Point2> to;
  while (from.size() < samples) {
    const Point2 p(random.uniform(20, side - 20), random.uniform(20, side - 20));
    const Point2 q = p + 10 * Point2(random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    if (!field.is_free(p, radius)) continue;
    from.push_back(p);
    to.push_back(q);
  }
  std::size_t n = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(field.segment_free(from[n % samples], to[n % samples], radius));
    ++n;
  }
}

/// The worst case: along the middle of a corridor that just fits the disc.
void tight_corridor(benchmark::State& state) {
  OccupancyMap map = blank();
  for (std::size_t i = 0; i < side; ++i) map.blocked[100 * side + i] = map.blocked[111 * side + i] = 1;
  const ClearanceField field(map);
  const Point2 from(50, 106);
  const Point2 to(50 + static_cast<double>(state.range(0)), 106);
  for (auto _ : state) benchmark::DoNotOptimize(field.segment_free(from, to, radius));
}

BENCHMARK(build)->Arg(0)->Arg(150)->Unit(benchmark::kMillisecond);
BENCHMARK(look_up)->Arg(0)->Arg(150);
BENCHMARK(disc)->Arg(0)->Arg(150);
BENCHMARK(exact_clearance)->Arg(0)->Arg(150);
BENCHMARK(segment)->Arg(0)->Arg(150);
BENCHMARK(tight_corridor)->Arg(10)->Arg(100);

}  // namespace
}  // namespace coppice
