#include "motion/joint/joint_planner.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "motion/joint/straightening.h"
#include "motion/lattice/route_finder.h"
#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr std::size_t configurations_a_step = 1000;
constexpr std::size_t most_anchors = 8;
constexpr std::size_t vertices_of_anchors = 1'000'000;  // over the lattices of all anchors; takes about 1 s
constexpr std::size_t first_try = 5'000;  // configurations; successful searches hardly ever need more
constexpr int evacuation_steps = 8;       // in a step of the planner: about 10 ms
constexpr std::size_t before_evacuation = 2 * first_try;
constexpr std::size_t most_configurations = 100'000;
// Largest number of robots with a way to drive for which push and rotate is tried after a partial plan: with
// more robots it takes long, and hardly ever finds what LaCAM has not found.
constexpr std::ptrdiff_t intricate = 12;
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

JointPlanner::JointPlanner(MapRoadmaps& places, std::vector<JointTask> tasks, Random random, Methods methods)
    : places_(places),
      tasks_(std::move(tasks)),
      radius_(largest_radius(tasks_)),
      spacing_(place_spacing * radius_),
      random_(random) {
  if (methods == Methods::all && SmallOnesAside::may_help(tasks_))
    parts_ = std::make_unique<SmallOnesAside>(places_, tasks_, random_);
  if (has_room_for_the_largest()) set_up_crowd({});
}

/// Whether all robots would have room at their positions and goals if all were as large as the largest. Then
/// a plan for such robots is also valid for the real ones.
bool JointPlanner::has_room_for_the_largest() const {
  const double touching = 2 * radius_ + standing_gap;
  std::vector<JointTask> movable;
  std::ranges::copy_if(tasks_, std::back_inserter(movable), &JointTask::movable);
  if (movable.empty()) return false;
  if (std::ranges::all_of(movable, [&](const JointTask& task) { return task.radius == radius_; }))
    return true;
  const auto fits = [&](const Point2& p) { return places_.field().is_free(p, radius_); };
  return std::ranges::all_of(movable, [&](const JointTask& task) {
    return fits(task.position) && (!task.goal || fits(*task.goal)) &&
           std::ranges::none_of(movable, [&](const JointTask& other) {
             return &other != &task &&
                    ((other.position - task.position).norm() < touching ||
                     (other.goal && task.goal && (*other.goal - *task.goal).norm() < touching));
           });
  });
}

/// Makes a roadmap for the cluster and the robots' tasks on it. A robot that could not reach its goal even if
/// it were alone gives way.
void JointPlanner::set_up_crowd(std::span<const Point2> elbow_room) {
  crowd_.reset();
  shut_in_.clear();
  movable_.clear();
  std::vector<Point2> ends;
  const auto place_of = [&](const Point2& p) {
    const auto known = std::ranges::find(ends, p);
    const auto place = static_cast<Vertex>(packed().size()) + static_cast<Vertex>(known - ends.begin());
    if (known == ends.end()) ends.push_back(p);
    return place;
  };
  std::vector<VertexTask> crowd;
  std::vector<Disc> failed;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const JointTask& task = tasks_[i];
    if (!task.movable) {
      failed.push_back({task.position, task.radius});
      continue;
    }
    movable_.push_back(i);
    const Vertex start = place_of(task.position);
    crowd.push_back({start, task.goal ? std::optional(place_of(*task.goal)) : std::nullopt});
  }
  for (const Point2& p : elbow_room) place_of(p);
  graph_ = packed().with(ends, failed);
  crowd_.emplace(graph_, std::move(crowd), random_);
  for (const std::uint32_t k : crowd_->shut_in()) {
    const JointTask& task = tasks_[movable_[k]];
    const SpacedRoute missed = coarsest_route(places_.field(), radius_, task.position, *task.goal, failed, 1);
    if (!missed.path.empty()) return use_finer_places(missed.share * usual_spacing(radius_), elbow_room);
    shut_in_.push_back(movable_[k]);
  }
}

/// Repeats the set-up on a finer roadmap: a way exists, but not on the present one.
void JointPlanner::use_finer_places(double spacing, std::span<const Point2> elbow_room) {
  crowd_.reset();
  if (spacing >= spacing_) return;
  spacing_ = spacing;
  set_up_crowd(elbow_room);
}

bool JointPlanner::in_a_clinch(const JointTask& task) const {
  const auto near = std::ranges::count_if(tasks_, [&](const JointTask& other) {
    return (other.position - task.position).norm() < clinch / 2 * (task.radius + other.radius);
  });
  return near > 1;  // greater than 1 because the robot itself is counted
}

