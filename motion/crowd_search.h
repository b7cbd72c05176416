// LaCAM (lacam.h) for a cluster on a packed roadmap (packed_roadmap.h). It solves most clusters at once.
//
// All robots are planned for as if they were as large as the largest. Where the roadmap misses a way that a
// robot has, it is packed anew on a finer lattice.
//
// Robots may stand in a clinch: so close side by side that none can drive to another vertex without touching
// the next one. Or a short branch of a passage gets its only vertex in its mouth. For these there are more
// vertices: beside robots that did not get away, and in a row from the ends of passages.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/cluster_roadmap.h"
#include "motion/joint_plan.h"
#include "motion/lacam.h"
#include "motion/packed_roadmap.h"

namespace coppice {

class CrowdSearch {
 public:
  /// Whether all robots would have room at their positions and goals if all were as large as the largest.
  /// Then a plan for such robots is also valid for the real ones.
  static bool has_room(std::span<const JointTask> tasks, const ClearanceField& field);

  /// `places`, its field and `tasks` must outlive it, and has_room() must hold. A robot that could not reach
  /// its goal even if it were alone is stranded from the start, and gives way.
  CrowdSearch(MapRoadmaps& places, std::span<const JointTask> tasks, Random random);

  /// Does a bounded amount of work. Gives up after so many configurations in all.
  Progress go_on(std::size_t most_configurations);
  /// Whether configurations are left, and more of them are allowed.
  bool can_go_on() const { return lacam_ && !ended_; }
  /// Begins anew on a roadmap with more vertices, if there are any to be added.
  void add_vertices();

  double radius() const { return radius_; }
  double spacing() const { return spacing_; }
  const std::vector<std::size_t>& shut_in() const { return shut_in_; }
  /// Where the robots began that are not at their goals in the present configuration.
  std::vector<Point2> starts_under_way() const;

 private:
  PackedRoadmap& packed() { return places_.packed(radius_, spacing_); }
  void begin(std::span<const Point2> more);
  std::optional<double> spacing_of_missed_way();
  JointPlan best() const;
  std::vector<Point2> elbow_room() const;
  bool in_a_clinch(const JointTask& task) const;

  MapRoadmaps& places_;
  std::span<const JointTask> tasks_;
  double radius_;   ///< metres, of the largest robot
  double spacing_;  ///< metres, of the lattice on which the vertices lie
  Random random_;
  std::optional<ClusterRoadmap> roadmap_{};
  std::optional<Lacam> lacam_{};  ///< none: the finest roadmap misses a way
  std::vector<std::size_t> shut_in_{};
  std::size_t configurations_ = 0;
  bool ended_ = false;  ///< there are no more configurations, or too many are stored
};

}  // namespace coppice
