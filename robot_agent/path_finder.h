// The planning of one robot: its own two root trees, over the inactive trees that the broker publishes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bus/messages.h"
#include "planning/clearance_field.h"
#include "planning/ma_rrdt_star.h"

namespace coppice {

/// No path: proved, or given up at a limit.
struct NoPath {
  std::string reason;
};

class PathFinder {
 public:
  /// Plans from `start` to the mission's goal on `field`, which outlives it.
  PathFinder(const ClearanceField& field, const Mission& mission, const Point2& start);

  void take(const InactiveTreeMessage& tree);

  /// A bounded amount of growing. The result, once there is one.
  std::optional<std::variant<Path, NoPath>> step();

  /// Seconds to leave to the broker before the next step. The root trees get their share of the samples, as
  /// in one process, and the disjointed trees that serve everybody the rest; without news from the broker, no
  /// pause.
  double pause() const;

  /// Root-tree nodes that joined since the last call, for the broker; none: nullopt.
  std::optional<RootNodes> take_root_nodes();

  SampleCounts counts() const;
  std::uint32_t grafted_trees() const { return planner_.grafted_trees(group_); }
  std::uint32_t received_trees() const { return received_; }

 private:
  Path shortened();

  const ClearanceField& field_;
  Mission mission_;
  Point2 start_;
  MaRrdtStar<ClearanceField> planner_;
  GroupIndex group_;
  std::uint64_t iterations_ = 0;
  int steps_without_news_ = 0;
  bool reachability_checked_ = false;
  std::uint32_t received_ = 0;
  std::uint32_t sent_ = 0;
  std::map<NodeId, std::int32_t> sent_index_;
};

}  // namespace coppice
