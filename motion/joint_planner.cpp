#include "motion/joint_planner.h"

#include <array>
#include <utility>

#include "motion/straightening.h"

namespace coppice {

namespace {

// Configurations of LaCAM in all, at which it gives way to another strategy.
constexpr std::size_t first_try = 5'000;  // successful searches hardly ever need more
constexpr std::size_t before_evacuation = 2 * first_try;
constexpr std::size_t most_configurations = 100'000;

}  // namespace

std::span<const JointPlanner::Strategy> JointPlanner::strategies() {
  static constexpr std::array<Strategy, 9> all{{
      {"LaCAM", "most clusters", &JointPlanner::begin_crowd},
      {"weighted A*", "four robots or fewer in narrow passages", &JointPlanner::begin_few},
      {"LaCAM on more vertices", "robots in a clinch, and short branches of passages",
       &JointPlanner::begin_crowd_with_more_vertices},
      {"evacuate and reassemble", "dead ends that are filled in the wrong order",
       &JointPlanner::begin_evacuation},
      {"LaCAM for long", "clusters in which robots shut each other in", &JointPlanner::begin_crowd_for_long},
      {"push and rotate", "robots of several sizes that have no room as the largest",
       &JointPlanner::begin_push_and_rotate},
      {"small ones aside", "large robots that need the room of the small ones",
       &JointPlanner::begin_small_ones_aside},
      {"evacuate at last", "what push and rotate strands", &JointPlanner::begin_evacuation_at_last},
      {"best so far", "clusters without a solution", &JointPlanner::take_best},
  }};
  return all;
}

JointPlanner::JointPlanner(MapRoadmaps& places, std::vector<JointTask> tasks, Random random, Methods methods)
    : places_(places), tasks_(std::move(tasks)), random_(random), methods_(methods) {
  begin_next();
}

void JointPlanner::begin_next() {
  while (!(this->*strategies()[next_++].begin)()) {
  }
}

bool JointPlanner::is_better(const JointPlan& plan) const {
  return !best_ || plan.stranded.size() < best_->stranded.size();
}

std::optional<JointPlan> JointPlanner::step() {
  Progress progress = std::visit([](auto& search) { return search.step(); }, search_);
  if (std::holds_alternative<Searching>(progress)) return std::nullopt;
  auto* const plan = std::get_if<JointPlan>(&progress);
  if (plan != nullptr && (is_better(*plan) || std::holds_alternative<BestSoFar>(search_)))
    return completed(std::move(*plan));
  auto* const gives_up = std::get_if<GivesUp>(&progress);
  if (gives_up != nullptr && gives_up->best && is_better(*gives_up->best)) best_ = std::move(gives_up->best);
  begin_next();
  return std::nullopt;
}

JointPlan JointPlanner::completed(JointPlan plan) {
  // The routes of push and rotate are straight already.
  const bool is_best_so_far = std::holds_alternative<BestSoFar>(search_);
  if (std::holds_alternative<PushAndRotate>(search_) || (is_best_so_far && !crowd_)) return plan;
  search_.emplace<BestSoFar>();
  crowd_.reset();  // frees megabytes for hundreds of robots, because straightening needs memory too
  plan.moves = straightened(places_.field(), tasks_, std::exchange(plan.moves, {}));
  return plan;
}

bool JointPlanner::begin_crowd() {
  if (!CrowdSearch::has_room(tasks_, places_.field())) return false;
  crowd_.emplace(places_, tasks_, random_);
  if (crowd_->can_go_on()) {
    search_.emplace<GoesOn>(*crowd_, first_try);
  } else {
    crowd_.reset();
  }
  return crowd_.has_value();
}

bool JointPlanner::begin_few() {
  if (!crowd_ || !FewRobots::are_few(tasks_)) return false;
  search_.emplace<FewRobots>(places_, crowd_->radius(), crowd_->spacing(), tasks_, crowd_->shut_in(),
                             crowd_->starts_under_way());
  return true;
}

bool JointPlanner::begin_crowd_with_more_vertices() {
  if (!crowd_) return false;
  crowd_->add_vertices();
  if (crowd_->can_go_on()) search_.emplace<GoesOn>(*crowd_, before_evacuation);
  return crowd_->can_go_on();
}

bool JointPlanner::begin_evacuation() {
  if (crowd_) search_.emplace<EvacuateAndReassemble>(places_.field(), tasks_, random_);
  return crowd_.has_value();
}

bool JointPlanner::begin_crowd_for_long() {
  if (!crowd_ || !crowd_->can_go_on()) return false;
  search_.emplace<GoesOn>(*crowd_, most_configurations);
  return true;
}

bool JointPlanner::begin_push_and_rotate() {
  if (!crowd_) search_.emplace<PushAndRotate>(places_.field(), tasks_, random_);
  return !crowd_;
}

bool JointPlanner::begin_small_ones_aside() {
  if (methods_ == Methods::for_a_part || !SmallOnesAside::may_help(tasks_)) return false;
  search_.emplace<SmallOnesAside>(places_, tasks_, random_);
  return true;
}

bool JointPlanner::begin_evacuation_at_last() {
  if (!crowd_) search_.emplace<EvacuateAndReassemble>(places_.field(), tasks_, random_);
  return !crowd_;
}

/// LaCAM, or push and rotate, has given up with a plan.
bool JointPlanner::take_best() {
  search_.emplace<BestSoFar>(*std::move(best_));
  return true;
}

JointPlan joint_plan(MapRoadmaps& places, std::vector<JointTask> tasks, Random random) {
  JointPlanner planner(places, std::move(tasks), random);
  while (true) {
    if (auto plan = planner.step()) return *std::move(plan);
  }
}

}  // namespace coppice
