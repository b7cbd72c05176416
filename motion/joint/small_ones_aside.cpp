#include "motion/joint/small_ones_aside.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "motion/joint/joint_planner.h"
#include "motion/lattice/route_finder.h"
#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr std::size_t most_robots_in_parts = 16;
constexpr int draws_of_places = 2;  // attempts with the same small robots
constexpr int most_attempts = 8;
constexpr int candidates = 300;        // for a place aside
constexpr double worth_of_gap = 0.05;  // metres nearer to a wall, for a metre further from the large robots

}  // namespace

SmallOnesAside::SmallOnesAside(MapRoadmaps& places, std::vector<JointTask> tasks, Random random)
    : places_(places), tasks_(std::move(tasks)), random_(random) {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (tasks_[i].movable) by_size_.push_back(i);
  }
  std::ranges::stable_sort(by_size_, std::greater{}, [&](std::size_t i) { return tasks_[i].radius; });
}

SmallOnesAside::~SmallOnesAside() = default;

bool SmallOnesAside::may_help(std::span<const JointTask> tasks) {
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0;
  std::size_t robots = 0;
  for (const JointTask& task : tasks) {
    if (!task.movable) continue;
    ++robots;
    smallest = std::min(smallest, task.radius);
    largest = std::max(largest, task.radius);
  }
  return smallest < largest && robots <= most_robots_in_parts;
}

/// A robot could not reach its goal even if it were alone.
bool SmallOnesAside::is_in_vain() const {
  std::vector<Disc> failed;
  for (const JointTask& task : tasks_) {
    if (!task.movable) failed.push_back({task.position, task.radius});
  }
  return std::ranges::any_of(tasks_, [&](const JointTask& task) {
    return wants_to_move(task) &&
           coarsest_route(places_.field(), task.radius, task.position, *task.goal, failed, 1).path.empty();
  });
}

bool SmallOnesAside::step() {
  if (attempt_ == 0 && is_in_vain()) return true;
  if (!planner_) return !begin_attempt();
  if (!planner_->step()) return false;
  JointPlan plan = std::exchange(planner_, nullptr)->take_plan();
  if (!plan.stranded.empty()) return false;
  for (Move& move : plan.moves) {
    at_[move.robot] = move.path.back();
    moves_.push_back(std::move(move));
  }
  if (part_ == Part::back) {
    plan_ = JointPlan{.moves = std::move(moves_), .stranded = {}};
    return true;
  }
  begin(part_ == Part::aside ? Part::large : Part::back);
  return false;
}

/// False: all attempts were made.
bool SmallOnesAside::begin_attempt() {
  const auto small = static_cast<std::size_t>(1 + attempt_ / draws_of_places);
  if (attempt_ == most_attempts || small >= by_size_.size()) return false;
  ++attempt_;
  moves_.clear();
  at_.clear();
  for (const JointTask& task : tasks_) at_.push_back(task.position);
  aside_.assign(tasks_.size(), std::nullopt);
  for (const std::size_t robot : std::span(by_size_).last(small)) aside_[robot] = at_[robot];
  for (const std::size_t robot : std::span(by_size_).last(small)) {
    aside_[robot] = place_aside(robot);
    if (!aside_[robot]) return true;
  }
  begin(Part::aside);
  return true;
}

/// The best of some random places. None: no robot of this size has room there.
std::optional<Point2> SmallOnesAside::place_aside(std::size_t robot) {
  const ClearanceField& field = places_.field();
  const Box<2> box = field.bounds();
  const double radius = tasks_[robot].radius;
  /// Metres to where another robot stands or goes.
  const auto gap = [&](const Point2& p) {
    double least = std::numeric_limits<double>::infinity();
    const auto count = [&](const Point2& other, double others_radius) {
      least = std::min(least, (other - p).norm() - others_radius - radius);
    };
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (i == robot) continue;
      count(aside_[i].value_or(tasks_[i].position), tasks_[i].radius);
      if (!aside_[i] && tasks_[i].goal) count(*tasks_[i].goal, tasks_[i].radius);
    }
    return least;
  };
  std::optional<Point2> best;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < candidates; ++k) {
    const Point2 p(random_.uniform(box.lower.x(), box.upper.x()),
                   random_.uniform(box.lower.y(), box.upper.y()));
    if (!field.is_free(p, radius)) continue;
    const double room = gap(p);
    const double cost = field.clearance(p) - radius - worth_of_gap * room;
    if (room < standing_gap || cost >= least) continue;
    least = cost;
    best = p;
  }
  return best;
}

void SmallOnesAside::begin(Part part) {
  part_ = part;
  std::vector<JointTask> tasks;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    JointTask task = tasks_[i];
    task.position = at_[i];
    if (part == Part::aside && aside_[i]) task.goal = *aside_[i];
    task.movable = task.movable && aside_[i].has_value() == (part != Part::large);
    if (!task.movable) task.goal.reset();
    tasks.push_back(std::move(task));
  }
  planner_ = std::make_unique<JointPlanner>(places_, std::move(tasks), Random(random_.next()),
                                            JointPlanner::Methods::for_a_part);
}

}  // namespace coppice
