#include "motion/joint/joint_a_star.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <utility>

namespace coppice {

namespace {

// Weight of the heuristic: plans are at most this many times as long as the shortest.
constexpr float weight = 2;
constexpr std::size_t most_remembered = 200'000;  // configurations, of about 80 bytes each
constexpr std::size_t key_bits = 64;
constexpr std::size_t moves_a_step = 20'000;

}  // namespace

JointAStar::JointAStar(Cluster& cluster)
    : cluster_(cluster), bits_(static_cast<std::size_t>(std::bit_width(cluster.graph().size()))) {
  if (cluster_.size() * bits_ > key_bits) return;
  const Configuration starts = cluster_.starts();
  for (std::size_t i = 0; i < starts.size(); ++i) start_ |= Key{starts[i]} << (i * bits_);
  reach(start_, {.cost = 0});
}

JointAStar::Key JointAStar::moved(Key at, std::size_t robot, Vertex to) const {
  return at ^ Key { place(at, robot) ^ to } << (robot * bits_);
}

bool JointAStar::is_goal(Key at) const {
  for (std::uint32_t i = 0; i < cluster_.size(); ++i) {
    if (!cluster_.at_goal(i, place(at, i))) return false;
  }
  return true;
}

/// Whether a robot that drives along the edge touches none of the others.
bool JointAStar::is_clear(Key at, std::size_t robot, const AnnotatedRoadmap::Edge& edge) const {
  for (std::size_t i = 0; i < cluster_.size(); ++i) {
    if (i != robot && std::ranges::binary_search(edge.near, place(at, i))) return false;
  }
  return true;
}

float JointAStar::to_go(Key at) {
  float sum = 0;
  for (std::uint32_t i = 0; i < cluster_.size(); ++i) sum += cluster_.cost(i, place(at, i));
  return sum;
}

void JointAStar::reach(Key at, const Node& node) {
  const auto [known, fresh] = nodes_.try_emplace(at, node);
  if (!fresh && known->second.cost <= node.cost) return;
  known->second = node;
  open_.push_back({node.cost + weight * to_go(at), node.cost, at});
  std::ranges::push_heap(open_, std::greater{}, &Entry::estimate);
}

/// Returns the number of moves that were examined.
std::size_t JointAStar::expand(Key at) {
  const float cost = nodes_.at(at).cost;
  std::size_t moves = 0;
  const auto robots = static_cast<std::uint16_t>(cluster_.size());
  for (std::uint16_t robot = 0; robot < robots; ++robot) {
    const std::vector<AnnotatedRoadmap::Edge>& edges = cluster_.graph().edges(place(at, robot));
    const auto count = static_cast<std::uint16_t>(edges.size());
    moves += count;
    for (std::uint16_t k = 0; k < count; ++k) {
      if (!is_clear(at, robot, edges[k])) continue;
      reach(moved(at, robot, edges[k].to), {cost + static_cast<float>(edges[k].length), robot, k, at});
    }
  }
  return moves;
}

SearchState JointAStar::step() {
  for (std::size_t moves = 0; moves < moves_a_step;) {
    if (end_) return SearchState::solved;
    if (open_.empty() || nodes_.size() > most_remembered) return SearchState::gave_up;
    const Entry next = open_.front();
    std::ranges::pop_heap(open_, std::greater{}, &Entry::estimate);
    open_.pop_back();
    // The configuration was reached by a shorter way after this entry was made.
    if (next.cost > nodes_.at(next.at).cost) continue;
    if (is_goal(next.at)) {
      end_ = next.at;
    } else {
      moves += expand(next.at);
    }
  }
  return SearchState::searching;
}

std::vector<VertexMove> JointAStar::moves() const {
  std::vector<VertexMove> moves;
  for (Key at = *end_; at != start_; at = nodes_.at(at).parent) {
    const Node& node = nodes_.at(at);
    moves.push_back({node.robot, place(node.parent, node.robot), node.edge});
  }
  std::ranges::reverse(moves);
  return moves;
}

}  // namespace coppice
