// Route finders for robots of several sizes on one field, and who can reach its goal at all.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "motion/joint_plan.h"
#include "motion/route_finder.h"

namespace coppice {

class RouteFinders {
 public:
  /// `field` outlives it.
  explicit RouteFinders(const ClearanceField& field) : field_(field) {}

  /// For a disc of `radius`, on a lattice of share() of the usual spacing.
  RouteFinder& of(double radius);
  double share() const { return share_; }
  /// From now on the lattices are of this share. What of() gave is no more.
  void refine(double share);
  /// Lattice vertices that all of them have looked at.
  std::size_t effort() const;

 private:
  const ClearanceField& field_;
  double share_ = 1;
  std::map<double, RouteFinder> finders_;  ///< by radius
  std::size_t effort_before_ = 0;          ///< on finders that are no more
};

/// Each robot's way to its goal if it were alone with those that are not movable; empty: it has none, or does
/// not want to go anywhere. The lattices become finer until all are found that there are, or as fine as they
/// get.
std::vector<Path> ways_alone(const ClearanceField& field, std::span<const JointTask> tasks,
                             RouteFinders& finders);

}  // namespace coppice
