#include "coppice/motion/separation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"

namespace coppice {
namespace {

Track track(double radius, std::vector<TrackPoint> points) {
  return {radius, std::move(points)};
}

TEST(Separation, TheMinimumBetweenTheStampsIsFound) {
  // They meet in the middle of a step; at every stamp they are 10 m apart.
  const std::vector<Track> tracks{track(1, {{0, {0, 0}, Point2::Zero()}, {1, {10, 0}, Point2::Zero()}}),
                                  track(1, {{0, {10, 0}, Point2::Zero()}, {1, {0, 0}, Point2::Zero()}})};
  const auto separation = separation_of(tracks);
  ASSERT_TRUE(separation);
  EXPECT_NEAR(separation->least, -2, 1e-12);
  EXPECT_EQ(separation->overlapping.size(), 1u);
}

TEST(Separation, RobotsStandBeforeAndAfterTheirTracks) {
  const std::vector<Track> tracks{track(1, {{0, {0, 0}, Point2::Zero()}, {1, {5, 0}, Point2::Zero()}}),
                                  track(1, {{7, {5, 3}, Point2::Zero()}, {8, {20, 3}, Point2::Zero()}})};
  EXPECT_NEAR(separation_of(tracks)->least, 1, 1e-12);
}

TEST(Separation, NobodyKnowsWhereARobotIsAfterATrackThatEndsInMotion) {
  const Track lost = track(1, {{0, {0, 0}, Point2::Zero()}, {1, {5, 0}, {5, 0}}});
  const Track passes_before =
      track(1, {{0, {5, 30}, Point2::Zero()}, {0.9, {5, 3}, {0, 30}}, {3, {5, 30}, {0, 0}}});
  const Track passes_after = track(1, {{2, {5, 30}, Point2::Zero()}, {4, {5, -30}, Point2::Zero()}});
  EXPECT_TRUE(separation_of(std::vector<Track>{lost, passes_after})->overlapping.empty());
  EXPECT_LT(separation_of(std::vector<Track>{lost, passes_before})->least, 1.2);
  EXPECT_EQ(clipped(lost, 0.5, 4).points.back().time, 1);
  EXPECT_TRUE(clipped(lost, 2, 4).points.empty());
}

TEST(Separation, ASingleTrackHasNoSeparation) {
  EXPECT_FALSE(separation_of({}));
  EXPECT_FALSE(separation_of(std::vector<Track>{track(1, {{0, {0, 0}, Point2::Zero()}}), track(1, {})}));
}

TEST(Separation, TheSeparationAgreesWithFineSampling) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    std::vector<Track> tracks;
    for (int k = 0; k < 5; ++k) {
      Track walk{random.uniform(0.1, 1), {}};
      Point2 p(random.uniform(0, 30), random.uniform(0, 30));
      double time = random.uniform(0, 3);
      for (int step = 0; step < 40; ++step) {
        walk.points.push_back({time, p, Point2::Zero()});
        time += random.uniform(0.01, 0.5);
        p += Point2(random.uniform(-2, 2), random.uniform(-2, 2));
      }
      tracks.push_back(walk);
    }
    const auto at = [](const Track& t, double time) {
      const auto next = std::ranges::upper_bound(t.points, time, std::less{}, &TrackPoint::time);
      if (next == t.points.begin()) return t.points.front().position;
      if (next == t.points.end()) return t.points.back().position;
      const auto before = std::prev(next);
      return Point2(before->position + (next->position - before->position) *
                                           ((time - before->time) / (next->time - before->time)));
    };
    double sampled = 1e9;
    for (double time = 0; time < 25; time += 0.001) {
      for (std::size_t a = 0; a < tracks.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          const double gap = (at(tracks[a], time) - at(tracks[b], time)).norm();
          sampled = std::min(sampled, gap - tracks[a].radius - tracks[b].radius);
        }
      }
    }
    const double least = separation_of(tracks)->least;
    EXPECT_LE(least, sampled + 1e-9);
    EXPECT_GE(least, sampled - 0.5);  // at most 250 m/s between two samples that are 1 ms apart
  }
}

TEST(ObstacleClearance, TheMinimumBetweenTheStampsIsFound) {
  OccupancyMap map{.width = 20, .height = 20, .blocked = std::vector<std::uint8_t>(400, 0)};
  map.blocked[10 * 20 + 10] = 1;  // covers [10, 11] x [10, 11]
  const ClearanceField field(map);
  const std::vector<Track> past{track(1, {{0, {5, 8.5}, Point2::Zero()}, {1, {15, 8.5}, Point2::Zero()}})};
  EXPECT_NEAR(clearance_of(past, field)->least, 0.5, 1e-9);
  EXPECT_EQ(clearance_of(past, field)->overlapping.size(), 0u);
  const std::vector<Track> through{
      track(1, {{0, {5, 10.5}, Point2::Zero()}, {1, {15, 10.5}, Point2::Zero()}})};
  EXPECT_NEAR(clearance_of(through, field)->least, -1, 1e-9);
  EXPECT_EQ(clearance_of(through, field)->overlapping.size(), 1u);
}

// A run may be cut at any time that lies between the stamps of all robots.
TEST(Separation, PartsInTimeGiveTheSameResultAsTheWholeRun) {
  Random random(5);
  const ClearanceField field(
      OccupancyMap{.width = 40, .height = 40, .blocked = std::vector<std::uint8_t>(1600, 0)});
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Track> tracks;
    for (int i = 0; i < 4; ++i) {
      std::vector<TrackPoint> points;
      double time = 5 * random.uniform();
      for (int k = 0; k < 8; ++k, time += 0.1 + 3 * random.uniform())
        points.push_back({time, 40 * Point2(random.uniform(), random.uniform()), Point2::Zero()});
      tracks.push_back(track(2, points));
    }
    std::optional<Separation> separation;
    std::optional<ObstacleClearance> clearance;
    for (double from = -1; from < 40; from += 3.7) {
      std::vector<Track> part;
      for (const Track& t : tracks) part.push_back(clipped(t, from, from + 3.7));
      add_part(separation, separation_of(part));
      add_part(clearance, clearance_of(part, field));
    }
    EXPECT_NEAR(separation->least, separation_of(tracks)->least, 1e-9);
    EXPECT_EQ(separation->overlapping, separation_of(tracks)->overlapping);
    EXPECT_NEAR(clearance->least, clearance_of(tracks, field)->least, 1e-9);
    EXPECT_EQ(clearance->overlapping, clearance_of(tracks, field)->overlapping);
  }
}

}  // namespace
}  // namespace coppice
