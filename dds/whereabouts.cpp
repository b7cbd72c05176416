#include "dds/whereabouts.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include <fastrtps/utils/IPLocator.h>

namespace coppice {

namespace rtps = eprosima::fastrtps::rtps;

namespace {

constexpr const char* loopback = "127.0.0.1";

in_addr ipv4_of(const rtps::Locator_t& address) {
  in_addr ipv4{};
  std::memcpy(&ipv4, rtps::IPLocator::getIPv4(address), sizeof ipv4);
  return ipv4;
}

bool is_at(const rtps::Locator_t& address, const rtps::Locator_t& source) {
  return ipv4_of(address).s_addr == ipv4_of(source).s_addr;
}

}  // namespace

void Whereabouts::discover(const rtps::ParticipantDiscoveryInfo& info) {
  const bool gone = info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
                    info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT;
  const std::scoped_lock lock(mutex_);
  if (gone) {
    known_.erase(info.info.m_guid.guidPrefix);
    return change();
  }
  Known& known = known_[info.info.m_guid.guidPrefix];
  for (const auto& locators : {info.info.metatraffic_locators.unicast, info.info.default_locators.unicast}) {
    for (const Address& address : locators) {
      if (std::ranges::count(known.announced, address) == 0) known.announced.push_back(address);
    }
  }
  known.moved = is_elsewhere(known);
  change();
}

void Whereabouts::hear(const Participant& participant, const Address& source) {
  if (source.kind != LOCATOR_KIND_UDPv4) return;
  const std::scoped_lock lock(mutex_);
  const std::uint64_t changes = own_.changes();
  if (std::exchange(as_of_, changes) != changes) look_anew();
  const auto entry = known_.find(participant);
  if (entry == known_.end()) return;
  Known& known = entry->second;
  if (known.source && is_at(*known.source, source)) return;
  known.source = source;
  const bool before = std::exchange(known.moved, is_elsewhere(known));
  if (known.moved || before) change();
}

/// A participant of this host is reached at any address of this host.
bool Whereabouts::is_elsewhere(const Known& known) {
  if (!known.source) return false;
  const bool is_here = own_.is_own(ipv4_of(*known.source));
  return std::ranges::none_of(known.announced, [&](const Address& a) {
    return is_here ? own_.is_own(ipv4_of(a)) : is_at(a, *known.source);
  });
}

/// The networks of this host have changed.
void Whereabouts::look_anew() {
  for (auto& [participant, known] : known_) known.moved = is_elsewhere(known);
  change();
}

void Whereabouts::change() {
  ways_.clear();
  for (const auto& [participant, known] : known_) {
    if (!known.moved) continue;
    const bool is_here = own_.is_own(ipv4_of(*known.source));
    for (const Address& announced : known.announced) {
      Address present = announced;
      if (is_here)
        rtps::IPLocator::setIPv4(present, loopback);
      else
        rtps::IPLocator::setIPv4(present, rtps::IPLocator::getIPv4(*known.source));
      Ways& ways = ways_[announced];
      if (std::ranges::count(ways.present, present) == 0) ways.present.push_back(present);
      ways.announced_is_void = is_here && !is_secure_;
    }
  }
  // Where another participant has an address now, it is not void.
  for (const auto& [participant, known] : known_) {
    if (known.moved) continue;
    for (const Address& announced : known.announced) {
      if (const auto ways = ways_.find(announced); ways != ways_.end())
        ways->second.announced_is_void = false;
    }
  }
  some_moved_ = !ways_.empty();
}

std::vector<Whereabouts::Address> Whereabouts::present_of(
    eprosima::fastdds::rtps::LocatorList& addresses) const {
  if (!some_moved_) return {};
  eprosima::fastdds::rtps::LocatorList valid;
  std::vector<Address> present;
  const std::scoped_lock lock(mutex_);
  for (const Address& address : addresses) {
    const auto ways = ways_.find(address);
    if (ways == ways_.end() || !ways->second.announced_is_void) valid.push_back(address);
    if (ways == ways_.end()) continue;
    for (const Address& there : ways->second.present) {
      if (std::ranges::count(present, there) == 0) present.push_back(there);
    }
  }
  addresses = valid;
  return present;
}

}  // namespace coppice
