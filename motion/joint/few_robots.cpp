#include "motion/joint/few_robots.h"

#include <algorithm>
#include <utility>

namespace coppice {

namespace {

constexpr std::size_t moves_a_step = 20'000;

}  // namespace

FewRobots::FewRobots(const ClearanceField& field, double radius, double spacing,
                     std::vector<JointTask> robots, std::vector<Disc> obstacles, std::vector<Point2> anchors)
    : field_(field),
      radius_(radius),
      spacing_(spacing),
      robots_(std::move(robots)),
      obstacles_(std::move(obstacles)),
      anchors_(std::move(anchors)) {
  std::ranges::reverse(anchors_);
}

void FewRobots::begin_at(const Point2& anchor) {
  packed_.emplace(field_, radius_, spacing_, anchor);
  std::vector<Point2> ends;
  const auto place_of = [&](const Point2& p) {
    const auto known = std::ranges::find(ends, p);
    const auto place = static_cast<Vertex>(packed_->size()) + static_cast<Vertex>(known - ends.begin());
    if (known == ends.end()) ends.push_back(p);
    return place;
  };
  std::vector<VertexTask> tasks;
  for (const JointTask& robot : robots_) {
    const Vertex start = place_of(robot.position);
    tasks.push_back({start, robot.goal ? std::optional(place_of(*robot.goal)) : std::nullopt});
  }
  graph_ = packed_->with(ends, obstacles_);
  if (JointAStar::fits(graph_.size(), tasks.size())) search_.emplace(graph_, std::move(tasks));
}

bool FewRobots::step() {
  if (!search_) {
    if (anchors_.empty()) return true;
    begin_at(anchors_.back());
    anchors_.pop_back();
    return false;
  }
  const JointAStar::Outcome outcome = search_->search(moves_a_step);
  if (outcome == JointAStar::Outcome::searching) return false;
  if (outcome == JointAStar::Outcome::solved) {
    moves_.emplace();
    for (const VertexMove& move : search_->moves())
      moves_->push_back({move.robot, graph_.edges(move.from)[move.edge].path});
    anchors_.clear();
  }
  search_.reset();
  return anchors_.empty();
}

}  // namespace coppice
