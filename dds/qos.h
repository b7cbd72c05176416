// Settings that the endpoints of all topics share.
#pragma once

#include <stdexcept>
#include <string>

#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/rtps/common/Time_t.h>

#include "messages/fleet_clock.h"
#include "messages/topics.h"

namespace coppice {

/// The most addresses of one host, in all its networks. Fast DDS reserves room for this many with each
/// endpoint and silently drops the rest. Its default of four is soon used up by bridges to containers.
inline constexpr std::size_t most_addresses = 16;

// Fast DDS reserves room for this many samples with each remote writer and reader. A service meets a
// thousand.
inline constexpr int samples_at_first = 2;

template <class T>
T* required(T* created, const char* what) {
  if (created == nullptr) throw std::runtime_error(std::string("DDS could not create ") + what);
  return created;
}

inline WallTime seconds(const eprosima::fastrtps::rtps::Time_t& time) {
  return time.seconds() + 1e-9 * time.nanosec();
}

/// Applies a topic's row of the table to the QoS of a writer or a reader.
template <class Qos>
void apply(const TopicInfo& info, Qos& qos) {
  namespace dds = eprosima::fastdds::dds;
  qos.reliability().kind = info.reliability == Reliability::reliable ? dds::RELIABLE_RELIABILITY_QOS
                                                                     : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = info.durability == Durability::transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS
                                                                         : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = info.depth > 0 ? dds::KEEP_LAST_HISTORY_QOS : dds::KEEP_ALL_HISTORY_QOS;
  qos.history().depth = info.depth > 0 ? info.depth : 1;
  // 0 is no limit. The defaults (10 instances, 5000 samples) would silently lose trees and robots.
  qos.resource_limits().max_samples = 0;
  qos.resource_limits().max_instances = 0;
  qos.resource_limits().max_samples_per_instance = 0;
  qos.resource_limits().allocated_samples = samples_at_first;
  // Samples differ in size by orders of magnitude, so memory is allocated as needed.
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  qos.data_sharing().off();
}

}  // namespace coppice
