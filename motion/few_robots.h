// A joint plan (joint_plan.h) for few robots of one size in narrow passages: weighted A* over their joint
// configurations (joint_a_star.h), on several packed roadmaps in turn.
//
// Which vertices robots can take side by side depends on where packing begins: in a dead end that holds three
// robots, three fit only if the first vertex lies at its end. So packing begins at each of several ends and
// bends of the passages in turn.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "motion/cluster_roadmap.h"
#include "motion/joint_a_star.h"
#include "motion/joint_plan.h"
#include "motion/packed_roadmap.h"

namespace coppice {

class FewRobots {
 public:
  /// Whether the robots are few. More robots have too many configurations.
  static bool are_few(std::span<const JointTask> tasks);

  /// `places` and its field must outlive it. All robots are planned for as discs of `radius` (metres), on a
  /// lattice of `spacing` (metres). `shut_in` have no way to their goals, and may stand anywhere. Packing
  /// begins at the ends around `centres`.
  FewRobots(MapRoadmaps& places, double radius, double spacing, std::vector<JointTask> tasks,
            std::vector<std::size_t> shut_in, std::span<const Point2> centres);

  /// Does a bounded amount of work.
  Progress step();

 private:
  void begin_at(const Point2& anchor);

  const ClearanceField& field_;
  double radius_;
  double spacing_;
  std::vector<JointTask> tasks_;
  std::vector<std::size_t> shut_in_;
  std::vector<Point2> anchors_;  ///< the anchors still to be tried, the next one last
  std::optional<PackedRoadmap> packed_{};
  std::optional<ClusterRoadmap> roadmap_{};
  std::optional<JointAStar> search_{};
};

}  // namespace coppice
