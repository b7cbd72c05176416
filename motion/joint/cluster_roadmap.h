// A cluster (cluster.h) on packed roadmaps (packed_roadmap.h): from the robots' positions and goals to
// vertices, and from moves along edges back to paths.
//
// Robots of several sizes share one roadmap, which has vertices for each size. A robot counts as larger than
// it is where it has room for that, so that there are few sizes.
//
// Where the vertices miss a way that a robot has, there are vertices along that way.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "motion/joint/cluster.h"
#include "motion/joint/joint_plan.h"
#include "motion/lattice/packed_roadmap.h"

namespace coppice {

class ClusterRoadmap {
 public:
  enum class Vertices {
    packed,
    /// And vertices beside robots in a clinch, so close side by side that none can drive to another vertex
    /// without touching the next one, and in a row from the ends of passages.
    packed_and_more,
    /// Packed from an end or a bend of a passage on, as closely as possible. Which vertices robots can take
    /// side by side depends on where packing begins: in a dead end that holds three robots, three fit only if
    /// the first vertex lies at its end.
    from_an_end,
  };
  struct Choice {
    Vertices vertices = Vertices::packed;
    double most_growth = 1;  ///< a robot counts as so many times as large as it is, at most
    std::size_t end = 0;     ///< the number of the end, the nearest first
  };

  /// `roadmaps`, its field and `tasks` must outlive it. At least one robot is movable; those that are not are
  /// obstacles. `stuck` are the robots around which vertices are added, or packing begins.
  ClusterRoadmap(MapRoadmaps& roadmaps, std::span<const JointTask> tasks, std::span<const std::size_t> stuck,
                 const Choice& choice);

  Cluster& cluster() { return *cluster_; }
  /// The number of ends from which packing may begin.
  std::size_t ends() const { return ends_; }
  /// The number of a robot of the cluster among the tasks.
  std::size_t task_of(std::uint32_t robot) const { return robots_[robot]; }
  /// The moves on the map. Robots that do not end at their goals are stranded.
  JointPlan plan_of(std::span<const VertexMove> moves) const;

 private:
  /// By the radius for which robots are planned, the largest first: the vertices that are added.
  using Points = std::map<double, std::vector<Point2>, std::greater<>>;

  bool fits(std::size_t robot, double radius) const;
  void choose_radii(double most_growth);
  void build();
  bool mend_what_is_missed();
  PackedRoadmap& packed(double radius);
  void add_stuck_points(double radius, std::vector<Point2>& points);
  bool in_a_clinch(const JointTask& task) const;

  MapRoadmaps& roadmaps_;
  std::span<const JointTask> tasks_;
  std::vector<std::size_t> stuck_;
  Choice choice_;
  std::vector<std::size_t> robots_{};  ///< the movable ones, numbers of tasks; ascending
  std::vector<double> radii_;          ///< by task, for which it is planned
  std::vector<Path> missed_;           ///< by task: vertices along a way that was missed
  std::size_t ends_ = 0;
  std::map<double, PackedRoadmap> from_an_end_{};  ///< by radius
  AnnotatedRoadmap graph_{};
  std::optional<Cluster> cluster_{};
};

}  // namespace coppice
