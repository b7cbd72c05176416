#include "robot_agent/control/tree_store.h"

#include <algorithm>
#include <iterator>

#include "messages/tree_message.h"
#include "messages/validation.h"

namespace coppice {

namespace {

constexpr std::size_t most_nodes = 4'000'000;  // a broker grows as many; and as many links

}  // namespace

TreeStore::Verdict TreeStore::take(const InactiveTreesMessage& trees, const MapContext* map) {
  if (map != nullptr && trees.map_id != map->map_id) return Verdict::of_another_map;
  if (const auto known = messages_.find(trees.id); known != messages_.end())
    return take_links(trees.links, known->second.links);
  if (nodes_ + trees.nodes.size() > most_nodes || links_ + trees.links.size() > most_nodes ||
      (map != nullptr && !are_free(trees, map->field)))
    return Verdict::impossible;
  messages_.emplace(trees.id, trees);
  count(trees);
  return Verdict::kept;
}

/// A broker that took over may know further links of trees that it received.
TreeStore::Verdict TreeStore::take_links(const Links& told, Links& known) {
  if (links_ + told.size() > most_nodes) return Verdict::impossible;
  const std::size_t before = known.size();
  std::ranges::copy(told, std::back_inserter(known));
  std::ranges::sort(known);
  known.erase(std::ranges::unique(known).begin(), known.end());
  links_ += known.size() - before;
  return known.size() > before ? Verdict::kept : Verdict::known;
}

void TreeStore::count(const InactiveTreesMessage& trees) {
  nodes_ += trees.nodes.size();
  links_ += trees.links.size();
  trees_ += number_of_trees(trees);
}

std::uint32_t TreeStore::restrict_to(const MapContext& map) {
  drop([&](const InactiveTreesMessage& trees) { return trees.map_id != map.map_id; });
  const auto before = messages_.size();
  drop([&](const InactiveTreesMessage& trees) { return !are_free(trees, map.field); });
  return static_cast<std::uint32_t>(before - messages_.size());
}

void TreeStore::drop(const std::function<bool(const InactiveTreesMessage&)>& which) {
  std::erase_if(messages_, [&](const auto& known) { return which(known.second); });
  nodes_ = 0;
  links_ = 0;
  trees_ = 0;
  for (const auto& [id, trees] : messages_) count(trees);
}

}  // namespace coppice
