// A generated type that no bytes can make throw: what fastddsgen makes passes on some of the exceptions of
// Fast CDR (a boolean that is neither 0 nor 1, an unknown encapsulation), also in DDS's own threads, where
// that ends the process.
#pragma once

#include <fastcdr/exceptions/Exception.h>
#include <fastdds/rtps/common/SerializedPayload.h>

namespace coppice {

/// `Support`: generated, of one topic.
template <class Support>
class CheckedType final : public Support {
 public:
  /// A sample of bytes that are none, or more than any sample takes, is one without a name: validation.h
  /// refuses it, so that it is counted as others are.
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* bytes, void* data) override {
    try {
      if (bytes->length <= this->m_typeSize && Support::deserialize(bytes, data)) return true;
    } catch (const eprosima::fastcdr::exception::Exception&) {  // as if it were too short
    }
    *static_cast<typename Support::type*>(data) = {};
    return true;
  }
};

}  // namespace coppice
