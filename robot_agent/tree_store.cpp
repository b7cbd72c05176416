#include "robot_agent/tree_store.h"

#include "messages/tree_message.h"
#include "messages/validation.h"

namespace coppice {

namespace {

constexpr std::size_t most_nodes = 4'000'000;  // a broker grows as many

}  // namespace

TreeStore::Verdict TreeStore::take(const InactiveTreesMessage& trees, const MapContext* map) {
  if (map != nullptr && trees.map_id != map->map_id) return Verdict::of_another_map;
  if (ids_.contains(trees.id)) return Verdict::known;
  if (nodes_ + trees.nodes.size() > most_nodes || (map != nullptr && !are_free(trees, map->field)))
    return Verdict::impossible;
  messages_.push_back(trees);
  count(trees);
  return Verdict::kept;
}

void TreeStore::count(const InactiveTreesMessage& trees) {
  ids_.insert(trees.id);
  nodes_ += trees.nodes.size();
  trees_ += number_of_trees(trees);
}

std::uint32_t TreeStore::restrict_to(const MapContext& map) {
  drop([&](const InactiveTreesMessage& trees) { return trees.map_id != map.map_id; });
  const auto before = messages_.size();
  drop([&](const InactiveTreesMessage& trees) { return !are_free(trees, map.field); });
  return static_cast<std::uint32_t>(before - messages_.size());
}

void TreeStore::drop(const std::function<bool(const InactiveTreesMessage&)>& which) {
  std::erase_if(messages_, which);
  nodes_ = 0;
  trees_ = 0;
  ids_.clear();
  for (const InactiveTreesMessage& trees : messages_) count(trees);
}

}  // namespace coppice
