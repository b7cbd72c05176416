#include "dds/static_endpoints.h"

#include <string_view>

#include <fmt/format.h>

#include "dds/conversion.h"
#include "messages/topics.h"

namespace coppice {

namespace {

/// Format: Fast DDS 2.9, "STATIC Discovery Settings".
template <class M>
std::string endpoint(std::string_view kind, std::uint16_t id) {
  constexpr TopicInfo info = Topic<M>::info;
  typename DdsType<M>::Support type;
  return fmt::format(
      "<{0}><userId>{1}</userId><entityID>{1}</entityID><topicName>{2}</topicName>"
      "<topicDataType>{3}</topicDataType><topicKind>{4}</topicKind>"
      "<reliabilityQos>{5}</reliabilityQos><durabilityQos>{6}</durabilityQos></{0}>",
      kind, id, info.name, type.getName(), type.m_isGetKeyDefined ? "WITH_KEY" : "NO_KEY",
      info.reliability == Reliability::reliable ? "RELIABLE_RELIABILITY_QOS" : "BEST_EFFORT_RELIABILITY_QOS",
      info.durability == Durability::transient_local ? "TRANSIENT_LOCAL_DURABILITY_QOS"
                                                     : "VOLATILE_DURABILITY_QOS");
}

template <class M>
std::string counterparts(Role role) {
  std::string all;
  if (Topic<M>::read_by(role)) all += endpoint<M>("writer", writer_id<M>());
  if (Topic<M>::written_by(role)) all += endpoint<M>("reader", reader_id<M>());
  return all;
}

template <class... Ms>
std::string counterparts_of(Role role, const std::variant<Ms...>*) {
  return (counterparts<Ms>(role) + ...);
}

}  // namespace

std::string static_endpoints(Role role) {
  return fmt::format("<staticdiscovery><participant><name>{}</name>{}</participant></staticdiscovery>",
                     static_participant, counterparts_of(role, static_cast<const Message*>(nullptr)));
}

}  // namespace coppice
