#include "dds/senders.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dds/transport.h"

namespace coppice {

namespace rtps = eprosima::fastrtps::rtps;

namespace {

// The samples of a participant that has gone are taken within about one control period.
constexpr std::chrono::seconds remembered{60};

}  // namespace

void Senders::note_own(const rtps::GuidPrefix_t& participant, const RobotName& robot, bool replays) {
  const std::scoped_lock lock(mutex_);
  senders_[participant] = {robot, replays, std::nullopt};
}

void Senders::discover(const rtps::ParticipantDiscoveryInfo& info) {
  const Time now = std::chrono::steady_clock::now();
  const bool gone = info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
                    info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT;
  const std::scoped_lock lock(mutex_);
  std::erase_if(senders_, [&](const auto& entry) {
    return entry.second.gone_at && now - *entry.second.gone_at > remembered;
  });
  const auto [known, fresh] = senders_.try_emplace(info.info.m_guid.guidPrefix);
  Sender& sender = known->second;
  if (gone) {
    sender.gone_at = now;
    // An announcement that changes the robot of a participant that is still there is forged.
  } else if (fresh || sender.gone_at) {
    const std::vector<std::uint8_t> data(info.info.m_userData.begin(), info.info.m_userData.end());
    sender = {coppice::robot_of(data), data == user_data_of_replayer(), std::nullopt};
  }
}

bool Senders::somebody_replays() const {
  const std::scoped_lock lock(mutex_);
  return std::ranges::any_of(senders_,
                             [](const auto& entry) { return entry.second.replays && !entry.second.gone_at; });
}

bool Senders::replays(const rtps::GuidPrefix_t& participant) const {
  const std::scoped_lock lock(mutex_);
  const auto known = senders_.find(participant);
  return known != senders_.end() && known->second.replays;
}

std::optional<RobotName> Senders::robot_of(const rtps::GuidPrefix_t& participant) const {
  const std::scoped_lock lock(mutex_);
  const auto known = senders_.find(participant);
  return known == senders_.end() ? std::nullopt : std::optional(known->second.robot);
}

}  // namespace coppice
