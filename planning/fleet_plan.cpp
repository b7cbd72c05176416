#include "planning/fleet_plan.h"

#include <algorithm>

#include "planning/path_shortening.h"
#include "planning/reachability.h"
#include "planning/step_length.h"

namespace coppice {

namespace {

using Planner = MaRrdtStar<ClearanceField>;

constexpr int iterations_between_questions = 256;
// A search that has not ended by then may have no end: worth the milliseconds of a flood fill a robot.
constexpr std::uint64_t doubt = 200'000;

double least_radius(std::span<const PlanningProblem> problems) {
  return std::ranges::min_element(problems, std::less{}, &PlanningProblem::radius)->radius;
}

/// Closes the groups whose goal provably cannot be reached.
void give_up_unreachable(Planner& planner, const ClearanceField& field,
                         std::span<const PlanningProblem> problems, FleetPlan& plan) {
  for (GroupIndex g = 0; g < problems.size(); ++g) {
    const PlanningProblem& p = problems[g];
    if (!planner.is_open(g) || !provably_unreachable(field, p.start, p.goal, p.radius)) continue;
    planner.close(g);
    plan.robots[g].reason = "no path: the goal cannot be reached from the start with this radius";
  }
}

void collect_edges(const Planner& planner, FleetPlan& plan) {
  const Trees<2>& trees = planner.trees();
  for (NodeId n = 0; n < trees.node_count(); ++n) {
    const Tree& tree = trees.tree(trees.tree_of(n));
    const int robot = tree.kind == TreeKind::root ? static_cast<int>(tree.group) : -1;
    trees.for_each_edge(n, [&](const auto& edge) {
      if (edge.to < n) {
        plan.edges.push_back(
            {trees.position(edge.to), trees.position(n), robot, tree.kind == TreeKind::active});
      }
    });
  }
}

}  // namespace

FleetPlan plan_fleet(const ClearanceField& field, std::span<const PlanningProblem> problems,
                     const FleetPlanSettings& settings, Random random, const std::function<bool()>& stop,
                     const std::function<void(std::size_t)>& on_solved) {
  FleetPlan plan;
  plan.robots.resize(problems.size());
  if (problems.empty()) return plan;
  const double epsilon =
      settings.epsilon > 0 ? settings.epsilon : suggested_epsilon(field, least_radius(problems));
  const std::size_t trees = settings.disjointed_trees > 0 ? settings.disjointed_trees
                                                          : std::max<std::size_t>(16, 2 * problems.size());
  Planner planner(field, {.epsilon = epsilon, .disjointed_trees = trees}, random);

  std::vector<bool> told(problems.size(), false);
  auto tell_of_solved = [&] {
    for (GroupIndex g = 0; g < problems.size(); ++g) {
      if (told[g] || !planner.solved(g)) continue;
      told[g] = true;
      on_solved(g);
    }
  };
  for (const PlanningProblem& p : problems) planner.add_group(p.start, p.goal, p.radius);
  tell_of_solved();
  std::size_t open = planner.open_groups();
  for (std::uint64_t i = 1; planner.step(); ++i) {
    if (planner.open_groups() != open) {
      open = planner.open_groups();
      tell_of_solved();
    }
    if (i == doubt) give_up_unreachable(planner, field, problems, plan);
    if (i % iterations_between_questions == 0 && stop()) break;
  }

  for (GroupIndex g = 0; g < problems.size(); ++g) {
    RobotPlan& robot = plan.robots[g];
    robot.path = shorten(field, planner.path(g), problems[g].radius);
    robot.counts = planner.group_counts(g);
    robot.grafted_trees = planner.grafted_trees(g);
    if (robot.path.empty() && robot.reason.empty()) robot.reason = "no path found before the time was over";
  }
  plan.disjointed = planner.disjointed_counts();
  plan.trees_frozen = static_cast<std::uint32_t>(planner.take_frozen().size());
  collect_edges(planner, plan);
  return plan;
}

}  // namespace coppice
