#include "robot_agent/control/path_finder.h"

#include <algorithm>
#include <utility>

#include "messages/tree_message.h"
#include "planning/geometry/voronoi_roadmap.h"
#include "planning/trees/suggestions.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr int iterations_a_step = 20;
constexpr int iterations_alone = 300;  // in a step without a broker
// A search with more iterations may have no end. Then it is worth a search of all passages, whose time is in
// proportion to the cells of the map.
constexpr std::uint64_t least_iterations = 20'000;
constexpr std::uint64_t cells_an_iteration = 8;
// If that search finds a way, the trees may still find one, too. The passage is about as wide as the robot.
constexpr std::uint64_t searches_until_roadmap_serves = 5;

/// The parameters of the trees that grow in the agent. With a broker, the disjointed trees grow there.
TreeParameters own_trees(const Mission& mission, const ClearanceField& field) {
  TreeParameters trees = completed(mission.trees, field, mission.radius);
  if (mission.planner != PlannerKind::rrdt_star) trees.disjointed_trees = 0;
  return trees;
}

}  // namespace

PathFinder::PathFinder(const ClearanceField& field, PathImprover<ClearanceField>& improver,
                       const Mission& mission, const Point2& start, Path known)
    : field_(field),
      improver_(improver),
      mission_(mission),
      start_(start),
      known_(std::move(known)),
      planner_(field, own_trees(mission, field), Random(mission.seed)) {
  if (mission.planner == PlannerKind::rrt_star) {
    rrt_star_.emplace(field, start, mission.goal, mission.radius, own_trees(mission, field).epsilon,
                      Random(mission.seed));
  } else {
    group_ = planner_.add_group(start, mission.goal, mission.radius);
  }
}

void PathFinder::take(const InactiveTreesMessage& message) {
  if (mission_.planner != PlannerKind::ma_rrdt_star) return;
  steps_without_news_ = 0;
  const auto count = static_cast<std::uint32_t>(message.nodes.size());
  if (const auto [known, is_new] = received_.try_emplace(message.id, Received{0, count}); is_new)
    known->second.first = planner_.add_inactive_trees(frozen_trees_of(message));
  for (const InactiveTreesMessage::Link& link : message.links) links_.push_back({message.id, link});
  std::erase_if(links_, [&](const auto& named) {
    const auto& [id, link] = named;
    const auto a = node_of(id, link.node);
    const auto b = node_of(link.other, link.other_node);
    if (a && b) planner_.add_link(*a, *b);
    return a && b;
  });
}

std::optional<NodeId> PathFinder::node_of(const TreesId& id, std::uint32_t index) const {
  const auto trees = received_.find(id);
  if (trees == received_.end() || index >= trees->second.nodes) return std::nullopt;
  return trees->second.first + index;
}

std::optional<PathFinder::Result> PathFinder::step() {
  const int most = pause() > 0 ? iterations_a_step : iterations_alone;
  for (int i = 0; i < most && grow(); ++i) ++iterations_;
  ++steps_without_news_;
  if (solved()) return take_first_path(rrt_star_ ? rrt_star_->path() : planner_.path(group_));
  const std::uint64_t doubt =
      std::max<std::uint64_t>(least_iterations, field_.frame().cells() / cells_an_iteration);
  if (iterations_ < doubt) return std::nullopt;
  if (known_.empty()) {
    auto way = VoronoiRoadmap(field_).way(start_, mission_.goal, mission_.radius);
    if (!way) return NoPath{"no path: the goal cannot be reached from the start with this radius"};
    known_ = std::move(*way);
    samples_until_ = searches_until_roadmap_serves * doubt;
  }
  if (iterations_ < samples_until_) return std::nullopt;
  return take_first_path(std::move(known_));
}

bool PathFinder::grow() {
  return rrt_star_ ? rrt_star_->step() : planner_.step();
}

double PathFinder::pause() const {
  const bool shares = mission_.planner == PlannerKind::ma_rrdt_star;
  return shares && steps_without_news_ < Timing::steps_without_a_tree ? Timing::search_pause : 0;
}

/// The path straight off the trees. From now on it may become shorter.
Path PathFinder::take_first_path(Path path) {
  if (improver_.places() == 0) improver_.add_places(planner_.trees());
  improver_.forget_robots();
  improver_.add_robot(std::move(path), mission_.radius);
  return improver_.path(0);
}

const Path& PathFinder::pull_taut() {
  while (!improver_.all_taut()) improver_.step();
  return improver_.path(0);
}

bool PathFinder::improve() {
  return improver_.step();
}

SampleCounts PathFinder::counts() const {
  if (rrt_star_) return {rrt_star_->valid(), rrt_star_->invalid()};
  SampleCounts counts = planner_.group_counts(group_);
  counts.valid += planner_.disjointed_counts().valid;
  counts.invalid += planner_.disjointed_counts().invalid;
  return counts;
}

std::optional<RootNodes> PathFinder::take_root_nodes() {
  if (mission_.planner != PlannerKind::ma_rrdt_star) return std::nullopt;
  const std::vector<NodeId> fresh = planner_.take_root_nodes(group_);
  if (fresh.empty()) return std::nullopt;
  RootNodes batch{.robot = mission_.robot,
                  .mission = mission_.number,
                  .first_index = sent_,
                  .nodes = {},
                  .run = mission_.clock.run()};
  for (const NodeId n : fresh) {
    const Trees<2>& trees = planner_.trees();
    const Root side = trees.tree(trees.tree_of(n)).side;
    const auto parent = sent_index_.find(trees.parent(n));
    batch.nodes.push_back({side, trees.position(n), parent == sent_index_.end() ? -1 : parent->second});
    sent_index_.emplace(n, static_cast<std::int32_t>(sent_++));
  }
  return batch;
}

}  // namespace coppice
