#include "tree_broker/forest_record.h"

#include <variant>

namespace coppice {

void ForestRecord::recall(std::span<const Message> kept) {
  for (const Message& message : kept) heard(message);
}

Keep ForestRecord::heard(const Message& message) {
  if (const auto* map = std::get_if<MapMessage>(&message); map != nullptr && map->map_id != map_id_) {
    map_id_ = map->map_id;
    trees_.clear();
    covered_ = false;
    return Keep::begin_anew;
  }
  if (const auto* status = std::get_if<BrokerStatus>(&message)) {
    const bool covers = status->covered_map == map_id_ && !map_id_.empty() && !covered_;
    covered_ = covered_ || covers;
    return covers ? Keep::append : Keep::nothing;
  }
  const auto* trees = std::get_if<InactiveTreesMessage>(&message);
  const bool is_new = trees != nullptr && trees->map_id == map_id_ && trees_.insert(trees->id).second;
  return is_new ? Keep::append : Keep::nothing;
}

}  // namespace coppice
