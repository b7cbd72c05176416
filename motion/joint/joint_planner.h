// Looks for a joint plan (joint_plan.h) by several strategies, one after the other:
// JointPlanner::strategies(). Each is a search on a roadmap of the cluster (cluster_roadmap.h). The first
// plan that brings all robots to their goals is taken. If there is none, the plan is taken that brings the
// most robots there; the others ask again from where they stand then.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/joint/cluster_roadmap.h"
#include "motion/joint/evacuation.h"
#include "motion/joint/joint_a_star.h"
#include "motion/joint/joint_plan.h"
#include "motion/joint/lacam.h"
#include "motion/lattice/packed_roadmap.h"

namespace coppice {

class JointPlanner {
 public:
  struct Ends {  ///< no search
    SearchState step() const { return SearchState::gave_up; }
    std::vector<VertexMove> moves() const { return {}; }
  };
  using Search = std::variant<Ends, Lacam, JointAStar, Evacuation>;
  struct Strategy {
    std::string_view name;
    std::string_view serves;  ///< what it is for
    std::size_t most_robots;
    int most_steps;  ///< of the search
    ClusterRoadmap::Choice roadmap;
    void (*begin)(Search&, Cluster&, Random);
    bool several_sizes = false;  ///< only for robots that are not all as large
  };
  /// In the order in which they are tried.
  static std::span<const Strategy> strategies();

  /// `roadmaps` and its field must outlive it. A robot that could not reach its goal even if it were alone is
  /// stranded from the start, and gives way.
  JointPlanner(MapRoadmaps& roadmaps, std::vector<JointTask> tasks, Random random);
  JointPlanner(const JointPlanner&) = delete;  // its roadmap refers to its tasks
  JointPlanner& operator=(const JointPlanner&) = delete;
  ~JointPlanner() = default;

  /// Does a bounded amount of work. Returns the plan once it is complete: then this must not be called again.
  std::optional<JointPlan> step();
  /// The strategy that is being tried, or that has found the plan.
  const Strategy& strategy() const { return strategies()[strategy_]; }

 private:
  bool begin_next();
  bool applies() const;
  void begin();
  void give_up();
  JointPlan plan() const;
  JointPlan completed(JointPlan plan);

  MapRoadmaps& roadmaps_;
  std::vector<JointTask> tasks_;
  Random random_;
  std::size_t strategy_ = 0;
  std::size_t end_ = 0;                        ///< from which the roadmap is packed
  int steps_ = 0;                              ///< of the search
  std::unique_ptr<ClusterRoadmap> roadmap_{};  ///< null: the strategy is to begin
  Search search_{};
  std::vector<std::size_t> shut_in_{};  ///< robots that could not reach their goals even if they were alone
  std::vector<std::size_t> stuck_{};    ///< robots that LaCAM has not brought to their goals
  std::optional<JointPlan> best_{};     ///< of the strategies that gave up
};

/// The whole plan at once.
JointPlan joint_plan(MapRoadmaps& roadmaps, std::vector<JointTask> tasks, Random random);

}  // namespace coppice
