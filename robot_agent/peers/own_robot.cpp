#include "robot_agent/peers/own_robot.h"

#include "robot_agent/timing.h"

namespace coppice {

void OwnRobot::wait_in(const RoundId& round, const PeerTable& peers) {
  if (round.epoch == 0) {
    wait = WaitsInNoRound{};
  } else if (round.leader == name) {
    wait = Leads{round};
  } else {
    wait = Follows{round, peers.find(round.leader)};
  }
}

const RoundId* OwnRobot::awaited_round() const {
  if (const auto* leads = std::get_if<Leads>(&wait)) return &leads->round;
  if (const auto* follows = std::get_if<Follows>(&wait)) return &follows->round;
  return nullptr;
}

bool OwnRobot::hears_about_round_from(const Peer& p) const {
  const RoundId* const round = awaited_round();
  if (round == nullptr || !p.state || p.state->stage != Stage::waiting) return false;
  const bool one_leads = std::holds_alternative<Leads>(wait) || round->leader == p.robot;
  return one_leads && p.state->round == *round;
}

bool OwnRobot::is_from_the_future(double stamp, const Peer& p, double now) const {
  return p.clock.known() &&
         stamp > now - p.clock.estimate() + p.clock.error(now) + Timing::set_clock * second();
}

}  // namespace coppice
