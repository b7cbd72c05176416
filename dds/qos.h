// What the endpoints of all topics have in common.
#pragma once

#include <stdexcept>
#include <string>

#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/rtps/common/Time_t.h>

#include "messages/fleet_clock.h"
#include "messages/topics.h"

namespace coppice {

/// Of a host, in all its networks: Fast DDS makes room for so many with each endpoint, and drops the rest
/// without a word; its own four are soon those of bridges to containers.
inline constexpr std::size_t most_addresses = 16;

// Each remote writer and reader that is met has room for so many set aside: a service meets a thousand.
inline constexpr int samples_at_first = 2;

template <class T>
T* required(T* created, const char* what) {
  if (created == nullptr) throw std::runtime_error(std::string("DDS could not create ") + what);
  return created;
}

inline WallTime seconds(const eprosima::fastrtps::rtps::Time_t& time) {
  return time.seconds() + 1e-9 * time.nanosec();
}

/// What a topic's row in the table means for a writer and for a reader alike.
template <class Qos>
void apply(const TopicInfo& info, Qos& qos) {
  namespace dds = eprosima::fastdds::dds;
  qos.reliability().kind = info.reliability == Reliability::reliable ? dds::RELIABLE_RELIABILITY_QOS
                                                                     : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = info.durability == Durability::transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS
                                                                         : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = info.depth > 0 ? dds::KEEP_LAST_HISTORY_QOS : dds::KEEP_ALL_HISTORY_QOS;
  qos.history().depth = info.depth > 0 ? info.depth : 1;
  // 0 is no limit; the defaults (10 instances, 5000 samples) would silently lose trees and robots.
  qos.resource_limits().max_samples = 0;
  qos.resource_limits().max_instances = 0;
  qos.resource_limits().max_samples_per_instance = 0;
  qos.resource_limits().allocated_samples = samples_at_first;
  // Samples differ in size by orders of magnitude: memory as needed, not for the largest.
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  qos.data_sharing().off();
}

}  // namespace coppice
