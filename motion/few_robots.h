// A joint plan (joint_plan.h) for few robots of one size in narrow passages: weighted A* over their joint
// configurations (joint_a_star.h), on one packing of places after the other.
//
// Which places robots can take side by side depends on where packing begins: in a dead end that holds three
// robots, three fit only if the first one is packed at its end. So packing begins at each of some anchors in
// turn.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "motion/joint_a_star.h"
#include "motion/joint_plan.h"
#include "motion/packed_roadmap.h"
#include "planning/clearance_field.h"

namespace coppice {

class FewRobots {
 public:
  /// More have too many configurations.
  static constexpr std::size_t most = 4;

  /// `field` outlives it. The robots are planned for as discs of `radius`, on a lattice of `spacing`; the
  /// obstacles stay where they are. Goals can be reached.
  FewRobots(const ClearanceField& field, double radius, double spacing, std::vector<JointTask> robots,
            std::vector<Disc> obstacles, std::vector<Point2> anchors);

  /// A bounded amount of work. True once it has ended.
  bool step();
  /// The moves, by number of the robot; none if nothing was found. Once it has ended.
  const std::optional<std::vector<Move>>& moves() const { return moves_; }

 private:
  void begin_at(const Point2& anchor);

  const ClearanceField& field_;
  double radius_;
  double spacing_;
  std::vector<JointTask> robots_;
  std::vector<Disc> obstacles_;
  std::vector<Point2> anchors_;  ///< that are left, the next one last
  std::optional<PackedRoadmap> packed_;
  AnnotatedRoadmap graph_;
  std::optional<JointAStar> search_;
  std::optional<std::vector<Move>> moves_;
};

}  // namespace coppice
