// Looks for a joint plan (joint_plan.h) by several methods in turn:
//
// LaCAM on a packed roadmap (lacam.h, packed_roadmap.h). It solves most clusters at once.
//
// For four robots or fewer: weighted A* on packed roadmaps that follow the passages (few_robots.h).
//
// LaCAM on more vertices. Two robots may stand in a clinch: so close side by side that neither can drive to
// another vertex without touching the other. So vertices are added beside robots that did not get away, and
// in a row from the ends of passages.
//
// Evacuate and reassemble (evacuate_and_reassemble.h).
//
// Push and rotate (push_and_rotate.h), which is slower. If many robots have a way to drive, the plan that
// brought the most robots to their goals is taken instead. The other robots ask again from where they stand
// then.
//
// Robots of several sizes are planned for as if all were as large as the largest. If they have no room for
// that, push and rotate comes first. If it strands robots, the small ones are set aside for the large ones
// (small_ones_aside.h), and evacuate and reassemble comes last.
//
// Metres in the map frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/random.h"
#include "motion/joint/evacuate_and_reassemble.h"
#include "motion/joint/few_robots.h"
#include "motion/joint/joint_plan.h"
#include "motion/joint/lacam.h"
#include "motion/joint/push_and_rotate.h"
#include "motion/joint/small_ones_aside.h"
#include "motion/lattice/packed_roadmap.h"

namespace coppice {

class JointPlanner {
 public:
  /// A part of a plan is not planned in parts again.
  enum class Methods { all, for_a_part };

  /// `places` and its field must outlive it. A robot that could not reach its goal even if it were alone is
  /// stranded from the start.
  JointPlanner(MapRoadmaps& places, std::vector<JointTask> tasks, Random random,
               Methods methods = Methods::all);

  /// Does a bounded amount of work. Returns true once the plan is complete.
  bool step();
  /// The plan. It strands no robot without need, or else few robots. Valid once step() has returned true.
  const JointPlan& plan() const { return plan_; }
  /// Moves the plan out. The planner must not be used afterwards.
  JointPlan take_plan() { return std::move(plan_); }

 private:
  void set_up_crowd(std::span<const Point2> elbow_room);
  void use_finer_places(double spacing, std::span<const Point2> elbow_room);
  PackedRoadmap& packed() { return places_.packed(radius_, spacing_); }
  bool has_room_for_the_largest() const;
  bool set_small_ones_aside();
  bool evacuate();
  bool search_few();
  bool search_crowd();
  bool in_a_clinch(const JointTask& task) const;
  std::vector<Point2> elbow_room() const;
  void set_up_few(std::span<const Point2> centres);
  std::vector<Point2> under_way() const;
  std::vector<Move> moves_of(std::span<const VertexMove> moves) const;
  JointPlan best_of_crowd() const;
  bool take_up(JointPlan plan);

  MapRoadmaps& places_;
  std::vector<JointTask> tasks_;
  double radius_;   ///< metres, of the largest robot
  double spacing_;  ///< metres, of the lattice on which the vertices lie
  Random random_;
  AnnotatedRoadmap graph_{};
  std::vector<std::size_t> movable_;  ///< indices of the robots of `crowd_`
  std::optional<Lacam> crowd_;
  std::unique_ptr<FewRobots> few_;
  std::size_t configurations_ = 0;
  bool second_try_ = false;
  std::unique_ptr<SmallOnesAside> parts_;  ///< null: it has failed, or cannot help
  std::unique_ptr<EvacuateAndReassemble> evacuation_;
  bool evacuated_ = false;  ///< or evacuation was tried in vain
  std::unique_ptr<PushAndRotate> refuges_;
  std::optional<JointPlan> partial_;  ///< the best plan of the searches that did not solve the cluster
  std::vector<std::size_t> shut_in_;
  JointPlan plan_;
};

}  // namespace coppice
