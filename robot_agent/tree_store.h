// The inactive trees that an agent has received. All of them are of one map once that is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <vector>

#include "messages/messages.h"
#include "robot_agent/map_context.h"

namespace coppice {

class TreeStore {
 public:
  enum class Verdict {
    kept,
    known,  ///< a broker that took over sends its trees again
    of_another_map,
    impossible,  ///< the tree leads through an obstacle, or there are too many nodes
  };

  /// `map`: null if no map has come yet.
  Verdict take(const InactiveTreeMessage& tree, const MapContext* map);
  /// Drops the trees of other maps, and the trees that this map contradicts. Returns the number of the
  /// latter.
  std::uint32_t restrict_to(const MapContext& map);

  std::span<const InactiveTreeMessage> trees() const { return trees_; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(trees_.size()); }

 private:
  void drop(const std::function<bool(const InactiveTreeMessage&)>& which);

  std::vector<InactiveTreeMessage> trees_;
  std::set<TreeId> ids_;   ///< of `trees_`
  std::size_t nodes_ = 0;  ///< of all trees together
};

}  // namespace coppice
