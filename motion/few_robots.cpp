#include "motion/few_robots.h"

#include <algorithm>
#include <utility>

namespace coppice {

namespace {

constexpr std::ptrdiff_t most_robots = 4;
constexpr std::size_t moves_a_step = 20'000;
constexpr std::size_t most_anchors = 8;
constexpr std::size_t vertices_of_anchors = 1'000'000;  // over the lattices of all anchors; takes about 1 s

}  // namespace

bool FewRobots::are_few(std::span<const JointTask> tasks) {
  return std::ranges::count_if(tasks, &JointTask::movable) <= most_robots;
}

FewRobots::FewRobots(MapRoadmaps& places, double radius, double spacing, std::vector<JointTask> tasks,
                     std::vector<std::size_t> shut_in, std::span<const Point2> centres)
    : field_(places.field()),
      radius_(radius),
      spacing_(spacing),
      tasks_(std::move(tasks)),
      shut_in_(std::move(shut_in)) {
  for (const std::size_t i : shut_in_) tasks_[i].goal.reset();
  const PackedRoadmap& packed = places.packed(radius, spacing);
  anchors_ = packed.ends(centres);
  const std::size_t most =
      std::clamp<std::size_t>(vertices_of_anchors / packed.lattice_size(), 1, most_anchors);
  anchors_.resize(std::min(anchors_.size(), most));
  std::ranges::reverse(anchors_);
}

void FewRobots::begin_at(const Point2& anchor) {
  packed_.emplace(field_, radius_, spacing_, anchor);
  roadmap_.emplace(*packed_, tasks_, std::span<const Point2>());
  if (JointAStar::fits(roadmap_->graph.size(), roadmap_->their_tasks.size()))
    search_.emplace(roadmap_->graph, roadmap_->their_tasks);
}

Progress FewRobots::step() {
  if (!search_) {
    if (anchors_.empty()) return GivesUp();
    begin_at(anchors_.back());
    anchors_.pop_back();
    return Searching();
  }
  const JointAStar::Outcome outcome = search_->search(moves_a_step);
  if (outcome == JointAStar::Outcome::searching) return Searching();
  if (outcome == JointAStar::Outcome::solved)
    return JointPlan{roadmap_->paths_of(search_->moves()), std::move(shut_in_)};
  search_.reset();
  if (anchors_.empty()) return GivesUp();
  return Searching();
}

}  // namespace coppice
