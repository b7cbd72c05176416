// A joint plan (joint_plan.h) that evacuates a cluster to parking positions, where no robot is in another's
// way (parking.h), and reassembles it at the goals.
//
// One robot after the other that has a way drives to a parking position. The planner does the same in thought
// from the final positions. The plan consists of the first evacuation, the moves from the first parking
// positions to the second ones, and the reverse of the second evacuation: a way may be driven back while the
// others stand. So a dead end that was filled in the wrong order is emptied and filled again, the deepest
// position first.
//
// There is no such plan where robots shut each other in, at the beginning or at the end, or have no position
// to park.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/joint/joint_plan.h"
#include "motion/joint/parking.h"

namespace coppice {

class EvacuateAndReassemble {
 public:
  /// `field` must outlive it. A robot that could not reach its goal even if it were alone is stranded, and
  /// may stand anywhere.
  EvacuateAndReassemble(const ClearanceField& field, std::vector<JointTask> tasks, Random random);

  /// Does a bounded amount of work, about one robot's way. Returns true once the search has ended.
  bool step();
  /// The joint plan; none if there is no such plan, or if the search takes too long.
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
  int attempts_ = 0;  ///< attempts that have ended
  Stage stage_ = Stage::from_the_beginning;
  std::optional<Parking> parking_;
  std::vector<std::size_t> pending_;
  std::size_t next_ = 0;       ///< index in `pending_`
  std::size_t in_vain_ = 0;    ///< consecutive robots of `pending_` without a way
  std::size_t detours_ = 0;    ///< moves aside between the parking positions
  std::vector<Point2> first_;  ///< parking positions, by robot, of the first evacuation
  std::vector<Move> moves_;
  std::vector<Move> back_;  ///< moves of the evacuation from the end, to be reversed
  bool done_ = false;
  std::optional<JointPlan> plan_;
};

}  // namespace coppice
