#include "robot_agent/claimant.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace coppice {

namespace {

constexpr WallTime ask_period = 0.5;
// An answer that comes later leaves too little of the lease to be heard as the robot.
constexpr WallTime answer_counts = claim_lease / 2;
constexpr WallTime own_lease =
    0.8 * claim_lease;         // of silence: shorter than the service's count by any delay
constexpr WallTime quiet = 1;  // so long nobody else may have been heard as the robot

}  // namespace

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
  if (asked == asked_.end() || now - asked->at > answer_counts) return false;
  const auto spoke = spoke_.find(offer.robot);
  return spoke == spoke_.end() || now - spoke->second > quiet;
}

void Claimant::count_silence(WallTime now) {
  const WallTime silent_for = now - std::exchange(last_sign_, now).value_or(now);
  lost_ = lost_ || (robot_ && silent_for > own_lease);
  if (silent_for >= 0) return;
  // The clock was set back: when it asked, and when others spoke, is known no more.
  asked_.clear();
  for (auto& [robot, at] : spoke_) at = now;
}

Claim Claimant::claim(WallTime now) {
  count_silence(now);
  asked_.push_back({++number_, now});
  while (now - asked_.front().at > answer_counts) asked_.pop_front();
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
  } else if (asked_.empty() || now - asked_.back().at >= ask_period) {
    out.emplace_back(claim(now));
    next_wake_ = now + ask_period;
  } else {
    next_wake_ = asked_.back().at + ask_period;
  }
  return out;
}

}  // namespace coppice
