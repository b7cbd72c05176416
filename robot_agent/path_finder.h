// The planning of one robot: its own two root trees, over the inactive trees that the broker publishes; then
// shorter paths, for as long as there is time.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "messages/messages.h"
#include "planning/clearance_field.h"
#include "planning/ma_rrdt_star.h"
#include "planning/path_improvement.h"
#include "planning/rrt_star.h"

namespace coppice {

/// It is proved that there is no path.
struct NoPath {
  std::string reason;
};

class PathFinder {
 public:
  using Result = std::variant<Path, NoPath>;

  /// Plans from `start` to the mission's goal on `field`. That and the `improver`, which knows what missions
  /// before have learnt about the map, outlive it. `known`: a path that is there already, if any, but perhaps
  /// a long one: it is taken when the search takes so long that it may have no end.
  PathFinder(const ClearanceField& field, PathImprover<ClearanceField>& improver, const Mission& mission,
             const Point2& start, Path known = {});

  void take(const InactiveTreeMessage& tree);

  /// A bounded amount of growing, and at last a search of all passages. The result, once there is one.
  std::optional<Result> step();

  /// Whether the first path has been pulled taut already; pulls it taut.
  bool is_taut() const { return improver_.all_taut(); }
  const Path& pull_taut();

  /// A bounded amount of looking for a shorter path than the one that step() found. False once none turns up.
  bool improve();
  /// The shortest path so far.
  const Path& path() const { return improver_.path(0); }

  /// Seconds to leave to the broker before the next step. The root trees get their share of the samples, as
  /// in one process, and the disjointed trees that serve everybody the rest; without news from the broker, no
  /// pause.
  double pause() const;

  /// Root-tree nodes that joined since the last call, for the broker; none: nullopt.
  std::optional<RootNodes> take_root_nodes();

  SampleCounts counts() const;
  std::uint32_t grafted_trees() const { return rrt_star_ ? 0 : planner_.grafted_trees(group_); }

 private:
  bool solved() const { return rrt_star_ ? rrt_star_->solved() : planner_.solved(group_); }
  bool grow();
  Path take_first_path(Path path);

  const ClearanceField& field_;
  PathImprover<ClearanceField>& improver_;
  Mission mission_;
  Point2 start_;
  Path known_;
  double epsilon_;
  std::optional<RrtStar<ClearanceField>> rrt_star_;  ///< where the mission asks for it
  MaRrdtStar<ClearanceField> planner_;
  GroupIndex group_ = 0;
  std::uint64_t iterations_ = 0;
  std::uint64_t samples_until_ = 0;  ///< iterations, before the known path is taken
  int steps_without_news_ = 0;
  std::uint32_t sent_ = 0;
  std::map<NodeId, std::int32_t> sent_index_;
};

}  // namespace coppice
