#include "robot_agent/tree_store.h"

#include "messages/validation.h"

namespace coppice {

namespace {

constexpr std::size_t most_nodes = 4'000'000;  // a broker grows as many

}  // namespace

TreeStore::Verdict TreeStore::take(const InactiveTreeMessage& tree, const MapContext* map) {
  if (map != nullptr && tree.map_id != map->map_id) return Verdict::of_another_map;
  if (ids_.contains(tree.tree)) return Verdict::known;
  if (nodes_ + tree.nodes.size() > most_nodes || (map != nullptr && !is_free(tree, map->field)))
    return Verdict::impossible;
  ids_.insert(tree.tree);
  nodes_ += tree.nodes.size();
  trees_.push_back(tree);
  return Verdict::kept;
}

std::uint32_t TreeStore::restrict_to(const MapContext& map) {
  drop([&](const InactiveTreeMessage& tree) { return tree.map_id != map.map_id; });
  const std::uint32_t before = size();
  drop([&](const InactiveTreeMessage& tree) { return !is_free(tree, map.field); });
  return before - size();
}

void TreeStore::drop(const std::function<bool(const InactiveTreeMessage&)>& which) {
  std::erase_if(trees_, which);
  nodes_ = 0;
  ids_.clear();
  for (const InactiveTreeMessage& tree : trees_) {
    nodes_ += tree.nodes.size();
    ids_.insert(tree.tree);
  }
}

}  // namespace coppice
