#include "robot_agent/path_finder.h"

#include <utility>

#include "planning/path_shortening.h"
#include "planning/reachability.h"
#include "planning/step_length.h"

namespace coppice {

namespace {

constexpr int iterations_a_step = 20;
constexpr double pause_between_steps = 0.0005;  // seconds; about what a tree needs to come over the bus
// No tree for so many steps: there is no broker, or it has nothing for this robot.
constexpr int patience = 40;
constexpr int iterations_alone = 300;
// A search that has not ended by then may have no end: worth the milliseconds of a flood fill.
constexpr std::uint64_t doubt = 20'000;
// With no proof either way: more than a hundred times what the hardest of the tried maps needed.
constexpr std::uint64_t most_iterations = 20'000'000;
constexpr std::size_t trees_without_sharing = 16;

}  // namespace

PathFinder::PathFinder(const ClearanceField& field, const Mission& mission, const Point2& start)
    : field_(field),
      mission_(mission),
      start_(start),
      planner_(field,
               {.epsilon = suggested_epsilon(field, mission.radius),
                .disjointed_trees = mission.sharing ? 0 : trees_without_sharing},
               Random(mission.seed)),
      group_(planner_.add_group(start, mission.goal, mission.radius)) {}

void PathFinder::take(const InactiveTreeMessage& message) {
  ++received_;
  if (!mission_.sharing) return;
  steps_without_news_ = 0;
  FrozenTree<2> tree{.radius = message.radius, .nodes = {}, .parents = {}};
  for (const InactiveTreeMessage::Node& node : message.nodes) {
    tree.nodes.push_back(node.position);
    tree.parents.push_back(node.parent);
  }
  planner_.add_inactive_tree(tree);
}

std::optional<std::variant<Path, NoPath>> PathFinder::step() {
  const int most = pause() > 0 ? iterations_a_step : iterations_alone;
  for (int i = 0; i < most && planner_.step(); ++i) ++iterations_;
  ++steps_without_news_;
  if (planner_.solved(group_)) return shortened();
  if (iterations_ >= doubt && !std::exchange(reachability_checked_, true) &&
      provably_unreachable(field_, start_, mission_.goal, mission_.radius)) {
    return NoPath{"no path: the goal cannot be reached from the start with this radius"};
  }
  if (iterations_ >= most_iterations) return NoPath{"no path found: the limit of iterations is reached"};
  return std::nullopt;
}

double PathFinder::pause() const {
  return mission_.sharing && steps_without_news_ < patience ? pause_between_steps : 0;
}

Path PathFinder::shortened() {
  return shorten(field_, planner_.path(group_), mission_.radius);
}

SampleCounts PathFinder::counts() const {
  SampleCounts counts = planner_.group_counts(group_);
  counts.valid += planner_.disjointed_counts().valid;
  counts.invalid += planner_.disjointed_counts().invalid;
  return counts;
}

std::optional<RootNodes> PathFinder::take_root_nodes() {
  const std::vector<NodeId> fresh = planner_.take_root_nodes(group_);
  if (fresh.empty()) return std::nullopt;
  RootNodes batch{.robot = mission_.robot, .mission = mission_.number, .first_index = sent_, .nodes = {}};
  for (const NodeId n : fresh) {
    const Trees<2>& trees = planner_.trees();
    const Side side = trees.tree(trees.tree_of(n)).side == Root::start ? Side::start : Side::goal;
    const auto parent = sent_index_.find(trees.parent(n));
    batch.nodes.push_back({side, trees.position(n), parent == sent_index_.end() ? -1 : parent->second});
    sent_index_.emplace(n, static_cast<std::int32_t>(sent_++));
  }
  return batch;
}

}  // namespace coppice
