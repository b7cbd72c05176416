// A joint plan (joint_plan.h) by way of places at which nobody is in anybody's way (parking.h).
//
// The crowd is taken apart: one robot after the other, whoever has a way, drives to a place to park. In
// thought the same is done from where all are to stand in the end. The plan is the first, what brings all
// from their first places to park to the second ones, and the reverse of the second: a way may be driven back
// while the others stand. So a branch that was filled in the wrong order is emptied, and filled anew from its
// end.
//
// There is no such plan where robots shut each other in, at the beginning or the end, or have no place to
// park.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "motion/joint_plan.h"
#include "motion/parking.h"
#include "planning/random.h"

namespace coppice {

class EvacuateAndReassemble {
 public:
  /// `field` outlives it. A robot that could not even reach its goal alone is stranded, and may stand
  /// anywhere.
  EvacuateAndReassemble(const ClearanceField& field, std::vector<JointTask> tasks, Random random);

  /// A bounded amount of work: about one robot's way. True once it has ended.
  bool step();
  /// None: there is no such plan, or it takes too long to find it.
  std::optional<JointPlan> take_plan() { return std::exchange(plan_, std::nullopt); }

 private:
  enum class Stage { from_the_beginning, from_the_end, between };

  bool somebody_has_no_room() const;
  void begin_attempt();
  void enter(Stage stage);
  bool go_on();
  void drive(std::size_t robot, const Path& way);
  bool make_room();
  void finish();

  std::vector<JointTask> tasks_;
  Lattices lattices_;
  std::vector<std::size_t> stranded_;
  Random random_;
  int attempts_ = 0;  ///< that have ended
  Stage stage_ = Stage::from_the_beginning;
  std::optional<Parking> parking_;
  std::vector<std::size_t> pending_;
  std::size_t next_ = 0;       ///< of those
  std::size_t in_vain_ = 0;    ///< of those, one after the other
  std::size_t detours_ = 0;    ///< between the places to park
  std::vector<Point2> first_;  ///< places to park, from the beginning
  std::vector<Move> moves_;
  std::vector<Move> back_;  ///< from the end, reversed
  bool done_ = false;
  std::optional<JointPlan> plan_;
};

}  // namespace coppice
