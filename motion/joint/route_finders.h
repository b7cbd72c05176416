// Route finders for robots of several sizes on one field, and the robots' ways to their goals.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "motion/joint/joint_plan.h"
#include "motion/lattice/route_finder.h"

namespace coppice {

class RouteFinders {
 public:
  /// `field` must outlive it.
  explicit RouteFinders(const ClearanceField& field) : field_(field) {}

  /// The route finder of discs of `radius`, on a lattice of share() of the usual spacing.
  RouteFinder& of(double radius);
  double share() const { return share_; }
  /// Sets the share of all lattices. References that of() has returned become invalid.
  void refine(double share);
  /// Number of lattice vertices that all finders have examined or marked.
  std::size_t effort() const;

 private:
  const ClearanceField& field_;
  double share_ = 1;
  std::map<double, RouteFinder> finders_;  ///< by radius
  std::size_t effort_before_ = 0;          ///< effort of finders that were removed
};

/// Each robot's way to its goal if it were alone with the robots that are not movable. Empty if it has none,
/// or no goal. The lattices become finer until all existing ways are found, or the finest lattice is reached.
std::vector<Path> ways_alone(const ClearanceField& field, std::span<const JointTask> tasks,
                             RouteFinders& finders);

}  // namespace coppice
