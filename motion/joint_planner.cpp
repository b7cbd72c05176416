#include "motion/joint_planner.h"

#include <algorithm>
#include <utility>

#include "motion/route_finder.h"
#include "motion/straightening.h"

namespace coppice {

namespace {

constexpr std::size_t configurations_a_step = 1000;
constexpr std::size_t most_configurations = 100'000;

}  // namespace

JointPlanner::JointPlanner(PlacesOfMap& places, std::vector<JointTask> tasks, Random random)
    : field_(places.field()), tasks_(std::move(tasks)), random_(random) {
  const auto first = std::ranges::find_if(tasks_, &JointTask::movable);
  const bool one_size = first != tasks_.end() && std::ranges::all_of(tasks_, [&](const JointTask& t) {
                          return !t.movable || t.radius == first->radius;
                        });
  if (one_size) set_up_places(places.packed(first->radius), first->radius);
}

/// Places for everybody, and what each wants: to its goal, or to give way if it could not even get there
/// alone.
void JointPlanner::set_up_places(PackedPlaces& packed, double radius) {
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
  graph_ = packed.with(ends, dead);
  crowd_.emplace(graph_, std::move(crowd), random_);
  for (const std::uint32_t k : crowd_->shut_in()) {
    const JointTask& task = tasks_[movable_[k]];
    const bool missed = !coarsest_route(field_, radius, task.position, task.goal, dead, 1).path.empty();
    if (missed) return crowd_.reset();  // there is a way, but not over these places
    plan_.stranded.push_back(movable_[k]);
  }
}

bool JointPlanner::step() {
  if (crowd_) {
    const Lacam::Outcome outcome = crowd_->search(configurations_a_step);
    configurations_ += configurations_a_step;
    if (outcome == Lacam::Outcome::solved) {
      take_up(*crowd_);
      return true;
    }
    if (outcome != Lacam::Outcome::searching || configurations_ >= most_configurations) crowd_.reset();
    return false;
  }
  if (!refuges_) refuges_ = std::make_unique<PushAndRotate>(field_, tasks_, random_);
  if (!refuges_->step()) return false;
  plan_ = refuges_->plan();
  return true;
}

void JointPlanner::take_up(const Lacam& solution) {
  std::vector<Move> moves;
  for (const PlaceMove& move : solution.moves())
    moves.push_back({movable_[move.robot], graph_.edges(move.from)[move.edge].path});
  plan_.moves = straightened(field_, tasks_, moves);
}

}  // namespace coppice
