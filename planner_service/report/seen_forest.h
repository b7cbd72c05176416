// The knowledge of the planner service about the disjointed trees: what the brokers say of them, and the
// inactive trees that were published.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "files/picture.h"
#include "messages/messages.h"

namespace coppice {

class SeenForest {
 public:
  /// False: too many brokers have been heard in this run, and this one is ignored.
  bool add(const BrokerStatus& status);
  /// The trees are of the map of the run. Each counts once.
  void add(const InactiveTreesMessage& trees);

  /// The sums over all brokers.
  struct Nodes {
    std::uint64_t valid = 0;
    std::uint64_t invalid = 0;
  };
  Nodes nodes() const;
  std::size_t trees() const { return trees_; }
  /// For the picture.
  const std::vector<PictureContent::Edge>& edges() const { return edges_; }

 private:
  std::map<std::uint64_t, BrokerStatus> brokers_;
  std::set<TreesId> ids_;
  std::size_t trees_ = 0;
  std::vector<PictureContent::Edge> edges_;
};

}  // namespace coppice
