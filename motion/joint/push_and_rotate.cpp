#include "motion/joint/push_and_rotate.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "planning/shuffle.h"

namespace coppice {

namespace {

constexpr int most_attempts = 12;
constexpr int attempts_at_a_spacing = 4;  // after so many attempts, the lattice becomes finer
// Moves per robot in one attempt, on average; beyond, the attempt runs in circles.
constexpr std::size_t moves_a_robot = 8;
constexpr int most_depth = 12;      // robots that wait for each other to clear a way
constexpr double elbow_room = 2.5;  // radii between two robots that are not in each other's way
constexpr std::size_t most_routes_a_step = 24;
constexpr std::size_t most_effort = 40'000'000;  // lattice vertices examined or marked: a few seconds

}  // namespace

PushAndRotate::PushAndRotate(const ClearanceField& field, std::vector<JointTask> tasks, Random random)
    : tasks_(std::move(tasks)), random_(random), finders_(field) {
  direct_ = ways_alone(field, tasks_, finders_);
  begin_attempt();
}

void PushAndRotate::begin_attempt() {
  at_.clear();
  for (const JointTask& task : tasks_) at_.push_back(task.position);
  stood_.assign(tasks_.size(), {});
  moves_.clear();
  tried_.assign(tasks_.size(), false);
  priority_.resize(tasks_.size());
  std::iota(priority_.begin(), priority_.end(), std::size_t{0});
  if (attempts_ == 0) {
    // Robots with short ways make room first.
    std::ranges::stable_sort(priority_, std::less{}, [&](std::size_t i) { return length_of(direct_[i]); });
  } else {
    shuffle(priority_, random_);
    spread_out();
  }
}

/// Gives robots in a clinch elbow room: some of those that are under way step back to the nearest position
/// with no robot close by. In a clinch, each robot blocks the very moves by which the other would make way.
void PushAndRotate::spread_out() {
  for (const std::size_t i : priority_) {
    if (!wants_to_move(i) || random_.uniform() < 0.5) continue;
    std::vector<Sweep> close;
    for (std::size_t k = 0; k < tasks_.size(); ++k) {
      if (k != i) close.push_back({{at_[k], at_[k]}, tasks_[k].radius + elbow_room * tasks_[i].radius});
    }
    const bool crowded = std::ranges::any_of(close, [&](const Sweep& sweep) {
      return (sweep.path[0] - at_[i]).norm() < tasks_[i].radius + sweep.radius;
    });
    if (!crowded) continue;
    Path path = finder(i).refuge(at_[i], others(i), {}, close, {});
    if (!path.empty()) commit(i, std::move(path));
  }
}

/// Keeps the attempt's result if it is the best so far, and begins the next attempt.
void PushAndRotate::end_attempt() {
  JointPlan plan{moves_, {}};
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (!at_goal(i)) plan.stranded.push_back(i);
  }
  const bool nobody_without_need =
      std::ranges::none_of(plan.stranded, [&](std::size_t i) { return hopeful(i); });
  const std::size_t stranded = plan.stranded.size();
  if (!found_ || stranded < found_->stranded.size()) found_ = std::move(plan);
  ++attempts_;
  done_ = nobody_without_need || attempts_ == most_attempts || finders_.effort() > most_effort;
  if (done_) {
    best_ = *std::move(found_);
    return;
  }
  if (attempts_ % attempts_at_a_spacing == 0) finders_.refine(finders_.share() / 2);
  begin_attempt();
}

std::vector<Disc> PushAndRotate::others(std::size_t robot) const {
  std::vector<Disc> discs;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (i != robot) discs.push_back({at_[i], tasks_[i].radius});
  }
  return discs;
}

/// The other robots, divided by whether they may be asked to give way.
PushAndRotate::Discs PushAndRotate::discs_around(std::size_t robot,
                                                 const std::vector<std::size_t>& fixed) const {
  Discs discs;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (i == robot) continue;
    if (!tasks_[i].movable || std::ranges::find(fixed, i) != fixed.end()) {
      discs.fixed.push_back({at_[i], tasks_[i].radius});
    } else {
      discs.movable.push_back({at_[i], tasks_[i].radius});
      discs.movable_robot.push_back(i);
    }
  }
  return discs;
}

void PushAndRotate::commit(std::size_t robot, Path path) {
  stood_[robot].push_back(at_[robot]);
  at_[robot] = path.back();
  moves_.push_back({robot, std::move(path)});
  tried_.assign(tasks_.size(), false);
}

bool PushAndRotate::step() {
  if (done_) return true;
  const bool all_there = std::ranges::none_of(priority_, [&](std::size_t i) { return wants_to_move(i); });
  if (all_there || moves_.size() > moves_a_robot * (tasks_.size() + 2)) {
    end_attempt();
  } else if (!move_directly() &&
             std::ranges::all_of(priority_, [&](std::size_t i) { return tried_[i] || !wants_to_move(i); })) {
    if (!clear_a_way()) end_attempt();
  }
  return done_;
}

/// Moves the first robot that has a way to its goal and shuts no robot in there.
bool PushAndRotate::move_directly() {
  std::size_t routes = 0;
  for (const std::size_t i : priority_) {
    if (!wants_to_move(i) || tried_[i]) continue;
    if (++routes > most_routes_a_step) return false;
    tried_[i] = true;
    Path path = finder(i).route(at_[i], *tasks_[i].goal, others(i));
    if (path.empty() || shuts_in(i)) continue;
    commit(i, std::move(path));
    return true;
  }
  return false;
}

