#include "planner_service/run/robot_assignment.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "planner_service/timing.h"

namespace coppice {

namespace {

constexpr std::size_t most_waiting = 10'000;  // further claims are ignored until some of these have gone

}  // namespace

RobotAssignment::RobotAssignment(const std::vector<RobotName>& robots, WallTime now)
    : last_step_(now), next_wake_(now) {
  for (const RobotName& robot : robots) {
    index_.emplace(robot, leases_.size());
    leases_.push_back({.robot = robot, .heard_at = now - claim_lease + service_timing.assignment_settling});
  }
}

void RobotAssignment::on(const Arrival& arrival) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, arrival.at); }) receive(m, arrival.at);
      },
      *arrival.message);
}

void RobotAssignment::recall(std::span<const Message> saved, WallTime now) {
  for (const Message& message : saved) {
    if (const auto* status = std::get_if<AgentStatus>(&message)) receive(*status, now);
  }
}

void RobotAssignment::receive(const AgentStatus& status, WallTime now) {
  const auto known = index_.find(status.robot);
  if (known == index_.end()) return;
  Lease& lease = leases_[known->second];
  lease.heard_at = now;
  if (lease.holder && lease.holder->stage == Stage::offered) lease.holder->stage = Stage::contested;
}

void RobotAssignment::receive(const Claim& claim, WallTime now) {
  next_wake_ = std::min(next_wake_, now);
  if (!claim.robot.empty()) return confirm(claim, now);
  Lease* const lease = lease_of(claim.claimant);
  if (lease == nullptr) return wait(claim, now);
  Holder& holder = *lease->holder;
  if (claim.number <= holder.number) return;  // a repetition
  holder.number = claim.number;
  switch (holder.stage) {
    case Stage::confirmed:
      return;
    case Stage::contested:  // by another agent, for this one still asks
      lease->holder.reset();
      return wait(claim, now);
    case Stage::offered:
      lease->heard_at = now;
      holder.answer_due = true;
  }
}

/// The claimant knows which robot it is, from this service or from one before.
void RobotAssignment::confirm(const Claim& claim, WallTime now) {
  std::erase_if(waiting_, [&](const Waiting& w) { return w.claimant == claim.claimant; });
  for (Lease& lease : leases_) {
    if (lease.holder && lease.holder->claimant == claim.claimant && lease.robot != claim.robot)
      lease.holder.reset();
  }
  const auto known = index_.find(claim.robot);
  if (known == index_.end()) return;
  Lease& lease = leases_[known->second];
  if (lease.holder && lease.holder->claimant != claim.claimant) {
    // The claimant has lost the robot and may not have heard of it: a service before this one assigned the
    // robot to another agent.
    lease.holder->answer_due = true;
    return;
  }
  lease.holder = Holder{.claimant = claim.claimant, .number = claim.number, .stage = Stage::confirmed};
  lease.heard_at = now;
}

void RobotAssignment::wait(const Claim& claim, WallTime now) {
  const auto known = std::ranges::find(waiting_, claim.claimant, &Waiting::claimant);
  if (known == waiting_.end()) {
    if (waiting_.size() < most_waiting) waiting_.push_back({claim.claimant, claim.number, now});
  } else if (claim.number > known->number) {
    known->number = claim.number;
    known->heard_at = now;
  }
}

RobotAssignment::Lease* RobotAssignment::lease_of(std::uint64_t claimant) {
  const auto lease = std::ranges::find_if(
      leases_, [&](const Lease& l) { return l.holder && l.holder->claimant == claimant; });
  return lease == leases_.end() ? nullptr : &*lease;
}

RobotAssignment::Lease* RobotAssignment::free_lease(WallTime now) {
  const auto lease =
      std::ranges::find_if(leases_, [&](const Lease& l) { return now - l.heard_at > claim_lease; });
  return lease == leases_.end() ? nullptr : &*lease;
}

/// A pause of this process is no silence of the robots.
void RobotAssignment::follow_clock(WallTime now) {
  const WallTime gap = now - std::exchange(last_step_, now);
  const WallTime paused = gap > service_timing.longest_step_gap ? gap : 0;
  for (Lease& lease : leases_) lease.heard_at = std::min(now, lease.heard_at + paused);
}

std::vector<Message> RobotAssignment::step(WallTime now) {
  follow_clock(now);
  std::erase_if(waiting_, [&](const Waiting& w) { return now - w.heard_at > service_timing.claim_patience; });
  while (!waiting_.empty()) {
    Lease* const lease = free_lease(now);
    if (lease == nullptr) break;
    const Waiting& first = waiting_.front();
    lease->holder = Holder{.claimant = first.claimant, .number = first.number, .answer_due = true};
    lease->heard_at = first.heard_at;
    waiting_.erase(waiting_.begin());
  }
  std::vector<Message> out;
  for (Lease& lease : leases_) {
    if (lease.holder && std::exchange(lease.holder->answer_due, false))
      out.emplace_back(Assignment{lease.robot, lease.holder->claimant, lease.holder->number});
  }
  next_wake_ =
      waiting_.empty() ? std::numeric_limits<WallTime>::infinity() : now + service_timing.assignment_interval;
  return out;
}

}  // namespace coppice
