#include "planner_service/robot_assignment.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace coppice {

namespace {

// So long after its start the desk gives nothing away: agents that know who they are may have been there
// before.
constexpr WallTime settle = 2;
constexpr WallTime beat = 0.1;
constexpr WallTime longest_nap = 1;             // between two steps: while it sleeps longer nobody is silent
constexpr WallTime patience = claim_lease / 2;  // who waits says so more often than that
constexpr std::size_t most_waiting = 10'000;    // more are told nothing until these have gone

}  // namespace

RobotAssignment::RobotAssignment(const std::vector<RobotName>& robots, WallTime now)
    : last_step_(now), next_wake_(now) {
  for (const RobotName& robot : robots) {
    lease_of_.emplace(robot, leases_.size());
    leases_.push_back({.robot = robot, .heard = now - claim_lease + settle});
  }
}

void RobotAssignment::on(const Arrival& arrival) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, arrival.at); }) receive(m, arrival.at);
      },
      *arrival.message);
}

void RobotAssignment::recall(std::span<const Message> kept, WallTime now) {
  for (const Message& message : kept) {
    if (const auto* status = std::get_if<AgentStatus>(&message)) receive(*status, now);
  }
}

void RobotAssignment::receive(const AgentStatus& status, WallTime now) {
  const auto known = lease_of_.find(status.robot);
  if (known == lease_of_.end()) return;
  Lease& lease = leases_[known->second];
  lease.heard = now;
  lease.spoken_for = true;
}

void RobotAssignment::receive(const Claim& claim, WallTime now) {
  next_wake_ = std::min(next_wake_, now);
  if (!claim.robot.empty()) return take_up(claim, now);
  Lease* const given = lease_given_to(claim.claimant);
  if (given == nullptr) return wait(claim, now);
  if (claim.number <= given->number) return;  // a repetition
  given->number = claim.number;
  if (given->taken_up) return;
  if (given->spoken_for) {  // by another, since this one still asks
    given->claimant = 0;
    return wait(claim, now);
  }
  given->heard = now;
  given->answer_due = true;
}

/// It knows which robot it is: from this desk, or from one before.
void RobotAssignment::take_up(const Claim& claim, WallTime now) {
  std::erase_if(waiting_, [&](const Waiting& w) { return w.claimant == claim.claimant; });
  for (Lease& lease : leases_) {
    if (lease.claimant == claim.claimant && lease.robot != claim.robot) lease.claimant = 0;
  }
  const auto known = lease_of_.find(claim.robot);
  if (known == lease_of_.end()) return;
  Lease& lease = leases_[known->second];
  if (lease.claimant != 0 && lease.claimant != claim.claimant) {
    // It has lost it, and may not have heard of that: a desk before this one gave it away.
    lease.answer_due = true;
    return;
  }
  lease.claimant = claim.claimant;
  lease.number = claim.number;
  lease.taken_up = true;
  lease.answer_due = false;
  lease.heard = now;
}

void RobotAssignment::wait(const Claim& claim, WallTime now) {
  const auto known = std::ranges::find(waiting_, claim.claimant, &Waiting::claimant);
  if (known == waiting_.end()) {
    if (waiting_.size() < most_waiting) waiting_.push_back({claim.claimant, claim.number, now});
  } else if (claim.number > known->number) {
    known->number = claim.number;
    known->heard = now;
  }
}

RobotAssignment::Lease* RobotAssignment::lease_given_to(std::uint64_t claimant) {
  const auto lease = std::ranges::find(leases_, claimant, &Lease::claimant);
  return lease == leases_.end() ? nullptr : &*lease;
}

RobotAssignment::Lease* RobotAssignment::free_lease(WallTime now) {
  const auto lease =
      std::ranges::find_if(leases_, [&](const Lease& s) { return now - s.heard > claim_lease; });
  return lease == leases_.end() ? nullptr : &*lease;
}

/// After a nap each robot was heard of so long ago as before; and where the clock was set back, none later
/// than now.
void RobotAssignment::follow_clock(WallTime now) {
  const WallTime slept = now - std::exchange(last_step_, now);
  for (Lease& lease : leases_) lease.heard = std::min(now, lease.heard + (slept > longest_nap ? slept : 0));
  for (Waiting& claimant : waiting_) claimant.heard = std::min(now, claimant.heard);
}

std::vector<Message> RobotAssignment::step(WallTime now) {
  follow_clock(now);
  std::erase_if(waiting_, [&](const Waiting& w) { return now - w.heard > patience; });
  while (!waiting_.empty()) {
    Lease* const lease = free_lease(now);
    if (lease == nullptr) break;
    *lease = {.robot = lease->robot,
              .claimant = waiting_.front().claimant,
              .number = waiting_.front().number,
              .answer_due = true,
              .heard = waiting_.front().heard};
    waiting_.erase(waiting_.begin());
  }
  std::vector<Message> out;
  for (Lease& lease : leases_) {
    if (lease.answer_due) out.emplace_back(Assignment{lease.robot, lease.claimant, lease.number});
    lease.answer_due = false;
  }
  next_wake_ = waiting_.empty() ? std::numeric_limits<WallTime>::infinity() : now + beat;
  return out;
}

}  // namespace coppice
