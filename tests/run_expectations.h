// Checks of a fleet's report and recorded trajectory, for fleets on any bus.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/run_check.h"

namespace coppice::test {

inline constexpr double tolerance = 1e-3;  ///< metres: rounding in files and contact

inline double length(const proto::Report::Robot& robot) {
  double sum = 0;
  for (int i = 1; i < robot.path_size(); ++i) {
    sum += std::hypot(robot.path(i).x() - robot.path(i - 1).x(), robot.path(i).y() - robot.path(i - 1).y());
  }
  return sum;
}

/// Every robot has a path from its start to its goal that keeps its radius clear.
inline void expect_good_paths(const proto::Report& report, const std::vector<Expected>& robots, double radius,
                              const PlainMap& map) {
  ASSERT_EQ(static_cast<std::size_t>(report.robots_size()), robots.size());
  double sum = 0;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const auto& robot = report.robots(static_cast<int>(i));
    SCOPED_TRACE(robot.name());
    EXPECT_EQ(robot.name(), robots[i].name);
    EXPECT_TRUE(robot.planned());
    ASSERT_GE(robot.path_size(), 2);
    std::vector<Vertex> path;
    for (const auto& p : robot.path()) path.push_back({p.x(), p.y()});
    EXPECT_LE(distance(path.front(), robots[i].start), tolerance);
    EXPECT_LE(distance(path.back(), robots[i].goal), tolerance);
    for (std::size_t k = 1; k < path.size(); ++k) {
      EXPECT_GE(map.clearance(path[k - 1], path[k], radius + 1), radius - tolerance) << "leg " << k;
    }
    EXPECT_NEAR(robot.path_length(), length(robot), tolerance);
    sum += length(robot);
  }
  EXPECT_NEAR(report.path_length(), sum / static_cast<double>(robots.size()), tolerance);
}

/// The report's figures of motion agree with the trajectory, and no robot touched anything.
inline void expect_good_motion(const proto::Report& report, const std::filesystem::path& trajectory,
                               double radius, const PlainMap& map) {
  const auto tracks = read_trajectory_rows(trajectory);
  ASSERT_EQ(tracks.size(), static_cast<std::size_t>(report.robots_size()));
  double separation = std::numeric_limits<double>::infinity();
  const double reach =
      radius + std::max(report.least_clearance(), 0.0) + 1;  // far enough to notice a report that is too low
  double clearance = reach - radius;
  for (auto a = tracks.begin(); a != tracks.end(); ++a) {
    for (auto b = std::next(a); b != tracks.end(); ++b) {
      separation = std::min(separation, least_distance(a->second, b->second) - 2 * radius);
    }
    double driven = 0;
    for (std::size_t i = 1; i < a->second.size(); ++i) {
      const Vertex from = a->second[i - 1].place;
      const Vertex to = a->second[i].place;
      driven += distance(from, to);
      clearance = std::min(clearance, map.clearance(from, to, reach) - radius);
    }
    const auto& rows = report.robots();
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.name() == a->first; });
    ASSERT_NE(row, rows.end()) << a->first;
    EXPECT_NEAR(row->driven_length(), driven, 0.01) << a->first;
  }
  EXPECT_GE(separation, -tolerance);
  EXPECT_GE(clearance, -tolerance);
  EXPECT_NEAR(report.least_separation(), separation, 0.01);
  EXPECT_NEAR(report.least_clearance(), clearance, 0.01);
  EXPECT_EQ(report.collisions(), 0u);
}

}  // namespace coppice::test
