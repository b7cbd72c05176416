#include "robot_agent/knot.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace coppice {

namespace {

constexpr double longest_hold = 60;  // seconds without a joint plan: the leader has lost sight of somebody
constexpr double patience = 5;       // seconds without progress though nobody earlier is in the way
constexpr double same_place = 0.01;  // metres between where a plan begins and where the robot stands
// Robots that move at the same time keep this many times (acceleration period^2) apart beyond their radii if
// they can: with less, their promises would slow them down to a crawl.
constexpr double gap_periods = 15;

}  // namespace

void Knot::join(const KnotId& id) {
  id_ = id;
  stage_ = Stage::holding;
  holding_since_.reset();
  planner_.reset();
  follower_.reset();
  waits_for_.clear();
  stranded_ = false;
}

void Knot::hear(const RobotState& state) {
  if (state.knot.overrides(id_)) join(state.knot);
}

void Knot::hear(const JointPlanMessage& plan) {
  if (plan.knot.overrides(id_)) join(plan.knot);
  if (plan.knot == id_) plan_ = plan;
}

void Knot::call(double now) {
  join({id_.epoch + 1, robot_});
  holding_since_ = now;
}

void Knot::hold(std::span<const FleetMember> fleet, const ClearanceField& field, double acceleration,
                double period, double now) {
  if (!holding_since_) holding_since_ = now;
  const auto self = std::ranges::find(fleet, robot_, &FleetMember::robot);
  if (plan_ && plan_->knot == id_) {
    if (!self->stands) return;
    take_up(*plan_, *self, gap_periods * acceleration * period * period);
    last_progress_ = 0;
    last_progress_time_ = now;
    return;
  }
  if (id_.leader == robot_) {
    lead(fleet, field);
    return;
  }
  const auto leader = std::ranges::find(fleet, id_.leader, &FleetMember::robot);
  const bool leaderless = leader == fleet.end() || leader->silent;
  if ((leaderless && now - *holding_since_ > 1) || now - *holding_since_ > longest_hold) call(now);
}

/// Plans as soon as everybody alive holds in this knot and stands, a little in each control period.
void Knot::lead(std::span<const FleetMember> fleet, const ClearanceField& field) {
  if (planner_) {
    if (planner_->step()) publish();
    return;
  }
  const bool ready = std::ranges::all_of(fleet, [&](const FleetMember& m) {
    return m.silent || (m.stands && m.knot == id_ && m.stage == Stage::holding);
  });
  if (!ready) return;
  led_.assign(fleet.begin(), fleet.end());
  std::vector<JointTask> tasks;
  for (const FleetMember& m : led_)
    tasks.push_back({m.position, m.silent ? m.position : m.goal, m.radius, !m.silent});
  planner_ = std::make_unique<JointPlanner>(field, std::move(tasks), Random(id_.epoch));
}

void Knot::publish() {
  const JointPlan& plan = planner_->plan();
  JointPlanMessage message{.knot = id_, .members = {}, .moves = {}};
  for (const FleetMember& m : led_) message.members.push_back({m.robot, m.radius, false});
  for (const std::size_t i : plan.stranded) message.members[i].stranded = true;
  for (const Move& move : plan.moves)
    message.moves.push_back({static_cast<std::uint32_t>(move.robot), move.path});
  planner_.reset();
  plan_ = message;
  own_plan_ = std::move(message);
}

std::optional<JointPlanMessage> Knot::take_own_plan() {
  return std::exchange(own_plan_, std::nullopt);
}

void Knot::take_up(const JointPlanMessage& plan, const FleetMember& self, double gap) {
  stage_ = Stage::free;
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
  std::vector<Move> moves;
  for (const JointPlanMessage::Move& move : plan.moves) moves.push_back({move.member, move.path});
  const std::vector<Path> legs = legs_of(index, moves);
  if (legs.empty() || (legs.front().front() - self.position).norm() > same_place) return;
  follower_.emplace(legs, gates_of(index, moves, radii, gap), self.radius);
  stage_ = Stage::ordered;
}

Point2 Knot::preferred_velocity(std::span<const FleetMember> fleet, const Point2& position,
                                const Limits& limits, double period, double now) {
  const auto member = [&](std::size_t index) {
    return std::ranges::find(fleet, members_[index], &FleetMember::robot);
  };
  const auto passed = [&](std::size_t index) {
    const auto other = member(index);
    if (other == fleet.end() || other->knot != id_ || other->stage == Stage::holding) return 0.0;
    return other->stage == Stage::ordered ? other->progress : std::numeric_limits<double>::infinity();
  };
  const Point2 wanted = follower_->preferred_velocity(position, limits, period, passed);
  const auto waits = follower_->waits_for();
  waits_for_ = waits ? members_[*waits] : RobotName();
  const bool will_pass = waits && member(*waits) != fleet.end() && !member(*waits)->silent;
  if (follower_->progress() > last_progress_ || will_pass) {
    last_progress_ = follower_->progress();
    last_progress_time_ = now;
  }
  const bool stands = std::ranges::find(fleet, robot_, &FleetMember::robot)->stands;
  if (follower_->finished() && stands) {
    stage_ = Stage::free;
  } else if (now - last_progress_time_ > patience) {
    call(now);
    return Point2::Zero();
  }
  return wanted;
}

void Knot::executed(const Point2& velocity) {
  if (follower_) follower_->executed(velocity);
}

}  // namespace coppice
