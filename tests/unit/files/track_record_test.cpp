// Tests of track records in memory and on disk against the tracks themselves.
#include "files/track_record.h"

#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"
#include "tests/tracks.h"

namespace coppice {
namespace {

bool same(const TrackPoint& a, const TrackPoint& b) {
  return a.time == b.time && a.position == b.position && a.velocity == b.velocity;
}

struct Recorded {
  TrackRecord record;
  std::vector<std::vector<TrackPoint>> tracks;
};

/// Robots that begin and end at different times. Points are recorded in batches, as agents send them.
Recorded recorded(TrackRecord record) {
  Recorded result{std::move(record), std::vector<std::vector<TrackPoint>>(3)};
  Random random(1);
  for (int k = 0; k < 3000; ++k) {
    for (std::size_t robot = 0; robot < 3; ++robot) {
      const bool there = robot == 0 || (robot == 1 && k > 900) || (robot == 2 && k < 1100);
      if (!there) continue;
      const TrackPoint point{0.05 * k, {random.uniform(), random.uniform()}, {random.uniform(), 0}};
      result.tracks[robot].push_back(point);
      result.record.append(robot, point);
    }
  }
  return result;
}

/// What `around` must return, found by looking at every point.
std::vector<TrackPoint> around(const std::vector<TrackPoint>& track, double from, double until) {
  std::vector<TrackPoint> result;
  for (std::size_t k = 0; k < track.size(); ++k) {
    const bool goes_on_after_from = k + 1 == track.size() || track[k + 1].time >= from;
    const bool comes_before_until = k == 0 || track[k - 1].time < until;
    const bool inside = track[k].time >= from && track[k].time < until;
    const bool last_before = track[k].time < from && goes_on_after_from;
    const bool first_after = track[k].time >= until && comes_before_until;
    if (inside || last_before || first_after) result.push_back(track[k]);
  }
  return result;
}

void expect_right(const Recorded& given) {
  Random random(2);
  for (std::size_t robot = 0; robot < 3; ++robot) {
    EXPECT_EQ(given.record.size(robot), given.tracks[robot].size());
    EXPECT_TRUE(same(*given.record.last(robot), given.tracks[robot].back()));
    for (int trial = 0; trial < 200; ++trial) {
      const double from = 170 * random.uniform() - 10;
      const double until = from + 40 * random.uniform();
      const auto found = given.record.around(robot, from, until);
      const auto right = around(given.tracks[robot], from, until);
      ASSERT_EQ(found.size(), right.size()) << robot << " " << from << " " << until;
      for (std::size_t k = 0; k < found.size(); ++k) EXPECT_TRUE(same(found[k], right[k]));
    }
  }
  // The stretches together hold every point once.
  std::vector<std::vector<TrackPoint>> all(3);
  given.record.for_each_stretch([&](double from, double until) {
    for (std::size_t robot = 0; robot < 3; ++robot) {
      for (const TrackPoint& point : given.record.around(robot, from, until)) {
        if (point.time >= from && point.time < until) all[robot].push_back(point);
      }
    }
  });
  for (std::size_t robot = 0; robot < 3; ++robot) {
    ASSERT_EQ(all[robot].size(), given.tracks[robot].size());
    for (std::size_t k = 0; k < all[robot].size(); ++k)
      EXPECT_TRUE(same(all[robot][k], given.tracks[robot][k]));
  }
}

TEST(TrackRecord, ARecordInMemoryReturnsWhatWasRecorded) {
  expect_right(recorded(TrackRecord()));
}

TEST(TrackRecord, ARecordOnDiskReturnsWhatWasRecorded) {
  expect_right(recorded(TrackRecord::on_disk(std::filesystem::temp_directory_path())));
}

TEST(TrackRecord, ARecordStaysInMemoryIfNoFileCanBeMade) {
  expect_right(recorded(TrackRecord::on_disk("/dev/null/nowhere")));
}

TEST(TrackRecord, AnEmptyRecordHoldsNothing) {
  const TrackRecord record;
  EXPECT_EQ(record.size(7), 0u);
  EXPECT_FALSE(record.last(7));
  EXPECT_TRUE(record.around(7, 0, 1).empty());
  record.for_each_stretch([](double, double) { FAIL(); });
}

}  // namespace
}  // namespace coppice
