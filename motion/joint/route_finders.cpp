#include "motion/joint/route_finders.h"

#include <utility>

namespace coppice {

RouteFinder& RouteFinders::of(double radius) {
  const auto known = finders_.find(radius);
  if (known != finders_.end()) return known->second;
  return finders_.try_emplace(radius, field_, radius, share_ * usual_spacing(radius)).first->second;
}

void RouteFinders::refine(double share) {
  effort_before_ = effort();
  share_ = share;
  finders_.clear();
}

std::size_t RouteFinders::effort() const {
  std::size_t sum = effort_before_;
  for (const auto& [radius, finder] : finders_) sum += finder.effort();
  return sum;
}

std::vector<Path> ways_alone(const ClearanceField& field, std::span<const JointTask> tasks,
                             RouteFinders& finders) {
  std::vector<Disc> failed;
  for (const JointTask& task : tasks) {
    if (!task.movable) failed.push_back({task.position, task.radius});
  }
  std::vector<Path> ways(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const JointTask& task = tasks[i];
    if (!task.movable || !task.goal) continue;
    ways[i] = finders.of(task.radius).route(task.position, *task.goal, failed);
    if (!ways[i].empty()) continue;
    SpacedRoute finer =
        coarsest_route(field, task.radius, task.position, *task.goal, failed, finders.share() / 2);
    ways[i] = std::move(finer.path);
    if (!ways[i].empty()) finders.refine(finer.share);
  }
  return ways;
}

}  // namespace coppice
