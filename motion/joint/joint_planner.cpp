#include "motion/joint/joint_planner.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "motion/joint/straightening.h"

namespace coppice {

namespace {

constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();
constexpr int to_its_end = std::numeric_limits<int>::max();
constexpr double as_the_largest = std::numeric_limits<double>::infinity();
constexpr double few_sizes = 1.2;

using Search = JointPlanner::Search;
constexpr auto lacam = [](Search& search, Cluster& cluster, Random random) {
  search.emplace<Lacam>(cluster, random);
};
constexpr auto a_star = [](Search& search, Cluster& cluster, Random) { search.emplace<JointAStar>(cluster); };
constexpr auto evacuation = [](Search& search, Cluster& cluster, Random random) {
  search.emplace<Evacuation>(cluster, random);
};

}  // namespace

std::span<const JointPlanner::Strategy> JointPlanner::strategies() {
  using enum ClusterRoadmap::Vertices;
  using R = ClusterRoadmap::Choice;
  // A step of LaCAM makes 1,000 configurations. Successful searches hardly ever need more than 5.
  static constexpr std::array<Strategy, 6> all{{
      {"LaCAM", "most clusters", any_number, 5, R{packed, as_the_largest}, lacam},
      {"weighted A*", "four robots or fewer in narrow passages", 4, to_its_end, R{from_an_end, few_sizes},
       a_star},
      {"LaCAM on more vertices", "robots in a clinch, and short branches of passages", any_number, 5,
       R{packed_and_more, few_sizes}, lacam},
      {"evacuation", "dead ends that are filled in the wrong order", any_number, to_its_end,
       R{packed_and_more, as_the_largest}, evacuation},
      {"evacuation by size", "the same, where small robots have less room than the largest", any_number,
       to_its_end, R{packed_and_more, few_sizes}, evacuation, true},
      {"LaCAM for long", "clusters in which robots shut each other in", any_number, 90,
       R{packed_and_more, few_sizes}, lacam},
  }};
  return all;
}

JointPlanner::JointPlanner(MapRoadmaps& roadmaps, std::vector<JointTask> tasks, Random random)
    : roadmaps_(roadmaps), tasks_(std::move(tasks)), random_(random) {}

std::optional<JointPlan> JointPlanner::step() {
  if (std::ranges::none_of(tasks_, &JointTask::movable)) return JointPlan();
  if (!roadmap_) begin();
  const SearchState progress = std::visit([](auto& search) { return search.step(); }, search_);
  if (progress == SearchState::solved) return completed(plan());
  if (progress == SearchState::searching && ++steps_ < strategy().most_steps) return std::nullopt;
  give_up();
  if (!begin_next()) return completed(*std::move(best_));
  return std::nullopt;
}

/// The moves of the search. Robots that are shut in are stranded, too.
JointPlan JointPlanner::plan() const {
  JointPlan plan = roadmap_->plan_of(std::visit([](const auto& search) { return search.moves(); }, search_));
  plan.stranded.insert(plan.stranded.end(), shut_in_.begin(), shut_in_.end());
  return plan;
}

/// Begins the present strategy.
void JointPlanner::begin() {
  ClusterRoadmap::Choice choice = strategy().roadmap;
  choice.end = end_;
  roadmap_ = std::make_unique<ClusterRoadmap>(roadmaps_, tasks_, stuck_, choice);
  for (const std::uint32_t k : roadmap_->cluster().shut_in()) {
    shut_in_.push_back(roadmap_->task_of(k));
    tasks_[shut_in_.back()].goal.reset();
  }
  strategy().begin(search_, roadmap_->cluster(), random_);
  steps_ = 0;
}

/// Keeps what later strategies can use.
void JointPlanner::give_up() {
  auto* const lacam = std::get_if<Lacam>(&search_);
  if (lacam == nullptr) return;
  stuck_.clear();
  for (const std::uint32_t k : lacam->under_way()) stuck_.push_back(roadmap_->task_of(k));
  JointPlan found = plan();
  if (!best_ || found.stranded.size() < best_->stranded.size()) best_ = std::move(found);
}

/// Goes on to the next end from which to pack, or to the next strategy. False: there is none.
bool JointPlanner::begin_next() {
  const std::size_t ends = roadmap_->ends();
  search_.emplace<Ends>();
  roadmap_.reset();
  if (++end_ < ends) return true;
  end_ = 0;
  do {
    if (strategy_ + 1 == strategies().size()) return false;
    ++strategy_;
  } while (!applies());
  return true;
}

/// Whether the present strategy is for these robots.
bool JointPlanner::applies() const {
  std::vector<double> radii;
  for (const JointTask& task : tasks_) {
    if (task.movable) radii.push_back(task.radius);
  }
  const auto [least, most] = std::ranges::minmax(radii);
  return radii.size() <= strategy().most_robots && (!strategy().several_sizes || least < most);
}

JointPlan JointPlanner::completed(JointPlan plan) {
  search_.emplace<Ends>();
  roadmap_.reset();  // frees megabytes for hundreds of robots, because straightening needs memory too
  plan.moves = straightened(roadmaps_.field(), tasks_, std::exchange(plan.moves, {}));
  return plan;
}

JointPlan joint_plan(MapRoadmaps& roadmaps, std::vector<JointTask> tasks, Random random) {
  JointPlanner planner(roadmaps, std::move(tasks), random);
  while (true) {
    if (auto plan = planner.step()) return *std::move(plan);
  }
}

}  // namespace coppice
