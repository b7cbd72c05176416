#include "planning/fleet_plan.h"

#include <algorithm>

#include "planning/suggestions.h"
#include "planning/voronoi_roadmap.h"

namespace coppice {

namespace {

constexpr int iterations_a_search = 256;
// Iterations without a newly solved robot after which some robots may have no path. Then a search of all
// passages is worth its time, which is proportional to the size of the map.
constexpr std::uint64_t least_iterations = 200'000;
constexpr std::uint64_t cells_an_iteration = 8;

}  // namespace

FleetPlanner::FleetPlanner(const ClearanceField& field, std::span<const PlanningProblem> problems,
                           Random random)
    : field_(field), random_(random) {
  robots_.reserve(problems.size());
  for (const PlanningProblem& p : problems) {
    Robot& robot = robots_.emplace_back();
    robot.problem = p;
    if (!planner_) {
      // No planner is built as long as straight lines are free.
      if (field.segment_free(p.start, p.goal, p.radius)) {
        robot.straight = {p.start, p.goal};
        continue;
      }
      epsilon_ = suggested_epsilon(field, std::ranges::min(problems, {}, &PlanningProblem::radius).radius);
      const std::size_t trees = suggested_trees(field, epsilon_);
      planner_.emplace(field, MaRrdtStarSettings{.epsilon = epsilon_, .disjointed_trees = trees}, random);
    }
    robot.group = planner_->add_group(p.start, p.goal, p.radius);
  }
}

bool FleetPlanner::solved(std::size_t robot) const {
  const Robot& r = robots_[robot];
  return !r.group || !r.through.empty() || planner_->solved(*r.group);
}

bool FleetPlanner::search() {
  if (!planner_) return false;
  const std::size_t open_before = planner_->open_groups();
  for (int i = 0; i < iterations_a_search; ++i) {
    if (!planner_->step()) return false;
  }
  fruitless_ = planner_->open_groups() < open_before ? 0 : fruitless_ + iterations_a_search;
  const std::uint64_t doubt =
      std::max<std::uint64_t>(least_iterations, field_.frame().cells() / cells_an_iteration);
  if (fruitless_ >= doubt) settle_by_roadmap();
  return planner_->open_groups() > 0;
}

/// Closes the open groups: each has a way through a narrow passage, or none at all.
void FleetPlanner::settle_by_roadmap() {
  const VoronoiRoadmap roadmap(field_);
  for (Robot& robot : robots_) {
    const PlanningProblem& p = robot.problem;
    if (!robot.group || !planner_->is_open(*robot.group)) continue;
    planner_->close(*robot.group);
    if (auto way = roadmap.way(p.start, p.goal, p.radius)) {
      robot.through = std::move(*way);
    } else {
      robot.unreachable = true;
    }
  }
}

void FleetPlanner::take_first_paths() {
  if (!planner_) return;
  improver_.emplace(field_, epsilon_, random_);
  std::vector<Path> paths = planner_->paths();
  for (Robot& robot : robots_) {
    if (!robot.group) continue;
    Path& found = robot.through.empty() ? paths[*robot.group] : robot.through;
    if (!found.empty()) robot.improved = improver_->add_robot(std::move(found), robot.problem.radius);
  }
  improver_->add_places(planner_->trees());
}

const Path& FleetPlanner::path(std::size_t robot) const {
  const Robot& r = robots_[robot];
  return r.improved ? improver_->path(*r.improved) : r.straight;
}

std::string FleetPlanner::reason(std::size_t robot) const {
  const Robot& r = robots_[robot];
  if (r.improved || !r.straight.empty()) return {};
  return r.unreachable ? "no path: the goal cannot be reached from the start with this radius"
                       : "no path found before the time was over";
}

SampleCounts FleetPlanner::counts(std::size_t robot) const {
  const auto& group = robots_[robot].group;
  return group ? planner_->group_counts(*group) : SampleCounts{};
}

std::uint32_t FleetPlanner::grafted_trees(std::size_t robot) const {
  const auto& group = robots_[robot].group;
  return group ? planner_->grafted_trees(*group) : 0;
}

std::vector<TreeEdge> FleetPlanner::edges() const {
  std::vector<TreeEdge> edges;
  if (!planner_) return edges;
  std::vector<int> robot_of;  // by group
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (robots_[i].group) robot_of.push_back(static_cast<int>(i));
  }
  const Trees<2>& trees = planner_->trees();
  for (NodeId n = 0; n < trees.node_count(); ++n) {
    const Tree& tree = trees.tree(trees.tree_of(n));
    const int robot = tree.kind == TreeKind::root ? robot_of[tree.group] : -1;
    trees.for_each_edge(n, [&](const auto& edge) {
      if (edge.to < n) edges.push_back({trees.position(edge.to), trees.position(n), robot});
    });
  }
  return edges;
}

}  // namespace coppice
