#include "robot_agent/peers/peer_table.h"

#include <utility>

#include "planning/quantities.h"
#include "robot_agent/peers/send_interval.h"

namespace coppice {

/// New names cost memory and time for ever. A fleet has no more robots than this.
bool PeerTable::has_room_for(const RobotName& robot) const {
  return peers_.size() < most_robots || index_.find(robot).has_value();
}

std::pair<std::size_t, bool> PeerTable::find_or_add(const RobotName& robot) {
  const auto [number, is_new] = index_.insert(robot);
  if (is_new) {
    const auto phase = static_cast<std::uint8_t>(phase_of(robot));
    peers_.push_back({.exchange = {.phase = phase}, .robot = robot});
    away_until.push_back(0);
    told_from.push_back(0);
    answered_until.push_back(0);
  }
  return {number, is_new};
}

std::vector<Peer> PeerTable::take_all() {
  index_ = {};
  away_until.clear();
  told_from.clear();
  answered_until.clear();
  return std::exchange(peers_, {});
}

}  // namespace coppice
