#include "planner_service/claim_desk.h"

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

ClaimDesk::ClaimDesk(const std::vector<RobotName>& robots, WallTime now) : last_step_(now), next_wake_(now) {
  for (const RobotName& robot : robots) {
    seat_of_.emplace(robot, seats_.size());
    seats_.push_back({.robot = robot, .heard = now - claim_lease + settle});
  }
}

void ClaimDesk::on(const Arrival& arrival) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, arrival.at); }) receive(m, arrival.at);
      },
      *arrival.message);
}

void ClaimDesk::recall(std::span<const Message> kept, WallTime now) {
  for (const Message& message : kept) {
    if (const auto* status = std::get_if<AgentStatus>(&message)) receive(*status, now);
  }
}

void ClaimDesk::receive(const AgentStatus& status, WallTime now) {
  const auto known = seat_of_.find(status.robot);
  if (known == seat_of_.end()) return;
  Seat& seat = seats_[known->second];
  seat.heard = now;
  seat.spoken_for = true;
}

void ClaimDesk::receive(const Claim& claim, WallTime now) {
  next_wake_ = std::min(next_wake_, now);
  if (!claim.robot.empty()) return take_up(claim, now);
  Seat* const given = seat_given_to(claim.claimant);
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
void ClaimDesk::take_up(const Claim& claim, WallTime now) {
  std::erase_if(waiting_, [&](const Waiting& w) { return w.claimant == claim.claimant; });
  for (Seat& seat : seats_) {
    if (seat.claimant == claim.claimant && seat.robot != claim.robot) seat.claimant = 0;
  }
  const auto known = seat_of_.find(claim.robot);
  if (known == seat_of_.end()) return;
  Seat& seat = seats_[known->second];
  if (seat.claimant != 0 && seat.claimant != claim.claimant) {
    // It has lost it, and may not have heard of that: a desk before this one gave it away.
    seat.answer_due = true;
    return;
  }
  seat.claimant = claim.claimant;
  seat.number = claim.number;
  seat.taken_up = true;
  seat.answer_due = false;
  seat.heard = now;
}

void ClaimDesk::wait(const Claim& claim, WallTime now) {
  const auto known = std::ranges::find(waiting_, claim.claimant, &Waiting::claimant);
  if (known == waiting_.end()) {
    if (waiting_.size() < most_waiting) waiting_.push_back({claim.claimant, claim.number, now});
  } else if (claim.number > known->number) {
    known->number = claim.number;
    known->heard = now;
  }
}

ClaimDesk::Seat* ClaimDesk::seat_given_to(std::uint64_t claimant) {
  const auto seat = std::ranges::find(seats_, claimant, &Seat::claimant);
  return seat == seats_.end() ? nullptr : &*seat;
}

ClaimDesk::Seat* ClaimDesk::free_seat(WallTime now) {
  const auto seat = std::ranges::find_if(seats_, [&](const Seat& s) { return now - s.heard > claim_lease; });
  return seat == seats_.end() ? nullptr : &*seat;
}

/// After a nap each robot was heard of so long ago as before; and where the clock was set back, none later
/// than now.
void ClaimDesk::follow_clock(WallTime now) {
  const WallTime slept = now - std::exchange(last_step_, now);
  for (Seat& seat : seats_) seat.heard = std::min(now, seat.heard + (slept > longest_nap ? slept : 0));
  for (Waiting& claimant : waiting_) claimant.heard = std::min(now, claimant.heard);
}

std::vector<Message> ClaimDesk::step(WallTime now) {
  follow_clock(now);
  std::erase_if(waiting_, [&](const Waiting& w) { return now - w.heard > patience; });
  while (!waiting_.empty()) {
    Seat* const seat = free_seat(now);
    if (seat == nullptr) break;
    *seat = {.robot = seat->robot,
             .claimant = waiting_.front().claimant,
             .number = waiting_.front().number,
             .answer_due = true,
             .heard = waiting_.front().heard};
    waiting_.erase(waiting_.begin());
  }
  std::vector<Message> out;
  for (Seat& seat : seats_) {
    if (seat.answer_due) out.emplace_back(Assignment{seat.robot, seat.claimant, seat.number});
    seat.answer_due = false;
  }
  next_wake_ = waiting_.empty() ? std::numeric_limits<WallTime>::infinity() : now + beat;
  return out;
}

}  // namespace coppice
