#include "motion/joint/evacuate_and_reassemble.h"

#include <algorithm>

#include "motion/trajectory/segments.h"
#include "planning/shuffle.h"

namespace coppice {

namespace {

constexpr std::size_t most_effort = 20'000'000;  // lattice vertices examined or marked: about 1 s
constexpr int most_attempts = 6;
constexpr int first_with_everybody = 1;  // first attempt that also evacuates robots that stand at their goals
constexpr int first_shuffled = 2;        // first attempt with the robots in a random order

}  // namespace

EvacuateAndReassemble::EvacuateAndReassemble(const ClearanceField& field, std::vector<JointTask> tasks,
                                             Random random)
    : tasks_(std::move(tasks)), lattices_{field}, random_(random) {
  const std::vector<Path> alone = ways_alone(field, tasks_, lattices_.finders);
  lattices_.scouts.refine(lattices_.finders.share());
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (!tasks_[i].goal || !alone[i].empty()) continue;
    tasks_[i].goal.reset();
    stranded_.push_back(i);
  }
  done_ = somebody_has_no_room();
  if (!done_) begin_attempt();
}

/// Whether a goal is so near to another goal, or to a robot that stays, that two robots cannot stand there.
bool EvacuateAndReassemble::somebody_has_no_room() const {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (!wants_to_move(tasks_[i])) continue;
    for (std::size_t k = 0; k < tasks_.size(); ++k) {
      const std::optional<Point2> end = end_of(tasks_[k]);
      const double touching = tasks_[i].radius + tasks_[k].radius + standing_gap;
      if (i != k && end && (*end - *tasks_[i].goal).norm() < touching) return true;
    }
  }
  return false;
}

void EvacuateAndReassemble::begin_attempt() {
  moves_.clear();
  back_.clear();
  detours_ = 0;
  enter(Stage::from_the_beginning);
}

void EvacuateAndReassemble::enter(Stage stage) {
  std::vector<Point2> parked;
  for (std::size_t i = 0; parking_ && i < tasks_.size(); ++i) parked.push_back(parking_->at(i));
  if (stage == Stage::from_the_end) first_ = parked;
  std::vector<Parking::Robot> robots;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const JointTask& task = tasks_[i];
    const bool is_there = task.goal == task.position;
    const bool takes_part = task.movable && (!is_there || attempts_ >= first_with_everybody);
    Parking::Robot robot{task.position, task.goal, task.radius, takes_part};
    if (takes_part && stage == Stage::from_the_end)
      robot = {task.goal.value_or(first_[i]), first_[i], task.radius, true};
    if (takes_part && stage == Stage::between) robot = {first_[i], parked[i], task.radius, true};
    robots.push_back(robot);
  }
  stage_ = stage;
  parking_.emplace(lattices_, std::move(robots));
  pending_ = parking_->left();
  if (attempts_ >= first_shuffled) shuffle(pending_, random_);
  next_ = in_vain_ = 0;
}

bool EvacuateAndReassemble::step() {
  if (done_) return true;
  const bool too_long = lattices_.effort() > most_effort;
  if (pending_.empty()) {
    if (stage_ == Stage::between) {
      finish();
    } else {
      enter(stage_ == Stage::from_the_beginning ? Stage::from_the_end : Stage::between);
    }
  } else if (too_long || (!go_on() && in_vain_ == pending_.size() && !make_room())) {
    done_ = too_long || ++attempts_ == most_attempts;
    if (!done_) begin_attempt();
  }
  return done_;
}

/// Moves one of the remaining robots. False if it has no way now.
bool EvacuateAndReassemble::go_on() {
  next_ %= pending_.size();
  const std::size_t robot = pending_[next_];
  const Path way = stage_ == Stage::between ? parking_->way_to_aim(robot) : parking_->way(robot);
  if (way.empty()) {
    ++next_;
    ++in_vain_;
    return false;
  }
  in_vain_ = 0;
  pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(next_));
  drive(robot, way);
  return true;
}

/// Robots stand at each other's second parking positions: moves one of them aside.
bool EvacuateAndReassemble::make_room() {
  if (stage_ != Stage::between || ++detours_ > tasks_.size()) return false;
  for (const std::size_t robot : pending_) {
    const Path way = parking_->way_aside(robot);
    if (way.empty()) continue;
    drive(robot, way);
    in_vain_ = 0;
    return true;
  }
  return false;
}

void EvacuateAndReassemble::drive(std::size_t robot, const Path& way) {
  const bool stays = way.front() == way.back();
  parking_->park(robot, way);
  if (stays) return;
  if (stage_ == Stage::from_the_end) {
    back_.push_back({robot, Path(way.rbegin(), way.rend())});
  } else {
    moves_.push_back({robot, way});
  }
}

void EvacuateAndReassemble::finish() {
  moves_.insert(moves_.end(), back_.rbegin(), back_.rend());
  plan_ = JointPlan{std::move(moves_), stranded_};
  done_ = true;
}

}  // namespace coppice
