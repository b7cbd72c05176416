#include "robot_agent/coordination_round.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robot_agent/joint_tasks.h"

namespace coppice {

namespace {

// Timeouts: see timing.h.
constexpr double soon = Timing::round_again;
constexpr double long_delay = Timing::plan_delivery;
constexpr double longest_wait_for_plan = Timing::longest_wait_for_plan;
constexpr double least_wait_for_plan = Timing::least_wait_for_plan;
constexpr double longest_wait = Timing::longest_wait_for_member;
constexpr double patience = Timing::plan_patience;

constexpr double cluster_radii = 8;  // between two robots of one cluster
constexpr double close_radii = 3;    // between robots that may fear each other's next move, in sums of radii
constexpr double same_place = 0.01;  // metres between where a plan begins and where the robot stands

}  // namespace

void CoordinationRound::join(const RoundId& id) {
  leave();
  follower_.reset();
  id_ = id;
  note_epoch(id.epoch);
  stage_ = Stage::waiting;
  waiting_since_.reset();
  planned_since_.reset();
  plan_.reset();
  stranded_ = false;
}

void CoordinationRound::note_epoch(std::uint32_t epoch) {
  if (is_later_epoch(epoch, latest_epoch_)) latest_epoch_ = epoch;
}

/// A robot that has made all its moves goes on saying so by its progress.
void CoordinationRound::leave() {
  const bool has_moves_left = stage_ != Stage::free;
  stage_ = Stage::free;
  planner_.reset();
  if (has_moves_left) follower_.reset();
  waits_for_.clear();
}

void CoordinationRound::hear(const RobotState& state, const std::optional<Point2>& position) {
  note_epoch(state.round.epoch);
  const bool same = state.round == id_;
  const bool called_on = !same && calls_this(state.round);
  const bool out = same && stage_ == Stage::executing && state.stage == Stage::free;
  if (!called_on && !out) return;  // nearly all
  const auto member = stage_ == Stage::executing ? std::ranges::find(members_, state.robot) : members_.end();
  if (member != members_.end()) {
    const auto index = static_cast<std::size_t>(member - members_.begin());
    if (out && parts_[index] != Part::done)
      parts_[index] = has_made_all_moves(index, state.progress) ? Part::done : Part::left;
    if (called_on && parts_[index] != Part::done) leave();
  }
  if (called_on && state.stage == Stage::waiting && position && state.round.includes(*position))
    join(state.round);
}

void CoordinationRound::hear(std::shared_ptr<const JointPlanMessage> plan) {
  const bool member =
      std::ranges::find(plan->members, robot_, &JointPlanMessage::Member::robot) != plan->members.end();
  if (calls_this(plan->round) && member) join(plan->round);
  if (plan->round == id_) plan_ = std::move(plan);
}

/// A cluster that was not sorted out, or that formed again, is wider than it seemed.
void CoordinationRound::call(const FleetMember& self, const Fleet& fleet, double now) {
  const bool again = called_at_ && now - *called_at_ < soon;
  const double cluster = fleet.cluster_reach(self.position, cluster_radii * self.radius);
  begin(self, std::min(everywhere, std::max(cluster, again ? 2 * id_.reach : 0)), now);
}

void CoordinationRound::call_everybody(const FleetMember& self, double now) {
  begin(self, everywhere, now);
}

void CoordinationRound::begin(const FleetMember& self, double reach, double now) {
  const bool moved = (self.position - called_from_).norm() > self.radius / 2;
  calls_in_vain_ = moved ? 0 : calls_in_vain_ + 1;
  if (moved) called_from_ = self.position;
  join({epoch_after(latest_epoch_), robot_, self.position, reach});
  waiting_since_ = now;
  called_at_ = now;
}

void CoordinationRound::wait(const FleetMember& self, const Fleet& fleet, MapRoadmaps& places, double now) {
  if (!waiting_since_) waiting_since_ = now;
  if (plan_) {
    if (!self.stands) return;
    take_up(*std::exchange(plan_, nullptr), self);
    awaited_ = {};
    last_progress_ = 0;
    last_progress_time_ = now;
    return;
  }
  if (id_.leader == robot_) {
    lead(self, fleet, places, now);
    return;
  }
  const auto leader = fleet.find(id_.leader);
  const bool leaderless = !leader || leader->failed || leader->round != id_;
  const bool planned = !leaderless && leader->stage != Stage::waiting;
  if (planned && !planned_since_) planned_since_ = now;
  if ((leaderless && now - *waiting_since_ > fleet.second()) ||
      now - *waiting_since_ > std::max(longest_wait_for_plan, least_wait_for_plan * fleet.second())) {
    call(self, fleet, now);
  } else if (planned && now - *planned_since_ > long_delay * fleet.second()) {
    leave();  // it came too late for the plan
  }
}

/// Plans as soon as all robots within reach that are not failed wait in this round and stand. A robot that
/// stands elsewhere and wants to go nowhere is an obstacle. A robot that reports a position off the map is
/// neither a member nor an obstacle.
void CoordinationRound::lead(const FleetMember& self, const Fleet& fleet, MapRoadmaps& places, double now) {
  if (planner_) {
    if (planner_->step()) publish(self, now);
    return;
  }
  if (!self.stands || !fleet.all_wait(id_)) return;
  led_ = {self};
  std::vector<JointTask> obstacles;
  for (const FleetMember& m : fleet.others()) {
    if (m.failed || !is_on_map(places.field(), m.position)) continue;
    if (m.round == id_ && m.stage == Stage::waiting) {
      led_.push_back(m);
    } else if (m.wants_to_stay) {
      obstacles.push_back({m.position, std::nullopt, m.radius, false});
    }
  }
  for (const Disc& failed : fleet.zones_of_failed(self.position, now)) {
    if (is_on_map(places.field(), failed.centre, failed.radius))
      obstacles.push_back({failed.centre, std::nullopt, failed.radius, false});
  }
  planner_ =
      std::make_unique<JointPlanner>(places, joint_tasks(led_, obstacles, places.field()), Random(id_.epoch));
}

void CoordinationRound::publish(const FleetMember& self, double now) {
  if (!planner_->plan().stranded.empty() && id_.reach < everywhere) return call_everybody(self, now);
  JointPlan plan = planner_->take_plan();
  planner_.reset();
  JointPlanMessage message{.round = id_, .members = {}, .moves = std::move(plan.moves)};
  for (const FleetMember& m : led_) message.members.push_back({m.robot, m.radius, false});
  for (const std::size_t i : plan.stranded) message.members[i].stranded = true;
  plan_ = std::make_shared<const JointPlanMessage>(message);
  own_plan_ = std::move(message);
}

std::optional<JointPlanMessage> CoordinationRound::take_own_plan() {
  return std::exchange(own_plan_, std::nullopt);
}

void CoordinationRound::take_up(const JointPlanMessage& plan, const FleetMember& self) {
  leave();
  members_.clear();
  std::vector<double> radii;
  for (const JointPlanMessage::Member& member : plan.members) {
    members_.push_back(member.robot);
    radii.push_back(member.radius);
  }
  const auto own = std::ranges::find(members_, robot_);
  if (own == members_.end()) return;
  const auto index = static_cast<std::size_t>(own - members_.begin());
  stranded_ = plan.members[index].stranded;
  schedules_.assign(members_.size(), {});
  parts_.assign(members_.size(), Part::under_way);
  for (std::size_t k = 0; k < plan.moves.size(); ++k) {
    auto& [ends, at] = schedules_[plan.moves[k].robot];
    ends.push_back((ends.empty() ? 0 : ends.back()) + length_of(plan.moves[k].path));
    at.push_back(k);
  }
  const std::vector<Path> legs = legs_of(index, plan.moves);
  if (legs.empty() || (legs.front().front() - self.position).norm() > same_place) return;
  gates_ = Gates(gates_of(index, plan.moves, radii));
  follower_.emplace(legs, self.radius, stray_radii * self.radius);
  stage_ = Stage::executing;
}

Point2 CoordinationRound::preferred_velocity(const FleetMember& self, const Fleet& fleet,
                                             const Point2& position, const Limits& limits, double now) {
  const auto passed = [&](std::size_t index) {
    if (parts_[index] == Part::done) return std::numeric_limits<double>::infinity();
    const auto other = fleet.find(members_[index]);
    return other && other->round == id_ && other->stage == Stage::executing
               ? other->progress + way_until_rest(*other)
               : 0.0;
  };
  const double slack = gate_slack_radii * self.radius;
  const double open = gates_.open(follower_->progress(), slack, passed);
  Point2 wanted = follower_->preferred_velocity(position, limits, control_period, open);
  const bool waits = open - follower_->progress() < slack;
  waits_for_ = waits ? members_[gates_.wait().robot] : RobotName();
  if (waits && parts_[gates_.wait().robot] == Part::left) {
    call(self, fleet, now);
    return Point2::Zero();
  }
  const auto waited_for = waits ? fleet.find(waits_for_) : std::nullopt;
  waits_until_ = waited_for ? waited_for->rests_until + gates_.wait().metres / waited_for->max_speed : 0;
  if (waited_for && (waits_for_ != awaited_.robot || waited_for->progress != awaited_.progress)) {
    awaited_ = {waits_for_, waited_for->progress};
    awaited_since_ = now;
  }
  const bool worth_waiting = (waited_for && !waited_for->failed && now - awaited_since_ < longest_wait) ||
                             fleet.is_suspected_near(self.position, cluster_radii * self.radius);
  if (follower_->progress() > last_progress_ || worth_waiting) {
    last_progress_ = follower_->progress();
    last_progress_time_ = now;
  }
  if (follower_->finished() && self.stands) {
    stage_ = Stage::free;
  } else if (now - last_progress_time_ > patience) {
    call(self, fleet, now);
    return Point2::Zero();
  }
  return wanted;
}

/// A member that has made all its moves says so by its progress. Otherwise it has left the round, and no plan
/// says where it goes.
bool CoordinationRound::has_made_all_moves(std::size_t member, double progress) const {
  const auto& ends = schedules_[member].ends;
  return ends.empty() || progress > ends.back() - same_place;
}

/// The index in the plan of the next move of a member; beyond the end of the plan if it has made all.
std::size_t CoordinationRound::next_move(std::size_t member, double progress) const {
  const auto& [ends, at] = schedules_[member];
  const auto next = std::ranges::upper_bound(ends, progress + same_place);
  return next == ends.end() ? std::numeric_limits<std::size_t>::max()
                            : at[static_cast<std::size_t>(next - ends.begin())];
}

bool CoordinationRound::gives_way(const FleetMember& self, const Fleet& fleet, double now) {
  const auto own = std::ranges::find(members_, robot_) - members_.begin();
  const std::size_t own_next = next_move(static_cast<std::size_t>(own), progress());
  for (const FleetMember& other : fleet.beside(self.position, self.radius, close_radii)) {
    if (other.failed || other.round != id_ || other.stage != Stage::executing) continue;
    const auto member = std::ranges::find(members_, other.robot);
    if (member == members_.end()) continue;
    const auto k = static_cast<std::size_t>(member - members_.begin());
    if (next_move(k, other.progress) >= own_next) continue;
    last_progress_time_ = now;
    return true;
  }
  return false;
}

}  // namespace coppice