/// Vertices half a radius away from the starts of robots in a clinch that did not reach their goals.
std::vector<Point2> JointPlanner::elbow_room() const {
  std::vector<Point2> result;
  for (const std::uint32_t k : crowd_->under_way()) {
    const JointTask& task = tasks_[movable_[k]];
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

/// The starts of the robots that did not reach their goals.
std::vector<Point2> JointPlanner::under_way() const {
  std::vector<Point2> centres;
  for (const std::uint32_t k : crowd_->under_way()) centres.push_back(tasks_[movable_[k]].position);
  return centres;
}

void JointPlanner::set_up_few(std::span<const Point2> centres) {
  std::vector<JointTask> robots;
  std::vector<Disc> obstacles;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (!tasks_[i].movable) {
      obstacles.push_back({tasks_[i].position, tasks_[i].radius});
      continue;
    }
    robots.push_back(tasks_[i]);
    if (std::ranges::find(shut_in_, i) != shut_in_.end()) robots.back().goal.reset();
  }
  std::vector<Point2> anchors = packed().ends(centres);
  anchors.resize(
      std::min(anchors.size(),
               std::clamp<std::size_t>(vertices_of_anchors / packed().lattice_size(), 1, most_anchors)));
  few_ = std::make_unique<FewRobots>(places_.field(), radius_, spacing_, std::move(robots),
                                     std::move(obstacles), std::move(anchors));
}

bool JointPlanner::step() {
  if (few_) return search_few();
  if (crowd_ && (evacuated_ || configurations_ < before_evacuation)) return search_crowd();
  if (second_try_ && !evacuated_) return evacuate();
  if (partial_ && std::ranges::count_if(tasks_, wants_to_move) > intricate)
    return take_up(*std::move(partial_));
  if (!refuges_) refuges_ = std::make_unique<PushAndRotate>(places_.field(), tasks_, random_);
  if (!refuges_->step()) return false;
  const bool strands = !refuges_->plan().stranded.empty();
  if (strands && parts_) return set_small_ones_aside();
  if (strands && !evacuated_) return evacuate();
  const bool better = !partial_ || refuges_->plan().stranded.size() <= partial_->stranded.size();
  if (!better) return take_up(*std::move(partial_));
  plan_ = refuges_->plan();
  return true;
}

/// Such a plan strands nobody.
bool JointPlanner::set_small_ones_aside() {
  if (!parts_->step()) return false;
  auto plan = std::exchange(parts_, nullptr)->take_plan();
  return plan && take_up(*std::move(plan));
}

/// Tries to evacuate and reassemble the cluster. Such a plan strands no robot without need.
bool JointPlanner::evacuate() {
  if (!evacuation_) evacuation_ = std::make_unique<EvacuateAndReassemble>(places_.field(), tasks_, random_);
  for (int k = 1; !evacuation_->step(); ++k) {
    if (k == evacuation_steps) return false;
  }
  evacuated_ = true;
  auto plan = std::exchange(evacuation_, nullptr)->take_plan();
  const bool is_best = plan && (!refuges_ || plan->stranded.size() < refuges_->plan().stranded.size());
  return is_best && take_up(*std::move(plan));
}

bool JointPlanner::search_few() {
  if (!few_->step()) return false;
  const auto few = std::exchange(few_, nullptr);
  if (!few->moves()) return false;
  JointPlan plan{.moves = {}, .stranded = shut_in_};
  for (const Move& move : *few->moves()) plan.moves.push_back({movable_[move.robot], move.path});
  return take_up(std::move(plan));
}

bool JointPlanner::search_crowd() {
  const Lacam::Outcome outcome = crowd_->search(configurations_a_step);
  configurations_ += configurations_a_step;
  if (outcome == Lacam::Outcome::solved) return take_up(best_of_crowd());
  const bool ended = outcome != Lacam::Outcome::searching;
  const bool tries_again = (ended || configurations_ >= first_try) && !std::exchange(second_try_, true);
  std::vector<Point2> room;
  if (tries_again) {
    const std::vector<Point2> centres = under_way();
    room = elbow_room();
    std::ranges::copy(packed().stacked(centres), std::back_inserter(room));
    if (movable_.size() <= FewRobots::most) set_up_few(centres);
  }
  const bool gives_up = !room.empty() || ended || configurations_ >= most_configurations;
  if (!gives_up) return false;
  JointPlan best = best_of_crowd();
  if (!partial_ || best.stranded.size() < partial_->stranded.size()) partial_ = std::move(best);
  crowd_.reset();
  if (!room.empty()) set_up_crowd(room);
  return false;
}

std::vector<Move> JointPlanner::moves_of(std::span<const VertexMove> moves) const {
  std::vector<Move> result;
  for (const VertexMove& move : moves)
    result.push_back({movable_[move.robot], graph_.edges(move.from)[move.edge].path});
  return result;
}

/// The moves of the unsolved search to the configuration with the fewest robots away from their goals.
JointPlan JointPlanner::best_of_crowd() const {
  JointPlan plan{.moves = moves_of(crowd_->moves()), .stranded = shut_in_};
  for (const std::uint32_t k : crowd_->left_over()) plan.stranded.push_back(movable_[k]);
  return plan;
}

bool JointPlanner::take_up(JointPlan plan) {
  crowd_.reset();  // frees megabytes for hundreds of robots, because straightening needs memory too
  graph_ = {};
  plan.moves = straightened(places_.field(), tasks_, std::exchange(plan.moves, {}));
  plan_ = std::move(plan);
  return true;
}

}  // namespace coppice
