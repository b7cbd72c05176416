#include "motion/joint_planner.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "motion/route_finder.h"
#include "motion/straightening.h"

namespace coppice {

namespace {

constexpr std::size_t configurations_a_step = 1000;
constexpr std::size_t first_try = 5'000;  // configurations; hardly a search that finds anything needs more
constexpr std::size_t most_configurations = 100'000;
// Robots that want to go somewhere: with more, the search for refuges takes long, and hardly finds what LaCAM
// has not.
constexpr std::ptrdiff_t intricate = 12;
constexpr double clinch = 2.2;      // radii between centres, and less
constexpr double step_aside = 0.5;  // likewise
constexpr int directions = 8;

}  // namespace

JointPlanner::JointPlanner(PlacesOfMap& places, std::vector<JointTask> tasks, Random random)
    : places_(places), tasks_(std::move(tasks)), random_(random) {
  const auto first = std::ranges::find_if(tasks_, &JointTask::movable);
  const bool one_size = first != tasks_.end() && std::ranges::all_of(tasks_, [&](const JointTask& t) {
                          return !t.movable || t.radius == first->radius;
                        });
  if (one_size) set_up_crowd({});
}

/// Places for everybody, and what each wants: to its goal, or to give way if it could not even get there
/// alone.
void JointPlanner::set_up_crowd(std::span<const Point2> elbow_room) {
  const double radius = std::ranges::find_if(tasks_, &JointTask::movable)->radius;
  PackedPlaces& packed = places_.packed(radius);
  crowd_.reset();
  shut_in_.clear();
  movable_.clear();
  std::vector<Point2> ends;
  const auto place_of = [&](const Point2& p) {
    const auto known = std::ranges::find(ends, p);
    const auto place = static_cast<Place>(packed.size()) + static_cast<Place>(known - ends.begin());
    if (known == ends.end()) ends.push_back(p);
    return place;
  };
  std::vector<PlaceTask> crowd;
  std::vector<Disc> dead;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const JointTask& task = tasks_[i];
    if (!task.movable) {
      dead.push_back({task.position, task.radius});
      continue;
    }
    movable_.push_back(i);
    const Place start = place_of(task.position);
    crowd.push_back({start, task.goal ? std::optional(place_of(*task.goal)) : std::nullopt});
  }
  for (const Point2& p : elbow_room) place_of(p);
  graph_ = packed.with(ends, dead);
  crowd_.emplace(graph_, std::move(crowd), random_);
  for (const std::uint32_t k : crowd_->shut_in()) {
    const JointTask& task = tasks_[movable_[k]];
    const bool missed =
        !coarsest_route(places_.field(), radius, task.position, *task.goal, dead, 1).path.empty();
    if (missed) return crowd_.reset();  // there is a way, but not over these places
    shut_in_.push_back(movable_[k]);
  }
}

bool JointPlanner::in_a_clinch(const JointTask& task) const {
  const auto near = std::ranges::count_if(tasks_, [&](const JointTask& other) {
    return (other.position - task.position).norm() < clinch / 2 * (task.radius + other.radius);
  });
  return near > 1;  // itself
}

/// Places a step away from where those began that did not get to their goals, if they could hardly move.
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

bool JointPlanner::step() {
  if (crowd_) return search_crowd();
  if (second_try_ && !dismantled_) return dismantle();
  if (partial_ && std::ranges::count_if(tasks_, wants_to_move) > intricate)
    return take_up(*std::move(partial_));
  if (!refuges_) refuges_ = std::make_unique<PushAndRotate>(places_.field(), tasks_, random_);
  if (!refuges_->step()) return false;
  if (!refuges_->plan().stranded.empty() && !dismantled_) return dismantle();
  const bool better = !partial_ || refuges_->plan().stranded.size() <= partial_->stranded.size();
  if (!better) return take_up(*std::move(partial_));
  plan_ = refuges_->plan();
  return true;
}

/// Such a plan strands nobody without need.
bool JointPlanner::dismantle() {
  if (!dismantling_) dismantling_ = std::make_unique<Dismantling>(places_.field(), tasks_, random_);
  if (!dismantling_->step()) return false;
  dismantled_ = true;
  auto plan = std::exchange(dismantling_, nullptr)->take_plan();
  const bool is_best = plan && (!refuges_ || plan->stranded.size() < refuges_->plan().stranded.size());
  return is_best && take_up(*std::move(plan));
}

bool JointPlanner::search_crowd() {
  const Lacam::Outcome outcome = crowd_->search(configurations_a_step);
  configurations_ += configurations_a_step;
  if (outcome == Lacam::Outcome::solved) return take_up(best_of_crowd());
  const bool ended = outcome != Lacam::Outcome::searching;
  const bool tries_again = (ended || configurations_ >= first_try) && !std::exchange(second_try_, true);
  std::vector<Point2> room;
  if (tries_again) {
    room = elbow_room();
    std::ranges::copy(places_.packed(tasks_[movable_.front()].radius).sidings(), std::back_inserter(room));
  }
  const bool gives_up = !room.empty() || ended || configurations_ >= most_configurations;
  if (!gives_up) return false;
  JointPlan best = best_of_crowd();
  if (!partial_ || best.stranded.size() < partial_->stranded.size()) partial_ = std::move(best);
  crowd_.reset();
  if (!room.empty()) set_up_crowd(room);
  return false;
}

/// Of a crowd that was not sorted out, the moves to where the fewest are under way.
JointPlan JointPlanner::best_of_crowd() const {
  JointPlan plan{.moves = {}, .stranded = shut_in_};
  for (const PlaceMove& move : crowd_->moves())
    plan.moves.push_back({movable_[move.robot], graph_.edges(move.from)[move.edge].path});
  for (const std::uint32_t k : crowd_->left_over()) plan.stranded.push_back(movable_[k]);
  return plan;
}

bool JointPlanner::take_up(JointPlan plan) {
  crowd_.reset();  // of hundreds of robots it remembers megabytes, and straightening takes some of its own
  graph_ = {};
  plan.moves = straightened(places_.field(), tasks_, std::exchange(plan.moves, {}));
  plan_ = std::move(plan);
  return true;
}

}  // namespace coppice
