#include "motion/joint/pibt.h"

#include <algorithm>
#include <functional>

namespace coppice {

namespace {

// A way without robots to push is preferred if its detour is at most this share of the edge's length. Among
// ways that are about equally good, the choice is random.
constexpr double detour_for_a_free_way = 0.3;
constexpr double indifference = 0.01;

bool contains(const std::vector<Vertex>& places, Vertex place) {
  return std::ranges::binary_search(places, place);
}

}  // namespace

bool Pibt::generate(const Configuration& from, std::span<const std::uint32_t> order,
                    std::span<const Forced> forced, Random& random) {
  for (const Vertex place : at_) occupant_[place] = nobody;
  at_ = from;
  for (std::uint32_t i = 0; i < at_.size(); ++i) occupant_[at_[i]] = i;
  decided_.assign(at_.size(), false);
  forced_.assign(at_.size(), std::nullopt);
  for (const auto& [robot, to] : forced) forced_[robot] = to;
  steps_.clear();
  for (const auto& [robot, to] : forced) {
    if (!decided_[robot]) push(robot, random);
    if (at_[robot] != to) return false;
  }
  for (const std::uint32_t robot : order) {
    if (!decided_[robot]) push(robot, random);
  }
  return true;
}

/// The robot takes the best move for which all robots in its way can make room. Returns false if the
/// robot stays where it is.
bool Pibt::push(std::uint32_t robot, Random& random) {
  decided_[robot] = true;
  const Vertex here = at_[robot];
  for (const auto& [cost, edge] : candidates(robot, random)) {
    if (!in_nobodys_way(here, edge)) continue;
    if (edge == nullptr) return false;
    if (!clear(*edge, robot, random)) continue;
    occupant_[here] = nobody;
    occupant_[edge->to] = robot;
    at_[robot] = edge->to;
    steps_.push_back(
        {static_cast<std::uint16_t>(robot), static_cast<std::uint16_t>(edge - graph_.edges(here).data())});
    return true;
  }
  return false;
}

/// The next moves of a robot, the best first.
std::vector<Pibt::Candidate> Pibt::candidates(std::uint32_t robot, Random& random) {
  const Vertex here = at_[robot];
  std::vector<Candidate> result;
  if (!forced_[robot] || forced_[robot] == here) result.push_back({cluster_.cost(robot, here), nullptr});
  for (const AnnotatedRoadmap::Edge& edge : graph_.edges(here)) {
    if (forced_[robot] && forced_[robot] != edge.to) continue;
    const float there = cluster_.cost(robot, edge.to);
    if (there == Cluster::unreachable) continue;
    const double pushing = empty_around(edge, robot) ? 0 : detour_for_a_free_way;
    const double whim = indifference * random.uniform();
    result.push_back({there + static_cast<float>((pushing + whim) * edge.length), &edge});
  }
  std::ranges::stable_sort(result, std::less{}, &Candidate::cost);
  return result;
}

/// Whether a move is out of the way of all robots that wait for this one: it does not touch them where they
/// are, and it ends where they do not touch this robot.
bool Pibt::in_nobodys_way(Vertex here, const AnnotatedRoadmap::Edge* edge) const {
  const Vertex end = edge != nullptr ? edge->to : here;
  return std::ranges::none_of(reserved_, [&](const Reserved& other) {
    return contains(other.edge->near, end) || (edge != nullptr && contains(edge->near, other.from));
  });
}

/// Makes all robots move that stand near the edge. Robots that have moved stay there even if another robot
/// cannot move.
bool Pibt::clear(const AnnotatedRoadmap::Edge& edge, std::uint32_t robot, Random& random) {
  const auto stays = [&](Vertex place) {
    const std::uint32_t other = occupant_[place];
    return other != nobody && other != robot && decided_[other];
  };
  if (std::ranges::any_of(edge.near, stays)) return false;
  reserved_.push_back({at_[robot], &edge});
  for (const Vertex place : edge.near) {
    const std::uint32_t other = occupant_[place];
    if (other != nobody && other != robot && (decided_[other] || !push(other, random))) break;
  }
  reserved_.pop_back();
  return empty_around(edge, robot);
}

bool Pibt::empty_around(const AnnotatedRoadmap::Edge& edge, std::uint32_t robot) const {
  return std::ranges::all_of(
      edge.near, [&](Vertex place) { return occupant_[place] == nobody || occupant_[place] == robot; });
}

}  // namespace coppice
