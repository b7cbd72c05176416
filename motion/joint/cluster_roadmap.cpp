#include "motion/joint/cluster_roadmap.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include "motion/lattice/route_finder.h"
#include "motion/trajectory/segments.h"
#include "motion/trajectory/space_time.h"

namespace coppice {

namespace {

constexpr double place_spacing = 0.2;  // radii, of the lattice on which vertices lie, at most
constexpr double step_aside = 0.5;     // radii from a robot in a clinch to the vertices that are added for it
constexpr int directions = 8;
constexpr std::size_t most_ends = 8;
constexpr std::size_t vertices_of_ends = 1'000'000;  // over the lattices of all ends; takes about 1 s

/// The corners of a path, and points between them at most `spacing` apart, without its ends.
Path points_along(const Path& path, double spacing) {
  Path points;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double parts = std::ceil((path[k] - path[k - 1]).norm() / spacing);
    for (double part = 1; part < parts; ++part)
      points.push_back(path[k - 1] + (path[k] - path[k - 1]) * (part / parts));
    if (k + 1 < path.size()) points.push_back(path[k]);
  }
  return points;
}

Vertex position_of(std::vector<Point2>& points, const Point2& p) {
  const auto known = std::ranges::find(points, p) - points.begin();
  if (std::cmp_equal(known, points.size())) points.push_back(p);
  return static_cast<Vertex>(known);
}

}  // namespace

ClusterRoadmap::ClusterRoadmap(MapRoadmaps& roadmaps, std::span<const JointTask> tasks,
                               std::span<const std::size_t> stuck, const Choice& choice)
    : roadmaps_(roadmaps),
      tasks_(tasks),
      stuck_(stuck.begin(), stuck.end()),
      choice_(choice),
      missed_(tasks.size()) {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    radii_.push_back(tasks_[i].radius);
    if (tasks_[i].movable) robots_.push_back(i);
  }
  choose_radii(choice_.most_growth);
  build();
  while (mend_what_is_missed()) build();
}

/// Whether a robot would have room at its position and its goal if it were so large.
bool ClusterRoadmap::fits(std::size_t robot, double radius) const {
  const JointTask& task = tasks_[robot];
  const auto fits_at = [&](const Point2& p) { return roadmaps_.field().is_free(p, radius); };
  return fits_at(task.position) && (!task.goal || fits_at(*task.goal)) &&
         std::ranges::all_of(robots_, [&](std::size_t i) {
           const JointTask& other = tasks_[i];
           const double touching = radius + radii_[i] + standing_gap;
           return i == robot ||
                  ((other.position - task.position).norm() >= touching &&
                   (!other.goal || !task.goal || (*other.goal - *task.goal).norm() >= touching));
         });
}

/// The largest robots first: each of the others counts as large as one of them if it has room for that.
void ClusterRoadmap::choose_radii(double most_growth) {
  std::vector<std::size_t> by_size = robots_;
  std::ranges::stable_sort(by_size, std::greater{}, [&](std::size_t i) { return tasks_[i].radius; });
  std::set<double, std::greater<>> sizes;
  for (const std::size_t i : by_size) {
    const double radius = tasks_[i].radius;
    const auto size = std::ranges::find_if(sizes, [&](double larger) {
      return larger == radius || (larger <= most_growth * radius && fits(i, larger));
    });
    if (size != sizes.end()) radii_[i] = *size;
    sizes.insert(radii_[i]);
  }
}

void ClusterRoadmap::build() {
  cluster_.reset();
  Points points;
  std::vector<VertexTask> tasks;  // with the numbers of the points
  for (const std::size_t i : robots_) {
    std::vector<Point2>& ends = points[radii_[i]];
    const Vertex start = position_of(ends, tasks_[i].position);
    tasks.push_back(
        {start, tasks_[i].goal ? std::optional(position_of(ends, *tasks_[i].goal)) : std::nullopt});
  }
  for (const std::size_t i : robots_) {
    for (const Point2& p : missed_[i]) position_of(points[radii_[i]], p);
  }
  const std::vector<Disc> obstacles = immovable(tasks_);
  std::vector<AnnotatedRoadmap> parts;
  std::map<double, Vertex> first;  // number of the first point, by radius
  Vertex size = 0;
  for (auto& [radius, of_size] : points) {
    if (choice_.vertices == Vertices::packed_and_more) add_stuck_points(radius, of_size);
    PackedRoadmap& roadmap = packed(radius);
    first[radius] = size + static_cast<Vertex>(roadmap.size());
    parts.push_back(roadmap.with(of_size, obstacles));
    size += static_cast<Vertex>(parts.back().size());
  }
  graph_ = parts.size() == 1 ? std::move(parts.front()) : united(parts, roadmaps_.field().bounds());
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    const Vertex offset = first.at(radii_[robots_[k]]);
    tasks[k].start += offset;
    if (tasks[k].goal) *tasks[k].goal += offset;
  }
  cluster_.emplace(graph_, std::move(tasks));
}

