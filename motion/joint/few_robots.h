// A joint plan (joint_plan.h) for few robots of one size in narrow passages: weighted A* over their joint
// configurations (joint_a_star.h), on several packed roadmaps in turn.
//
// Which vertices robots can take side by side depends on where packing begins: in a dead end that holds three
// robots, three fit only if the first vertex lies at its end. So packing begins at each of several anchors in
// turn.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "motion/joint/joint_a_star.h"
#include "motion/joint/joint_plan.h"
#include "motion/lattice/packed_roadmap.h"

namespace coppice {

class FewRobots {
 public:
  /// Largest number of robots. More robots have too many configurations.
  static constexpr std::size_t most = 4;

  /// `field` must outlive it. All robots are planned for as discs of `radius` (metres), on a lattice of
  /// `spacing` (metres). The obstacles do not move. Each goal must be reachable for its robot alone.
  FewRobots(const ClearanceField& field, double radius, double spacing, std::vector<JointTask> robots,
            std::vector<Disc> obstacles, std::vector<Point2> anchors);

  /// Does a bounded amount of work. Returns true once the search has ended.
  bool step();
  /// The moves, by index of the robot; none if no plan was found. Valid once the search has ended.
  const std::optional<std::vector<Move>>& moves() const { return moves_; }

 private:
  void begin_at(const Point2& anchor);

  const ClearanceField& field_;
  double radius_;
  double spacing_;
  std::vector<JointTask> robots_;
  std::vector<Disc> obstacles_;
  std::vector<Point2> anchors_;  ///< the anchors still to be tried, the next one last
  std::optional<PackedRoadmap> packed_;
  AnnotatedRoadmap graph_;
  std::optional<JointAStar> search_;
  std::optional<std::vector<Move>> moves_;
};

}  // namespace coppice
