// A joint plan (joint_plan.h) for robots of unlike sizes, in three parts: the small ones drive aside, the
// large ones drive to their goals, and the small ones drive to theirs.
//
// A large robot has few ways past others, and a small one that stands in the last of them closes it. Aside, a
// small robot stands close to a wall, and clear of where the large ones stand and go. Each part is a joint
// plan of fewer robots, among others that stand. First the smallest robot alone counts as small, then the two
// smallest, and so on. The places aside are drawn at random, and drawn anew when a part strands a robot.
//
// There is no such plan where a robot cannot reach its goal, or the small ones have no place aside.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/joint/joint_plan.h"
#include "motion/lattice/packed_roadmap.h"

namespace coppice {

class JointPlanner;

class SmallOnesAside {
 public:
  /// `places` and its field must outlive it.
  SmallOnesAside(MapRoadmaps& places, std::vector<JointTask> tasks, Random random);
  ~SmallOnesAside();

  /// For a few robots that are not all alike.
  static bool may_help(std::span<const JointTask> tasks);

  /// Does a bounded amount of work. Returns true once the search has ended.
  bool step();
  /// The joint plan, which strands nobody; none: none was found.
  std::optional<JointPlan> take_plan() { return std::exchange(plan_, std::nullopt); }

 private:
  enum class Part { aside, large, back };

  bool is_in_vain() const;
  bool begin_attempt();
  std::optional<Point2> place_aside(std::size_t robot);
  void begin(Part part);

  MapRoadmaps& places_;
  std::vector<JointTask> tasks_;
  Random random_;
  std::vector<std::size_t> by_size_;  ///< those that may move, the largest first
  int attempt_ = 0;
  std::vector<std::optional<Point2>> aside_{};  ///< by robot; none: it is a large one
  std::vector<Point2> at_{};                    ///< by robot: where it is after the parts so far
  Part part_ = Part::aside;
  std::unique_ptr<JointPlanner> planner_;  ///< of the part; null: an attempt is to begin
  std::vector<Move> moves_{};              ///< of the parts so far
  std::optional<JointPlan> plan_{};
};

}  // namespace coppice
