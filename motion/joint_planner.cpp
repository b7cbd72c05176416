#include "motion/joint_planner.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "motion/route_finder.h"
#include "motion/straightening.h"

namespace coppice {

namespace {

constexpr std::size_t configurations_a_step = 1000;
// Hardly a search that finds anything needs more than the first; the last may be a puzzle.
constexpr std::size_t most_configurations = 5'000;
constexpr std::size_t most_with_elbow_room = 100'000;
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
  if (one_size) set_up_crowd(ElbowRoom::none);
}

/// Places for everybody, and what each wants: to its goal, or to give way if it could not even get there
/// alone.
void JointPlanner::set_up_crowd(ElbowRoom room) {
  const double radius = std::ranges::find_if(tasks_, &JointTask::movable)->radius;
  PackedPlaces& packed = places_.packed(radius);
  crowd_.reset();
  plan_ = {};
  movable_.clear();
  room_ = room;
  configurations_ = 0;
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
      if (task.position != task.goal) plan_.stranded.push_back(i);
      continue;
    }
    movable_.push_back(i);
    const Place start = place_of(task.position);
    crowd.push_back({start, place_of(task.goal)});
  }
  if (room == ElbowRoom::in_a_clinch) {
    for (const Point2& p : elbow_room()) place_of(p);
  }
  graph_ = packed.with(ends, dead);
  crowd_.emplace(graph_, std::move(crowd), random_);
  for (const std::uint32_t k : crowd_->shut_in()) {
    const JointTask& task = tasks_[movable_[k]];
    const bool missed =
        !coarsest_route(places_.field(), radius, task.position, task.goal, dead, 1).path.empty();
    if (missed) return crowd_.reset();  // there is a way, but not over these places
    plan_.stranded.push_back(movable_[k]);
  }
}

/// Places a step away from each robot that can hardly move for another.
std::vector<Point2> JointPlanner::elbow_room() const {
  std::vector<Point2> result;
  for (const std::size_t i : movable_) {
    const auto& [here, goal, radius, movable] = tasks_[i];
    const auto others_near = std::ranges::count_if(tasks_, [&](const JointTask& other) {
      return (other.position - here).norm() < clinch / 2 * (radius + other.radius);
    });
    if (others_near < 2) continue;  // itself
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions;
      const Point2 aside = here + step_aside * radius * Point2(std::cos(angle), std::sin(angle));
      if (places_.field().segment_free(here, aside, radius)) result.push_back(aside);
    }
  }
  return result;
}

bool JointPlanner::step() {
  if (crowd_) {
    const Lacam::Outcome outcome = crowd_->search(configurations_a_step);
    configurations_ += configurations_a_step;
    if (outcome == Lacam::Outcome::solved) {
      take_up(*crowd_);
      return true;
    }
    const std::size_t most = room_ == ElbowRoom::none ? most_configurations : most_with_elbow_room;
    if (outcome != Lacam::Outcome::searching || configurations_ >= most) give_up_crowd();
    return false;
  }
  if (!refuges_) refuges_ = std::make_unique<PushAndRotate>(places_.field(), tasks_, random_);
  if (!refuges_->step()) return false;
  plan_ = refuges_->plan();
  return true;
}

void JointPlanner::give_up_crowd() {
  if (room_ == ElbowRoom::none) {
    set_up_crowd(ElbowRoom::in_a_clinch);
  } else {
    crowd_.reset();
  }
}

void JointPlanner::take_up(const Lacam& solution) {
  std::vector<Move> moves;
  for (const PlaceMove& move : solution.moves())
    moves.push_back({movable_[move.robot], graph_.edges(move.from)[move.edge].path});
  plan_.moves = straightened(places_.field(), tasks_, moves);
}

}  // namespace coppice