/// Whether a robot has a way that it does not have on this roadmap. Then the robot counts as large as it is,
/// or there are to be vertices along that way.
bool ClusterRoadmap::mend_what_is_missed() {
  bool mended = false;
  for (const std::uint32_t k : cluster_->shut_in()) {
    const std::size_t i = robots_[k];
    const JointTask& task = tasks_[i];
    if (radii_[i] != task.radius) {
      radii_[i] = task.radius;
      mended = true;
    } else if (missed_[i].empty()) {
      const Path route =
          coarsest_route(roadmaps_.field(), task.radius, task.position, *task.goal, immovable(tasks_));
      missed_[i] = points_along(route, 2 * task.radius + standing_gap);
      mended = mended || !missed_[i].empty();
    }
  }
  return mended;
}

/// The roadmap for robots of a radius.
PackedRoadmap& ClusterRoadmap::packed(double radius) {
  const double spacing = place_spacing * radius;
  if (choice_.vertices != Vertices::from_an_end) return roadmaps_.packed(radius, spacing);
  const auto known = from_an_end_.find(radius);
  if (known != from_an_end_.end()) return known->second;
  std::vector<Point2> centres;
  for (const std::size_t i : stuck_) centres.push_back(tasks_[i].position);
  PackedRoadmap& usual = roadmaps_.packed(radius, spacing);
  std::vector<Point2> ends = usual.ends(centres);
  ends.resize(
      std::min(ends.size(), std::clamp<std::size_t>(vertices_of_ends / usual.lattice_size(), 1, most_ends)));
  ends_ = std::max(ends_, ends.size());
  const std::optional<Point2> end =
      ends.empty() ? std::nullopt : std::optional(ends[std::min(choice_.end, ends.size() - 1)]);
  return from_an_end_.try_emplace(radius, roadmaps_.field(), radius, spacing, end).first->second;
}

/// Adds vertices for the robots that are stuck, and have this size.
void ClusterRoadmap::add_stuck_points(double radius, std::vector<Point2>& points) {
  std::vector<Point2> centres;
  for (const std::size_t i : stuck_) {
    const JointTask& task = tasks_[i];
    if (radii_[i] != radius) continue;
    centres.push_back(task.position);
    for (int direction = 0; in_a_clinch(task) && direction < directions; ++direction) {
      const double angle = 2 * std::numbers::pi * direction / directions;
      const Point2 aside = task.position + step_aside * radius * Point2(std::cos(angle), std::sin(angle));
      if (roadmaps_.field().segment_free(task.position, aside, radius)) position_of(points, aside);
    }
  }
  for (const Point2& p : packed(radius).stacked(centres)) position_of(points, p);
}

/// Another robot is closer than trajectories keep apart.
bool ClusterRoadmap::in_a_clinch(const JointTask& task) const {
  const auto near = std::ranges::count_if(tasks_, [&](const JointTask& other) {
    return (other.position - task.position).norm() < kept_apart(task.radius, other.radius);
  });
  return near > 1;  // greater than 1 because the robot itself is counted
}

JointPlan ClusterRoadmap::plan_of(std::span<const VertexMove> moves) const {
  JointPlan plan;
  std::vector<Point2> at;
  for (const JointTask& task : tasks_) at.push_back(task.position);
  for (const VertexMove& move : moves) {
    const std::size_t robot = robots_[move.robot];
    plan.moves.push_back({robot, graph_.edges(move.from)[move.edge].path});
    at[robot] = plan.moves.back().path.back();
  }
  for (const std::size_t i : robots_) {
    if (tasks_[i].goal.value_or(at[i]) != at[i]) plan.stranded.push_back(i);
  }
  return plan;
}

}  // namespace coppice