/// Whether a robot at its goal would cut another robot off from its own goal; robots under way do not count
/// as obstacles.
bool PushAndRotate::shuts_in(std::size_t robot) {
  std::vector<Disc> standing{{*tasks_[robot].goal, tasks_[robot].radius}};
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (i != robot && !wants_to_move(i)) standing.push_back({at_[i], tasks_[i].radius});
  }
  std::vector<bool> seen(tasks_.size(), false);
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (i == robot || !wants_to_move(i) || seen[i]) continue;
    RouteFinder& own = finder(i);
    own.flood(*tasks_[i].goal, standing);
    for (std::size_t k = i; k < tasks_.size(); ++k) {
      if (k == robot || !wants_to_move(k) || tasks_[k].radius != tasks_[i].radius) continue;
      const bool goal = own.flooded(*tasks_[k].goal);
      // Robots under way are left out: their present positions do not tell where they will be.
      if (!goal) continue;
      seen[k] = true;
      if (!own.flooded(at_[k])) return true;
    }
    if (!seen[i]) return true;
  }
  return false;
}

/// Sends away the robots in the way of one robot, and moves it.
bool PushAndRotate::clear_a_way() {
  struct Candidate {
    std::size_t robot;
    Path way;
    double length;
  };
  std::vector<Candidate> candidates;
  for (const std::size_t i : priority_) {
    if (!wants_to_move(i)) continue;
    const Discs discs = discs_around(i, {});
    Path way = finder(i).route_through(at_[i], *tasks_[i].goal, discs.fixed, discs.movable);
    if (way.empty()) continue;
    const double length =
        length_of(way) +
        20 * tasks_[i].radius * static_cast<double>(finder(i).blockers(way, discs.movable).size());
    candidates.push_back({i, std::move(way), length});
  }
  if (attempts_ == 0) std::ranges::stable_sort(candidates, std::less{}, &Candidate::length);
  for (const Candidate& candidate : candidates) {
    const std::size_t moves_before = moves_.size();
    const std::vector<Point2> before = at_;
    std::vector<Sweep> keep_clear;
    std::vector<std::size_t> waiting;
    if (clear(candidate.robot, candidate.way, keep_clear, waiting, 0)) {
      Path path = finder(candidate.robot)
                      .route(at_[candidate.robot], *tasks_[candidate.robot].goal, others(candidate.robot));
      if (!path.empty()) {
        commit(candidate.robot, std::move(path));
        return true;
      }
    }
    moves_.resize(moves_before);
    at_ = before;
  }
  return false;
}

/// Evacuates all robots that stand on `way` of `robot`. The robots in `waiting` stay where they are.
bool PushAndRotate::clear(std::size_t robot, const Path& way, std::vector<Sweep>& keep_clear,
                          std::vector<std::size_t>& waiting, int depth) {
  if (depth > most_depth) return false;
  waiting.push_back(robot);
  keep_clear.push_back({way, tasks_[robot].radius});
  bool cleared = true;
  while (cleared) {
    const Discs discs = discs_around(robot, waiting);
    std::vector<std::size_t> blockers = finder(robot).blockers(way, discs.movable);
    if (blockers.empty()) break;
    // Robots that can leave without help go first.
    cleared = std::ranges::any_of(blockers, [&](std::size_t b) {
      return evacuate(discs.movable_robot[b], keep_clear, waiting, most_depth);
    });
    if (!cleared) {
      cleared = depth < most_depth && std::ranges::any_of(blockers, [&](std::size_t b) {
                  return evacuate(discs.movable_robot[b], keep_clear, waiting, depth);
                });
    }
    if (moves_.size() > moves_a_robot * (tasks_.size() + 2) || finders_.effort() > most_effort)
      cleared = false;
  }
  keep_clear.pop_back();
  waiting.pop_back();
  return cleared;
}

/// Sends a robot to a position off the sweeps to be kept clear. Below the greatest depth, others may be sent
/// away first.
bool PushAndRotate::evacuate(std::size_t robot, std::vector<Sweep>& keep_clear,
                             std::vector<std::size_t>& waiting, int depth) {
  if (finders_.effort() > most_effort) return false;
  std::vector<Sweep> avoid;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (i != robot && wants_to_move(i)) avoid.push_back({direct_[i], tasks_[i].radius});
  }
  // The robot was sent away from its earlier positions: if it came back there, the attempt would run in
  // circles.
  for (const Point2& p : stood_[robot]) avoid.push_back({{p, p}, tasks_[robot].radius});
  if (depth == most_depth) {
    Path path = finder(robot).refuge(at_[robot], others(robot), {}, keep_clear, avoid);
    if (path.empty()) return false;
    commit(robot, std::move(path));
    return true;
  }
  const Discs discs = discs_around(robot, waiting);
  const Path way = finder(robot).refuge(at_[robot], discs.fixed, discs.movable, keep_clear, avoid);
  if (way.empty()) return false;
  if (!clear(robot, way, keep_clear, waiting, depth + 1)) return false;
  Path path = finder(robot).route(at_[robot], way.back(), others(robot));
  if (path.empty()) return false;
  commit(robot, std::move(path));
  return true;
}

}  // namespace coppice
