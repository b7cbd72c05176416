// Looks for a joint plan (joint_plan.h), by one method after the other:
//
// LaCAM on packed places (lacam.h, places.h) sorts out crowds at once.
//
// For four robots or fewer: weighted A* on packings that follow the passages (few_robots.h).
//
// LaCAM on more places. Robots may stand in a clinch: side by side, so that neither can take a way to another
// place without touching the other. So there are places a step away from robots that did not get away, and
// places one behind the other from the ends of passages.
//
// The crowd is taken apart and put together again (evacuation.h).
//
// The slower search for refuges (push_and_rotate.h). Where many want to go somewhere, what brought the most
// robots to their goals is taken instead, and the others call again from where they stand then.
//
// Robots of several sizes are planned for as if all were the largest. Where they have no room for that, the
// search for refuges comes first, and what it does not sort out is taken apart.
//
// Metres in the map frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "motion/evacuate_and_reassemble.h"
#include "motion/few_robots.h"
#include "motion/joint_plan.h"
#include "motion/lacam.h"
#include "motion/packed_roadmap.h"
#include "motion/push_and_rotate.h"
#include "planning/clearance_field.h"
#include "planning/random.h"

namespace coppice {

class JointPlanner {
 public:
  /// `places`, and their field, outlive it. A robot that could not even reach its goal alone is stranded from
  /// the start.
  JointPlanner(MapRoadmaps& places, std::vector<JointTask> tasks, Random random);

  /// A bounded amount of work. True once the plan is there.
  bool step();
  /// One that strands nobody without need, or else one that strands few.
  const JointPlan& plan() const { return plan_; }
  /// It is of no more use then.
  JointPlan take_plan() { return std::move(plan_); }

 private:
  void set_up_crowd(std::span<const Point2> elbow_room);
  void use_finer_places(double spacing, std::span<const Point2> elbow_room);
  PackedRoadmap& packed() { return places_.packed(radius_, spacing_); }
  bool has_room_for_the_largest() const;
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
  double radius_;   ///< of the largest robot
  double spacing_;  ///< of the lattice that places lie on
  Random random_;
  AnnotatedRoadmap graph_{};
  std::vector<std::size_t> movable_;  ///< the robots of `crowd_`
  std::optional<Lacam> crowd_;
  std::unique_ptr<FewRobots> few_;
  std::size_t configurations_ = 0;
  bool second_try_ = false;
  std::unique_ptr<EvacuateAndReassemble> evacuation_;
  bool evacuated_ = false;  ///< or that was tried in vain
  std::unique_ptr<PushAndRotate> refuges_;
  std::optional<JointPlan> partial_;  ///< the best of the crowds that were not sorted out
  std::vector<std::size_t> shut_in_;
  JointPlan plan_;
};

}  // namespace coppice
