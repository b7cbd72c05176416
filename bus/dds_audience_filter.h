// Lets a writer choose, sample by sample, which of its readers it is for: a content filter of DDS that asks
// not for the content but for the audience (Outgoing::agents).
//
// A reader names itself as the filter's parameter; the writer's side looks it up among those whom it is about
// to speak to. So nothing is announced anew when the audience changes, and what is not for a reader is not
// even sent to it.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fastdds/dds/topic/IContentFilter.hpp>
#include <fastdds/dds/topic/IContentFilterFactory.hpp>

#include "bus/messages.h"

namespace coppice {

class AudienceFilter final : public eprosima::fastdds::dds::IContentFilterFactory {
 public:
  static constexpr const char* name = "COPPICE_AUDIENCE";

  /// `own`: what this process's reader is named; it has passed the writer's filter.
  explicit AudienceFilter(std::string own) : own_(std::move(own)) {}

  /// Of the next samples that are written; none: everybody.
  void set_audience(std::optional<std::vector<RobotName>> agents) {
    if (agents) std::ranges::sort(*agents);
    const std::scoped_lock lock(mutex_);
    agents_ = std::move(agents);
  }

  ReturnCode_t create_content_filter(const char*, const char*, const eprosima::fastdds::dds::TopicDataType*,
                                     const char*, const ParameterSeq& parameters,
                                     eprosima::fastdds::dds::IContentFilter*& instance) override {
    if (parameters.length() != 1) return ReturnCode_t::RETCODE_BAD_PARAMETER;
    delete static_cast<Reader*>(instance);  // NOLINT(cppcoreguidelines-owning-memory): the interface's way
    instance = new Reader(*this, parameters[0]);  // NOLINT(cppcoreguidelines-owning-memory)
    return ReturnCode_t::RETCODE_OK;
  }
  ReturnCode_t delete_content_filter(const char*, eprosima::fastdds::dds::IContentFilter* instance) override {
    delete static_cast<Reader*>(instance);  // NOLINT(cppcoreguidelines-owning-memory)
    return ReturnCode_t::RETCODE_OK;
  }

 private:
  struct Reader final : eprosima::fastdds::dds::IContentFilter {
    Reader(const AudienceFilter& f, std::string r) : filter(f), robot(std::move(r)) {}
    bool evaluate(const SerializedPayload&, const FilterSampleInfo&, const GUID_t&) const override {
      return filter.is_for(robot);
    }
    const AudienceFilter& filter;
    std::string robot;
  };

  bool is_for(const std::string& robot) const {
    if (robot == own_) return true;
    const std::scoped_lock lock(mutex_);
    return !agents_ || std::ranges::binary_search(*agents_, robot);
  }

  std::string own_;
  mutable std::mutex mutex_;  // DDS may ask in a thread of its own
  std::optional<std::vector<RobotName>> agents_;
};

}  // namespace coppice
