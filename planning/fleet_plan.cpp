#include "planning/fleet_plan.h"

#include <algorithm>
#include <limits>

#include "planning/reachability.h"
#include "planning/step_length.h"

namespace coppice {

namespace {

constexpr int iterations_a_search = 256;
// A search in which nobody has succeeded for so long may have no end: worth a flood fill for each robot,
// whose time is in proportion to the map.
constexpr std::uint64_t least_doubt = 200'000;
constexpr std::uint64_t cells_an_iteration = 8;
constexpr std::size_t no_robot = std::numeric_limits<std::size_t>::max();
const Path no_path{};

double chosen_epsilon(const ClearanceField& field, std::span<const PlanningProblem> problems,
                      const FleetPlanSettings& settings) {
  if (settings.epsilon > 0) return settings.epsilon;
  if (problems.empty()) return field.map().resolution;
  const auto least = std::ranges::min_element(problems, std::less{}, &PlanningProblem::radius);
  return suggested_epsilon(field, least->radius);
}

std::size_t chosen_trees(std::size_t robots, const FleetPlanSettings& settings) {
  return settings.disjointed_trees > 0 ? settings.disjointed_trees : std::max<std::size_t>(16, 2 * robots);
}

}  // namespace

FleetPlanner::FleetPlanner(const ClearanceField& field, std::span<const PlanningProblem> problems,
                           const FleetPlanSettings& settings, Random random)
    : field_(field),
      problems_(problems.begin(), problems.end()),
      epsilon_(chosen_epsilon(field, problems, settings)),
      random_(random),
      planner_(field, {.epsilon = epsilon_, .disjointed_trees = chosen_trees(problems.size(), settings)},
               random),
      unreachable_(problems.size(), false) {
  for (const PlanningProblem& p : problems_) planner_.add_group(p.start, p.goal, p.radius);
}

bool FleetPlanner::search() {
  const std::size_t open_before = planner_.open_groups();
  for (int i = 0; i < iterations_a_search; ++i) {
    if (!planner_.step()) return false;
  }
  fruitless_ = planner_.open_groups() < open_before ? 0 : fruitless_ + iterations_a_search;
  const std::uint64_t doubt =
      std::max<std::uint64_t>(least_doubt, field_.map().blocked.size() / cells_an_iteration);
  if (fruitless_ >= doubt && !std::exchange(doubted_, true)) give_up_unreachable();
  return planner_.open_groups() > 0;
}

/// Closes the groups whose goal provably cannot be reached.
void FleetPlanner::give_up_unreachable() {
  for (std::size_t i = 0; i < problems_.size(); ++i) {
    const PlanningProblem& p = problems_[i];
    const auto g = static_cast<GroupIndex>(i);
    if (!planner_.is_open(g) || !provably_unreachable(field_, p.start, p.goal, p.radius)) continue;
    planner_.close(g);
    unreachable_[i] = true;
  }
}

void FleetPlanner::take_first_paths() {
  improver_.emplace(field_, epsilon_, random_);
  std::vector<Path> paths = planner_.paths();
  for (std::size_t i = 0; i < problems_.size(); ++i) {
    const bool has_path = !paths[i].empty();
    robot_of_.push_back(has_path ? improver_->add_robot(std::move(paths[i]), problems_[i].radius) : no_robot);
  }
  const Trees<2>& trees = planner_.trees();
  for (NodeId n = 0; n < trees.node_count(); ++n)
    improver_->add_place(trees.position(n), trees.tree(trees.tree_of(n)).radius);
}

bool FleetPlanner::improve() {
  return improver_->step();
}

const Path& FleetPlanner::path(std::size_t robot) const {
  return robot_of_[robot] == no_robot ? no_path : improver_->path(robot_of_[robot]);
}

std::string FleetPlanner::reason(std::size_t robot) const {
  if (robot_of_[robot] != no_robot) return {};
  return unreachable_[robot] ? "no path: the goal cannot be reached from the start with this radius"
                             : "no path found before the time was over";
}

std::vector<FleetPlanner::Edge> FleetPlanner::edges() const {
  std::vector<Edge> edges;
  const Trees<2>& trees = planner_.trees();
  for (NodeId n = 0; n < trees.node_count(); ++n) {
    const Tree& tree = trees.tree(trees.tree_of(n));
    const int robot = tree.kind == TreeKind::root ? static_cast<int>(tree.group) : -1;
    trees.for_each_edge(n, [&](const auto& edge) {
      if (edge.to < n) edges.push_back({trees.position(edge.to), trees.position(n), robot});
    });
  }
  return edges;
}

}  // namespace coppice
