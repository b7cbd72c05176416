// Looks for a joint plan (joint_plan.h) by several strategies, one after the other:
// JointPlanner::strategies(). The first plan that strands no robot without need is taken. Otherwise the plan
// is taken that brought the most robots to their goals; the others ask again from where they stand then.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/crowd_search.h"
#include "motion/evacuate_and_reassemble.h"
#include "motion/few_robots.h"
#include "motion/joint_plan.h"
#include "motion/packed_roadmap.h"
#include "motion/push_and_rotate.h"
#include "motion/small_ones_aside.h"

namespace coppice {

class JointPlanner {
 public:
  struct Strategy {
    std::string_view name;
    std::string_view serves;  ///< what it is for
    /// Begins it, with a bound on its effort. False: it does not apply.
    bool (JointPlanner::*begin)();
  };
  /// In the order in which they are tried. The last one always applies, and has a plan.
  static std::span<const Strategy> strategies();

  /// A part of a plan is not planned in parts again.
  enum class Methods { all, for_a_part };

  /// `places` and its field must outlive it. A robot that could not reach its goal even if it were alone is
  /// stranded from the start.
  JointPlanner(MapRoadmaps& places, std::vector<JointTask> tasks, Random random,
               Methods methods = Methods::all);
  JointPlanner(const JointPlanner&) = delete;  // its searches refer to its tasks
  JointPlanner& operator=(const JointPlanner&) = delete;
  ~JointPlanner() = default;

  /// Does a bounded amount of work. Returns the plan once it is complete: then this must not be called again.
  std::optional<JointPlan> step();
  /// The strategy that is being tried, or that has found the plan.
  const Strategy& strategy() const { return strategies()[next_ - 1]; }

 private:
  struct BestSoFar {
    JointPlan plan;
    Progress step() { return std::move(plan); }
  };
  struct GoesOn {  ///< a search that several strategies continue
    CrowdSearch& crowd;
    std::size_t most_configurations;
    Progress step() { return crowd.go_on(most_configurations); }
  };

  void begin_next();
  JointPlan completed(JointPlan plan);
  bool begin_crowd();
  bool begin_few();
  bool begin_crowd_with_more_vertices();
  bool begin_evacuation();
  bool begin_crowd_for_long();
  bool begin_push_and_rotate();
  bool begin_small_ones_aside();
  bool begin_evacuation_at_last();
  bool take_best();
  bool is_better(const JointPlan& plan) const;

  MapRoadmaps& places_;
  std::vector<JointTask> tasks_;
  Random random_;
  Methods methods_;
  std::size_t next_ = 0;                ///< of the strategies
  std::optional<CrowdSearch> crowd_{};  ///< none: the robots have no room as the largest
  std::optional<JointPlan> best_{};     ///< of the strategies that gave up
  std::variant<BestSoFar, GoesOn, FewRobots, EvacuateAndReassemble, PushAndRotate, SmallOnesAside> search_{};
};

/// The whole plan at once.
JointPlan joint_plan(MapRoadmaps& places, std::vector<JointTask> tasks, Random random);

}  // namespace coppice
