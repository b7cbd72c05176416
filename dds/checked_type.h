// A generated type as DDS may use it: what fastddsgen makes lets some of the exceptions of Fast CDR pass (a
// boolean that is neither 0 nor 1, an unknown encapsulation), also in DDS's own threads, where that ends the
// process; and it works keys out in a buffer of its own, which the threads that write and receive share.
#pragma once

#include <mutex>

#include <fastcdr/exceptions/Exception.h>
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/common/SerializedPayload.h>

namespace coppice {

/// Whether the bytes are a sample of the generated type, and no more than any takes; never throws.
template <class Support>
bool deserialized(Support& type, eprosima::fastrtps::rtps::SerializedPayload_t* bytes, void* data) {
  try {
    return bytes->length <= type.m_typeSize && type.Support::deserialize(bytes, data);
  } catch (const eprosima::fastcdr::exception::Exception&) {  // as if it were too short
    return false;
  }
}

/// `Support`: generated, of one topic.
template <class Support>
class CheckedType final : public Support {
 public:
  /// A sample of bytes that are none, or more than any sample takes, is one without a name: validation.h
  /// refuses it, so that it is counted as others are.
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* bytes, void* data) override {
    if (!deserialized<Support>(*this, bytes, data)) *static_cast<typename Support::type*>(data) = {};
    return true;
  }

  /// One at a time: two at once would take each other's samples for their own.
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* key, bool force_md5) override {
    const std::lock_guard lock(key_);
    return Support::getKey(data, key, force_md5);
  }

 private:
  std::mutex key_;
};

}  // namespace coppice
