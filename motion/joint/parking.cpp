#include "motion/joint/parking.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <unordered_map>
#include <utility>

namespace coppice {

namespace {

constexpr std::size_t most_effort = 3'000'000;  // edges, for the parking vertex of one robot; some tens of ms

using Edge = AnnotatedRoadmap::Edge;

}  // namespace

Parking::Parking(const AnnotatedRoadmap& graph, std::vector<Robot> robots, std::vector<std::uint32_t> order)
    : graph_(graph),
      robots_(std::move(robots)),
      pending_(std::move(order)),
      stands_(graph.size(), nobody),
      ways_out_(robots_.size()),
      seen_(graph.size(), 0) {
  std::erase_if(pending_, [&](std::uint32_t i) { return !robots_[i].takes_part; });
  for (const Robot& robot : robots_) stands_[robot.at] = robot.takes_part ? somebody : for_good;
}

SearchState Parking::step() {
  if (pending_.empty()) return SearchState::solved;
  robot_ = pending_.front();
  pending_.erase(pending_.begin());
  if (const auto way = way_to_park()) {
    park(*way);
    in_vain_ = 0;
    return pending_.empty() ? SearchState::solved : SearchState::searching;
  }
  pending_.push_back(robot_);
  return ++in_vain_ == pending_.size() ? SearchState::gave_up : SearchState::searching;
}

/// The cheapest way from a vertex to one that is wanted, past all that stand as `walls` or more firmly.
/// `from` itself is asked first, and each vertex once. Dijkstra's search.
template <class Wanted>
std::optional<std::vector<VertexMove>> Parking::way(Vertex from, Stands walls, Wanted&& wanted) {
  struct Reached {
    float cost;
    Vertex parent;
    std::uint32_t edge;
    bool closed = false;
  };
  using Entry = std::pair<float, Vertex>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::unordered_map<Vertex, Reached> reached{{from, {0, from, 0}}};
  open.emplace(0.0F, from);
  while (!open.empty()) {
    const auto [cost, place] = open.top();
    open.pop();
    if (std::exchange(reached.at(place).closed, true)) continue;
    if (wanted(place)) {
      std::vector<VertexMove> way;
      for (Vertex v = place; v != from; v = reached.at(v).parent)
        way.push_back({robot_, reached.at(v).parent, reached.at(v).edge});
      std::ranges::reverse(way);
      return way;
    }
    const std::vector<Edge>& edges = graph_.edges(place);
    effort_ += edges.size();
    for (std::uint32_t k = 0; k < edges.size(); ++k) {
      const auto taken = [&](Vertex v) { return stands_[v] >= walls && v != from; };
      if (std::ranges::any_of(edges[k].near, taken)) continue;
      const float there = cost + static_cast<float>(edges[k].length);
      const auto [known, fresh] = reached.try_emplace(edges[k].to, Reached{there, place, k});
      if (!fresh && known->second.cost <= there) continue;
      known->second = {there, place, k};
      open.emplace(there, edges[k].to);
    }
  }
  return std::nullopt;
}

/// To its aim, if the robot closes nothing there; otherwise to the nearest vertex at which it closes nothing.
std::optional<std::vector<VertexMove>> Parking::way_to_park() {
  const auto& [at, aim, takes_part] = robots_[robot_];
  parts_.clear();
  const std::size_t until = effort_ + most_effort;
  if (aim && closes_nothing(*aim)) {
    if (auto there = way(at, somebody, [&](Vertex v) { return v == *aim; })) return there;
  }
  return way(at, somebody, [&](Vertex v) { return effort_ < until && closes_nothing(v); });
}

void Parking::park(const std::vector<VertexMove>& way_there) {
  Robot& robot = robots_[robot_];
  stands_[robot.at] = nobody;
  for (const VertexMove& move : way_there) robot.at = graph_.edges(move.from)[move.edge].to;
  stands_[robot.at] = for_good;
  moves_.insert(moves_.end(), way_there.begin(), way_there.end());
  const auto is_out = [&](Vertex v) { return v != robot.at && !graph_.touch(v, robot.at); };
  ways_out_[robot_] = way(robot.at, for_good, is_out).value_or(std::vector<VertexMove>());
}

/// The vertices that can be reached from one, past all robots that do not move any more.
Parking::Vertices Parking::flood(Vertex from, std::optional<Vertex> also_taken) {
  const auto taken = [&](Vertex v) { return stands_[v] == for_good || v == also_taken; };
  ++search_;
  seen_[from] = search_;
  Vertices reached{from};
  for (std::size_t k = 0; k < reached.size(); ++k) {
    effort_ += graph_.edges(reached[k]).size();
    for (const Edge& edge : graph_.edges(reached[k])) {
      if (seen_[edge.to] == search_ || std::ranges::any_of(edge.near, taken)) continue;
      seen_[edge.to] = search_;
      reached.push_back(edge.to);
    }
  }
  return reached;
}

/// The vertices of the robots that still have to move, the aims, and where parked robots come out.
Parking::Vertices Parking::to_be_connected() const {
  Vertices places;
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    const Robot& robot = robots_[i];
    if (!robot.takes_part || i == robot_) continue;
    if (robot.aim) places.push_back(*robot.aim);
    if (stands_[robot.at] == somebody) places.push_back(robot.at);
    if (!ways_out_[i].empty()) {
      const VertexMove& last = ways_out_[i].back();
      places.push_back(graph_.edges(last.from)[last.edge].to);
    }
  }
  return places;
}

/// The parts of the roadmap that are connected past all robots that do not move any more.
void Parking::find_parts() {
  Vertices left = to_be_connected();
  while (!left.empty()) {
    Part part{{}, flood(left.back(), std::nullopt)};
    const auto elsewhere = [&](Vertex v) { return seen_[v] != search_; };
    const auto wanted = std::ranges::partition(left, elsewhere);
    part.wanted.assign(wanted.begin(), wanted.end());
    left.erase(wanted.begin(), left.end());
    parts_.push_back(std::move(part));
  }
}

bool Parking::closes_nothing(Vertex place) {
  if (parts_.empty()) find_parts();
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    if (i == robot_ || !robots_[i].takes_part) continue;
    if (robots_[i].aim && graph_.touch(place, *robots_[i].aim)) return false;
    const bool in_the_way = std::ranges::any_of(ways_out_[i], [&](const VertexMove& move) {
      return std::ranges::binary_search(graph_.edges(move.from)[move.edge].near, place);
    });
    if (in_the_way) return false;
  }
  return std::ranges::all_of(parts_, [&](const Part& part) { return stays_in_one_piece(part, place); });
}

/// Whether all wanted vertices stay connected if the robot parks at a place, and it cuts off fewer other
/// vertices than it covers.
bool Parking::stays_in_one_piece(const Part& part, Vertex place) {
  flood(part.wanted.front(), place);
  const auto reached = [&](Vertex v) { return seen_[v] == search_; };
  const auto covered = [&](Vertex v) { return graph_.touch(v, place); };
  return std::ranges::all_of(part.wanted, reached) &&
         std::ranges::count_if(part.all, std::not_fn(reached)) <
             std::max(std::ptrdiff_t{1}, 2 * std::ranges::count_if(part.all, covered));
}

}  // namespace coppice
