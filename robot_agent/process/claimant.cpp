#include "robot_agent/process/claimant.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "robot_agent/timing.h"

namespace coppice {

void Claimant::on(const Arrival& arrival) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, arrival.at); }) receive(m, arrival.at);
      },
      *arrival.message);
}

void Claimant::receive(const Assignment& assignment, WallTime now) {
  const bool mine = assignment.claimant == id_;
  if (robot_) {
    lost_ = lost_ || (assignment.robot == *robot_ && !mine);
  } else if (mine) {
    offer_ = assignment;
    next_wake_ = std::min(next_wake_, now);
  } else if (offer_ && offer_->robot == assignment.robot) {
    offer_.reset();
  }
}

void Claimant::receive(const RobotState& state, WallTime now) {
  if (!robot_ && !state.passed_on) spoke_[state.robot] = now;
}

bool Claimant::may_take(const Assignment& offer, WallTime now) const {
  const auto asked = std::ranges::find(asked_, offer.number, &Asked::number);
  if (asked == asked_.end() || now - asked->at > Timing::answer_counts) return false;
  const auto spoke = spoke_.find(offer.robot);
  return spoke == spoke_.end() || now - spoke->second > Timing::quiet_robot;
}

void Claimant::count_silence(WallTime now) {
  const WallTime silent_for = now - std::exchange(last_sign_, now).value_or(now);
  lost_ = lost_ || (robot_ && silent_for > Timing::own_claim_lease);
}

Claim Claimant::claim(WallTime now) {
  count_silence(now);
  asked_.push_back({++number_, now});
  while (now - asked_.front().at > Timing::answer_counts) asked_.pop_front();
  return {.claimant = id_, .number = number_, .robot = robot_.value_or(RobotName())};
}

std::vector<Outgoing> Claimant::step(WallTime now) {
  std::vector<Outgoing> out;
  count_silence(now);
  if (robot_) return out;
  if (offer_ && may_take(*offer_, now)) {
    robot_ = offer_->robot;
    out.emplace_back(claim(now));
    spoke_.clear();
    next_wake_ = std::numeric_limits<WallTime>::infinity();
  } else if (asked_.empty() || now - asked_.back().at >= Timing::claim_period) {
    out.emplace_back(claim(now));
    next_wake_ = now + Timing::claim_period;
  } else {
    next_wake_ = asked_.back().at + Timing::claim_period;
  }
  return out;
}

}  // namespace coppice
