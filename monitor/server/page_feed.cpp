#include "monitor/server/page_feed.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace coppice {

namespace {

/// Relative to the origin: a float has seven digits, too few for coordinates in a national grid.
template <class List>
void add_point(List& list, const Point2& point, const Point2& origin) {
  list.add_points(static_cast<float>(point.x() - origin.x()));
  list.add_points(static_cast<float>(point.y() - origin.y()));
}

void add_edge(live::Edges& edges, const Point2& from, const Point2& to, const Point2& origin) {
  add_point(edges, from, origin);
  add_point(edges, to, origin);
}

std::size_t size_of(const live::Edges& edges) {
  return static_cast<std::size_t>(edges.points_size()) / 4;
}

}  // namespace

struct PageFeed::Batch {
  std::vector<Payload> messages{};
  std::size_t size = 0;

  bool full() const { return size >= most_bytes_at_once; }
  void add(const Payload& bytes) {
    messages.push_back(bytes);
    size += bytes->size();
  }
  void add(const live::ToPage& message) { add(encoded(message)); }
  void add(const Edition& edition, std::uint64_t& had) {
    if (!edition.bytes || edition.number == had) return;
    had = edition.number;
    add(edition.bytes);
  }
  /// Adds the message, unless it is empty.
  void add(live::Edges edges) {
    if (edges.points_size() == 0 && !edges.anew()) return;
    live::ToPage message;
    *message.mutable_edges() = std::move(edges);
    add(message);
  }
};

std::vector<Payload> PageFeed::next(const FleetView& view, const LiveStream& live) {
  Batch batch;
  if (run_ != live.run()) {
    *this = {};
    run_ = live.run();
    origin_ = live.origin();
    batch.add(live.begin());
  }
  batch.add(live.map(), map_);
  batch.add(live.roster(), roster_);
  if (slow_tick_ != live.slow_tick() || behind_) {
    slow_tick_ = live.slow_tick();
    robots_.resize(view.robots().size());
    for (std::size_t k = 0; k < robots_.size() && !batch.full(); ++k) add_path(k, view.robots()[k], batch);
    add_statuses(live, batch);
    add_inactive_trees(view, batch);
    add_active_trees(view, batch);
    for (std::size_t k = 0; k < robots_.size() && !batch.full(); ++k)
      add_root_trees(k, view.robots()[k], batch);
    behind_ = batch.full();
  }
  add_figures(live, batch);
  batch.add(live.playback(), playback_);
  batch.add(live.alarms(), alarms_);
  batch.add(live.beat(), beat_);
  batch.add(live.frame(), frame_);
  return std::move(batch.messages);
}

void PageFeed::add_inactive_trees(const FleetView& view, Batch& batch) {
  const auto& trees = view.inactive_trees();
  live::Edges edges;
  while (trees_ < trees.size() && !batch.full()) {
    const auto& tree = std::get<InactiveTreesMessage>(*trees[trees_++]);
    for (const InactiveTreesMessage::Node& node : tree.nodes) {
      if (node.parent < 0) continue;
      add_edge(edges, tree.nodes[static_cast<std::size_t>(node.parent)].position, node.position, origin_);
      if (size_of(edges) >= most_edges_at_once) batch.add(std::exchange(edges, {}));
    }
  }
  batch.add(std::move(edges));
}

void PageFeed::add_active_trees(const FleetView& view, Batch& batch) {
  if (active_trees_ == view.active_trees()) return;
  active_trees_ = view.active_trees();
  live::Edges edges;
  edges.set_kind(live::Edges::ACTIVE);
  edges.set_anew(true);
  if (active_trees_) {
    for (const auto& edge : std::get<ActiveTreesMessage>(*active_trees_).edges)
      add_edge(edges, edge.from, edge.to, origin_);
  }
  batch.add(std::move(edges));
}

void PageFeed::add_root_trees(std::size_t number, const SeenRobot& robot, Batch& batch) {
  Told& told = robots_[number];
  const std::uint32_t mission = robot.mission ? robot.mission->number : 0;
  const bool anew = told.mission != mission && told.root_nodes > 0;
  if (told.mission != mission) {
    told.mission = mission;
    told.root_nodes = 0;
  }
  const auto of_kind = [&](live::Edges::Kind kind) {
    live::Edges edges;
    edges.set_kind(kind);
    edges.set_robot(static_cast<std::uint32_t>(number));
    edges.set_anew(anew);
    return edges;
  };
  live::Edges start = of_kind(live::Edges::ROOT_START);
  live::Edges goal = of_kind(live::Edges::ROOT_GOAL);
  for (; told.root_nodes < robot.root_nodes.size(); ++told.root_nodes) {
    if (size_of(start) + size_of(goal) >= most_edges_at_once)
      break;  // the others follow with the next slow tick
    const RootNodes::Node& node = robot.root_nodes[told.root_nodes];
    if (node.parent < 0) continue;
    const Point2& parent = robot.root_nodes[static_cast<std::size_t>(node.parent)].position;
    add_edge(node.side == Root::start ? start : goal, parent, node.position, origin_);
  }
  batch.add(std::move(start));
  batch.add(std::move(goal));
}

void PageFeed::add_path(std::size_t number, const SeenRobot& robot, Batch& batch) {
  if (robots_[number].path_revision == robot.path_revision) return;
  robots_[number].path_revision = robot.path_revision;
  live::ToPage message;
  live::Path& path = *message.mutable_path();
  path.set_robot(static_cast<std::uint32_t>(number));
  for (const Point2& point : robot.path) add_point(path, point, origin_);
  batch.add(message);
}

void PageFeed::add_statuses(const LiveStream& live, Batch& batch) {
  live::ToPage message;
  for (const LiveStream::RobotStatus& robot : live.statuses()) {
    if (robot.changed > statuses_) *message.mutable_statuses()->add_statuses() = robot.status;
  }
  statuses_ = live.slow_tick();
  if (message.has_statuses()) batch.add(message);
}

void PageFeed::add_figures(const LiveStream& live, Batch& batch) {
  const std::size_t all = live.figures_dropped() + live.figures().size();
  if (figures_ >= all) return;
  live::ToPage message;
  for (std::size_t k = std::max(figures_, live.figures_dropped()); k < all; ++k)
    *message.mutable_figures()->add_points() = live.figures()[k - live.figures_dropped()];
  figures_ = all;
  batch.add(message);
}

}  // namespace coppice
