#include "motion/crowd_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "motion/route_finder.h"
#include "motion/segments.h"

namespace coppice {

namespace {

constexpr std::size_t configurations_a_step = 1000;
// Spacing of the lattice on which roadmap vertices lie, in radii, at most.
constexpr double place_spacing = 0.2;
constexpr double clinch = 2.2;      // radii between the centres of robots in a clinch, at most
constexpr double step_aside = 0.5;  // radii from a robot in a clinch to the vertices that are added for it
constexpr int directions = 8;

double largest_radius(std::span<const JointTask> tasks) {
  double largest = 0;
  for (const JointTask& task : tasks) {
    if (task.movable) largest = std::max(largest, task.radius);
  }
  return largest;
}

}  // namespace

bool CrowdSearch::has_room(std::span<const JointTask> tasks, const ClearanceField& field) {
  const double radius = largest_radius(tasks);
  const double touching = 2 * radius + standing_gap;
  std::vector<JointTask> movable;
  std::ranges::copy_if(tasks, std::back_inserter(movable), &JointTask::movable);
  if (movable.empty()) return false;
  if (std::ranges::all_of(movable, [&](const JointTask& task) { return task.radius == radius; })) return true;
  const auto fits = [&](const Point2& p) { return field.is_free(p, radius); };
  return std::ranges::all_of(movable, [&](const JointTask& task) {
    return fits(task.position) && (!task.goal || fits(*task.goal)) &&
           std::ranges::none_of(movable, [&](const JointTask& other) {
             return &other != &task &&
                    ((other.position - task.position).norm() < touching ||
                     (other.goal && task.goal && (*other.goal - *task.goal).norm() < touching));
           });
  });
}

CrowdSearch::CrowdSearch(MapRoadmaps& places, std::span<const JointTask> tasks, Random random)
    : places_(places),
      tasks_(tasks),
      radius_(largest_radius(tasks)),
      spacing_(place_spacing * radius_),
      random_(random) {
  begin({});
}

void CrowdSearch::begin(std::span<const Point2> more) {
  ended_ = false;
  while (true) {
    lacam_.reset();
    roadmap_.emplace(packed(), tasks_, more);
    lacam_.emplace(roadmap_->graph, roadmap_->their_tasks, random_);
    const std::optional<double> finer = spacing_of_missed_way();
    if (!finer) return;
    lacam_.reset();
    if (*finer >= spacing_) return;
    spacing_ = *finer;
  }
}

/// The spacing at which a robot finds a way that it does not have on this roadmap. None: there is no such
/// robot.
std::optional<double> CrowdSearch::spacing_of_missed_way() {
  shut_in_.clear();
  const std::vector<Disc> obstacles = immovable(tasks_);
  for (const std::uint32_t k : lacam_->shut_in()) {
    const JointTask& task = tasks_[roadmap_->robots[k]];
    const SpacedRoute missed =
        coarsest_route(places_.field(), radius_, task.position, *task.goal, obstacles, 1);
    if (!missed.path.empty()) return missed.share * usual_spacing(radius_);
    shut_in_.push_back(roadmap_->robots[k]);
  }
  return std::nullopt;
}

Progress CrowdSearch::go_on(std::size_t most_configurations) {
  const Lacam::Outcome outcome = lacam_->search(configurations_a_step);
  configurations_ += configurations_a_step;
  if (outcome == Lacam::Outcome::solved) return best();
  ended_ = outcome != Lacam::Outcome::searching;
  if (ended_ || configurations_ >= most_configurations) return GivesUp{best()};
  return Searching();
}

void CrowdSearch::add_vertices() {
  std::vector<Point2> more = elbow_room();
  std::ranges::copy(packed().stacked(starts_under_way()), std::back_inserter(more));
  if (!more.empty()) begin(more);
}

/// The plan that leads to the configuration with the fewest robots away from their goals.
JointPlan CrowdSearch::best() const {
  JointPlan plan{.moves = roadmap_->paths_of(lacam_->moves()), .stranded = shut_in_};
  for (const std::uint32_t k : lacam_->left_over()) plan.stranded.push_back(roadmap_->robots[k]);
  return plan;
}

std::vector<Point2> CrowdSearch::starts_under_way() const {
  std::vector<Point2> starts;
  for (const std::uint32_t k : lacam_->under_way()) starts.push_back(tasks_[roadmap_->robots[k]].position);
  return starts;
}

bool CrowdSearch::in_a_clinch(const JointTask& task) const {
  const auto near = std::ranges::count_if(tasks_, [&](const JointTask& other) {
    return (other.position - task.position).norm() < clinch / 2 * (task.radius + other.radius);
  });
  return near > 1;  // greater than 1 because the robot itself is counted
}

/// Positions half a radius away from the starts of robots in a clinch that did not reach their goals.
std::vector<Point2> CrowdSearch::elbow_room() const {
  std::vector<Point2> result;
  for (const std::uint32_t k : lacam_->under_way()) {
    const JointTask& task = tasks_[roadmap_->robots[k]];
    if (!in_a_clinch(task)) continue;
    for (int direction = 0; direction < directions; ++direction) {
      const double angle = 2 * std::numbers::pi * direction / directions;
      const Point2 aside =
          task.position + step_aside * task.radius * Point2(std::cos(angle), std::sin(angle));
      if (places_.field().segment_free(task.position, aside, task.radius)) result.push_back(aside);
    }
  }
  return result;
}

}  // namespace coppice
