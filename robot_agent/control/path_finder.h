// Plans the path of one robot. It grows the robot's two root trees and grafts the inactive trees that the
// broker publishes onto them. Then it looks for shorter paths, for as long as there is time.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"
#include "planning/trees/ma_rrdt_star.h"
#include "planning/trees/path_improvement.h"
#include "planning/trees/rrt_star.h"

namespace coppice {

/// It is proved that there is no path.
struct NoPath {
  std::string reason;
};

class PathFinder {
 public:
  using Result = std::variant<Path, NoPath>;

  /// Plans from `start` to the mission's goal on `field`. `field` and `improver` outlive it; the improver
  /// knows what earlier missions have learnt about the map. `known`: a path that exists already, if any,
  /// perhaps a long one. It is taken when the search takes so long that it may have no end.
  PathFinder(const ClearanceField& field, PathImprover<ClearanceField>& improver, const Mission& mission,
             const Point2& start, Path known = {});

  /// Trees may come again, with further links.
  void take(const InactiveTreesMessage& trees);

  /// Grows the trees by a bounded amount. After a long search, searches all passages of the map. Returns the
  /// result, once there is one.
  std::optional<Result> step();

  /// Whether the first path is straight or has been pulled taut already.
  bool is_taut() const { return path().size() == 2 || improver_.all_taut(); }
  /// Pulls the first path taut.
  const Path& pull_taut();

  /// Looks for a shorter path than the one that step() found, for a bounded time. False once none turns up.
  bool improve();
  /// The shortest path so far.
  const Path& path() const { return improver_.path(0); }

  /// Wall-clock seconds to leave to the broker before the next step. So the root trees get their share of the
  /// samples, as in one process, and the disjointed trees that serve all robots get the rest. Without news
  /// from the broker there is no pause.
  double pause() const;

  /// The root-tree nodes that joined since the last call, for the broker; nullopt if there are none.
  std::optional<RootNodes> take_root_nodes();

  SampleCounts counts() const;
  std::uint32_t grafted_trees() const { return rrt_star_ ? 0 : planner_.grafted_trees(group_); }

 private:
  struct Received {  ///< the nodes of a message
    NodeId first;
    std::uint32_t nodes;
  };

  std::optional<NodeId> node_of(const TreesId& id, std::uint32_t index) const;
  bool solved() const { return rrt_star_ ? rrt_star_->solved() : planner_.solved(group_); }
  bool grow();
  Path take_first_path(Path path);

  const ClearanceField& field_;
  PathImprover<ClearanceField>& improver_;
  Mission mission_;
  Point2 start_;
  Path known_;
  std::optional<RrtStar<ClearanceField>> rrt_star_;  ///< if the mission asks for this planner
  MaRrdtStar<ClearanceField> planner_;
  GroupIndex group_ = 0;
  std::map<TreesId, Received> received_;
  /// Links, with the trees that told them, to trees that have not come yet.
  std::vector<std::pair<TreesId, InactiveTreesMessage::Link>> links_;
  std::uint64_t iterations_ = 0;
  std::uint64_t samples_until_ = 0;            ///< iterations before the known path is taken
  int steps_without_news_ = 0;                 ///< from the broker
  std::uint32_t sent_ = 0;                     ///< root-tree nodes
  std::map<NodeId, std::int32_t> sent_index_;  ///< of these nodes, in the order in which they were sent
};

}  // namespace coppice
