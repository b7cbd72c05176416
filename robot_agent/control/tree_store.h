// The inactive trees that an agent has received. All of them are of one map once that is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "messages/messages.h"
#include "robot_agent/control/map_context.h"

namespace coppice {

class TreeStore {
 public:
  enum class Verdict {
    kept,
    known,  ///< a broker that took over sends its trees again, without new links
    of_another_map,
    impossible,  ///< the tree leads through an obstacle, or there are too many nodes
  };

  /// `map`: null if no map has come yet.
  Verdict take(const InactiveTreesMessage& trees, const MapContext* map);
  /// Drops the trees of other maps, and the messages that this map contradicts. Returns the number of the
  /// latter.
  std::uint32_t restrict_to(const MapContext& map);

  const std::map<TreesId, InactiveTreesMessage>& messages() const { return messages_; }
  /// The number of trees.
  std::uint32_t size() const { return trees_; }

 private:
  using Links = std::vector<InactiveTreesMessage::Link>;

  Verdict take_links(const Links& told, Links& known);
  void count(const InactiveTreesMessage& trees);
  void drop(const std::function<bool(const InactiveTreesMessage&)>& which);

  std::map<TreesId, InactiveTreesMessage> messages_;
  std::uint32_t trees_ = 0;  ///< in all messages together, as `nodes_`
  std::size_t nodes_ = 0;
  std::size_t links_ = 0;
};

}  // namespace coppice
