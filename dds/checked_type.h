// Makes a type that fastddsgen generated safe to use. A generated type lets some exceptions of Fast CDR pass
// (for a boolean that is neither 0 nor 1, or an unknown encapsulation). In a thread of DDS that ends the
// process. It also computes keys in a buffer that the writing and the receiving threads share.
#pragma once

#include <mutex>

#include <fastcdr/exceptions/Exception.h>
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/common/SerializedPayload.h>

namespace coppice {

/// True if the bytes are a sample of the generated type and no longer than its longest sample. Never throws.
template <class Support>
bool deserialized(Support& type, eprosima::fastrtps::rtps::SerializedPayload_t* bytes, void* data) {
  try {
    return bytes->length <= type.m_typeSize && type.Support::deserialize(bytes, data);
  } catch (const eprosima::fastcdr::exception::Exception&) {  // treated like a sample that is too short
    return false;
  }
}

/// `Support`: the generated support of one topic's type.
template <class Support>
class CheckedType final : public Support {
 public:
  /// Bytes that are no sample, or that are longer than any sample, become a sample without a name. Validation
  /// (messages/validation.h) refuses and counts it like any other invalid sample.
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* bytes, void* data) override {
    if (!deserialized<Support>(*this, bytes, data)) *static_cast<typename Support::type*>(data) = {};
    return true;
  }

  /// Locked, because two threads that share the buffer would each read the other's key.
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* key, bool force_md5) override {
    const std::lock_guard lock(key_);
    return Support::getKey(data, key, force_md5);
  }

 private:
  std::mutex key_;
};

}  // namespace coppice
