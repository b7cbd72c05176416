// What the tracks of a run show: how far each robot drove, where it is, and how near robots came to each
// other and to obstacles. Made part by part, because the tracks of a long run do not fit into memory; what
// was made of the parts so far can be saved.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include "coppice/motion/separation.h"
#include "coppice/planning/clearance_field.h"
#include "files/track_record.h"
#include "planner_service/report/robot_record.h"
#include "saved_run.pb.h"

namespace coppice {

struct Driven {
  /// `tasks`: of the beginning, by robot.
  explicit Driven(const std::vector<RobotTask>& tasks);

  std::vector<double> length;  ///< by robot
  std::vector<std::optional<TrackPoint>> last;
  /// Fleet time from which on the robot was within the tolerance of its last goal, after it came to a stop
  /// there.
  std::vector<std::optional<double>> stands_since;
  std::optional<Separation> separation{};
  std::optional<ObstacleClearance> clearance{};
  std::set<std::size_t> drive_out{};  ///< robots that began too near to an obstacle, and are not free yet
};

/// Adds the next part. `robots`: in the order of the tracks.
void add(Driven& driven, const TrackPart& part, const RobotRecords& robots, const ClearanceField& field);

void save(const Driven& driven, proto::SavedRun& to);
/// Into one that is empty. False: it is not of so many robots.
bool recall(const proto::SavedRun& from, Driven& driven);

}  // namespace coppice
