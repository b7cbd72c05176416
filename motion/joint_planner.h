// Looks for a joint plan (joint_plan.h): for robots of one size by LaCAM on places (lacam.h), which sorts out
// crowds at once. Where that finds nothing in bounded time, robots may stand in a clinch: side by side, so
// that neither can take a way to another place without touching the other. So it has a second try on more
// places: a step away from robots that did not get away, and sidings. Where that finds nothing either the
// crowd is taken apart and put together again (dismantling.h). Where even that cannot be done it is the
// slower search for refuges (push_and_rotate.h), unless too many want to go somewhere: then it is what brings
// the most robots to their goals, and the others call again from where they stand then. For robots of several
// sizes the search for refuges comes first, and what it does not sort out is taken apart.
//
// Metres in the map frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "motion/dismantling.h"
#include "motion/joint_plan.h"
#include "motion/lacam.h"
#include "motion/places.h"
#include "motion/push_and_rotate.h"
#include "planning/clearance_field.h"
#include "planning/random.h"

namespace coppice {

class JointPlanner {
 public:
  /// `places`, and their field, outlive it. A robot that could not even reach its goal alone is stranded from
  /// the start.
  JointPlanner(PlacesOfMap& places, std::vector<JointTask> tasks, Random random);

  /// A bounded amount of work. True once the plan is there.
  bool step();
  /// One that strands nobody without need, or else one that strands few.
  const JointPlan& plan() const { return plan_; }
  /// It is of no more use then.
  JointPlan take_plan() { return std::move(plan_); }

 private:
  void set_up_crowd(std::span<const Point2> elbow_room);
  bool dismantle();
  bool search_crowd();
  bool in_a_clinch(const JointTask& task) const;
  std::vector<Point2> elbow_room() const;
  JointPlan best_of_crowd() const;
  bool take_up(JointPlan plan);

  PlacesOfMap& places_;
  std::vector<JointTask> tasks_;
  Random random_;
  PlaceGraph graph_{};
  std::vector<std::size_t> movable_;  ///< the robots of `crowd_`
  std::optional<Lacam> crowd_;
  std::size_t configurations_ = 0;
  bool second_try_ = false;
  std::unique_ptr<Dismantling> dismantling_;
  bool dismantled_ = false;  ///< or that was tried in vain
  std::unique_ptr<PushAndRotate> refuges_;
  std::optional<JointPlan> partial_;  ///< the best of the crowds that were not sorted out
  std::vector<std::size_t> shut_in_;
  JointPlan plan_;
};

}  // namespace coppice
