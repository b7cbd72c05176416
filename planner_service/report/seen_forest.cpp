#include "planner_service/report/seen_forest.h"

#include "messages/tree_message.h"

namespace coppice {

namespace {

constexpr std::size_t most_brokers = 1000;  // each start of a broker is another one
constexpr std::size_t most_messages = 1'000'000;
// A picture with more edges shows nothing but ink.
constexpr std::size_t most_picture_edges = 100'000;

}  // namespace

bool SeenForest::add(const BrokerStatus& status) {
  if (brokers_.size() >= most_brokers && !brokers_.contains(status.broker)) return false;
  brokers_[status.broker] = status;
  return true;
}

void SeenForest::add(const InactiveTreesMessage& trees) {
  if (ids_.size() >= most_messages || !ids_.insert(trees.id).second) return;
  trees_ += number_of_trees(trees);
  for (const InactiveTreesMessage::Node& node : trees.nodes) {
    if (node.parent < 0 || edges_.size() >= most_picture_edges) continue;
    edges_.push_back({trees.nodes[static_cast<std::size_t>(node.parent)].position, node.position, -1});
  }
}

SeenForest::Nodes SeenForest::nodes() const {
  Nodes sum;
  for (const auto& [id, broker] : brokers_) {
    sum.valid += broker.nodes_valid;
    sum.invalid += broker.nodes_invalid;
  }
  return sum;
}

}  // namespace coppice
