#include "planning/trees/fleet_plan.h"

#include <algorithm>

#include "planning/geometry/voronoi_roadmap.h"
#include "planning/trees/suggestions.h"

namespace coppice {

namespace {

constexpr int iterations_a_search = 256;
// Iterations without a newly solved robot after which some robots may have no path. Then a search of all
// passages is worth its time, which is proportional to the size of the map.
constexpr std::uint64_t least_iterations = 200'000;
constexpr std::uint64_t cells_an_iteration = 8;

}  // namespace

FleetPlanner::FleetPlanner(const ClearanceField& field, std::span<const PlanningProblem> problems,
                           const TreeParameters& trees, Random random)
    : field_(field), trees_(trees), random_(random) {
  begin_mission(problems);
}

void FleetPlanner::begin_mission(std::span<const PlanningProblem> problems) {
  robots_.clear();
  robots_.reserve(problems.size());
  if (planner_) first_group_ = static_cast<GroupIndex>(planner_->group_count());
  fruitless_ = 0;
  for (const PlanningProblem& p : problems) {
    Robot& robot = robots_.emplace_back();
    robot.problem = p;
    if (!planner_) {
      // No planner is built as long as straight lines are free.
      if (field_.segment_free(p.start, p.goal, p.radius)) continue;
      smallest_radius_ = std::ranges::min(problems, {}, &PlanningProblem::radius).radius;
      planner_.emplace(field_, completed(trees_, field_, smallest_radius_), random_);
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
  if (improver_) {
    improver_->forget_robots();
  } else {
    improver_.emplace(field_, suggested_epsilon(field_, smallest_radius_), random_);
  }
  std::vector<Path> paths = planner_->paths(first_group_);
  for (Robot& robot : robots_) {
    if (!robot.group) continue;
    Path& found = robot.through.empty() ? paths[*robot.group - first_group_] : robot.through;
    if (!found.empty()) robot.improved = improver_->add_robot(std::move(found), robot.problem.radius);
  }
  if (improver_->places() == 0) improver_->add_places(planner_->trees());
}

Path FleetPlanner::path(std::size_t robot) const {
  const Robot& r = robots_[robot];
  if (!r.group) return {r.problem.start, r.problem.goal};
  return r.improved ? improver_->path(*r.improved) : Path();
}

std::string FleetPlanner::reason(std::size_t robot) const {
  const Robot& r = robots_[robot];
  if (r.improved || !r.group) return {};
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
