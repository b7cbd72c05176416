#include "motion/joint/lacam.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "planning/shuffle.h"

namespace coppice {

namespace {

// A depth-first search may lose itself in a corridor where the robot that must wait has to go far the other
// way first. So the search continues from a random configuration now and then (as in Okumura's "Engineering
// LaCAM*", 2024). Configurations.
constexpr std::size_t before_it_is_stuck = 1000;
constexpr std::size_t between_looks_back = 50;
// Robots in configurations, of about 10 bytes each: at most 5 MB of an agent.
constexpr std::size_t most_remembered = 500'000;

std::uint64_t hash_of(const std::vector<Vertex>& at) {  // FNV-1a
  std::uint64_t hash = 14695981039346656037U;
  for (const Vertex place : at) hash = (hash ^ place) * 1099511628211U;
  return hash;
}

}  // namespace

Lacam::Lacam(Cluster& cluster, Random random) : cluster_(cluster), random_(random), pibt_(cluster) {
  for (std::uint32_t i = 0; i < cluster_.size(); ++i) {
    const auto& [start, goal] = cluster_.tasks()[i];
    least_.push_back(goal ? 1 - 1 / (1 + cluster_.cost(i, start)) : -1);
  }
  open_.push_back(add(cluster_.starts(), {}, 0));
}

/// The steps lead from the parent to this configuration.
std::size_t Lacam::add(const Configuration& at, const std::vector<Pibt::Step>& steps, std::size_t parent) {
  Node node{at, static_cast<std::uint32_t>(parent), steps, std::vector<std::uint16_t>(at.size()), {{}}};
  for (std::uint32_t i = 0; i < at.size() && !nodes_.empty(); ++i) {
    constexpr std::uint16_t most = std::numeric_limits<std::uint16_t>::max();
    const std::uint16_t before = nodes_[parent].waits[i];
    if (!cluster_.at_goal(i, at[i]))
      node.waits[i] = before < most ? static_cast<std::uint16_t>(before + 1) : most;
  }
  const auto added = nodes_.size();
  const std::size_t under_way = under_way_in(at).size();
  if (nodes_.empty() || under_way < least_under_way_) {
    best_ = added;
    least_under_way_ = under_way;
  }
  known_.emplace(hash_of(at), added);
  nodes_.push_back(std::move(node));
  return added;
}

/// A robot's priority grows until it is at its goal. The robot with the longest way begins with the highest.
void Lacam::set_order(const Node& node) {
  order_.resize(node.at.size());
  std::iota(order_.begin(), order_.end(), 0U);
  std::ranges::stable_sort(order_, std::greater{},
                           [&](std::uint32_t i) { return static_cast<float>(node.waits[i]) + least_[i]; });
}

std::optional<std::size_t> Lacam::known(const Configuration& at) const {
  const auto [first, last] = known_.equal_range(hash_of(at));
  const auto found =
      std::find_if(first, last, [&](const auto& entry) { return nodes_[entry.second].at == at; });
  return found == last ? std::nullopt : std::optional(found->second);
}

SearchState Lacam::search(std::size_t configurations) {
  for (std::size_t k = 0; k < configurations; ++k) {
    if (least_under_way_ == 0) return SearchState::solved;
    if (open_.empty() || nodes_.size() * cluster_.size() > most_remembered) return SearchState::gave_up;
    const bool stuck = nodes_.size() > before_it_is_stuck && random_.index(between_looks_back) == 0;
    if (stuck) open_.push_back(random_.index(nodes_.size()));
    const std::size_t deepest = open_.back();  // the paper's high-level node
    Node& node = nodes_[deepest];
    if (node.tried == node.constraints.size()) {
      open_.pop_back();
      continue;
    }
    set_order(node);
    if (!pibt_.generate(node.at, order_, next_constraints(node), random_)) continue;
    const auto again = known(pibt_.next());
    open_.push_back(again ? *again : add(pibt_.next(), pibt_.steps(), deepest));
  }
  return SearchState::searching;
}

/// The next set of constraints: the paper's low-level node. Sets that force one robot more are appended, in
/// the order of the priorities.
std::vector<Pibt::Forced> Lacam::next_constraints(Node& node) {
  const std::uint32_t number = node.tried++;
  std::vector<Pibt::Forced> set;
  for (std::uint32_t k = number; k != 0; k = node.constraints[k].others)
    set.push_back(node.constraints[k].last);
  std::ranges::reverse(set);
  if (set.size() < node.at.size()) {
    const std::uint32_t robot = order_[set.size()];
    std::vector<Vertex> ends{node.at[robot]};
    for (const AnnotatedRoadmap::Edge& edge : cluster_.graph().edges(node.at[robot])) ends.push_back(edge.to);
    shuffle(ends, random_);
    for (const Vertex end : ends) node.constraints.push_back({number, {robot, end}});
  }
  return set;
}

std::vector<std::uint32_t> Lacam::under_way() const {
  return under_way_in(nodes_[open_.empty() ? 0 : open_.back()].at);
}

std::vector<std::uint32_t> Lacam::under_way_in(const Configuration& at) const {
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < at.size(); ++i) {
    if (!cluster_.at_goal(i, at[i])) result.push_back(i);
  }
  return result;
}

std::vector<VertexMove> Lacam::moves() const {
  std::vector<std::size_t> chain;
  for (std::size_t k = best_; k != 0; k = nodes_[k].parent) chain.push_back(k);
  std::vector<VertexMove> all;
  for (auto k = chain.rbegin(); k != chain.rend(); ++k) {
    const Configuration& before = nodes_[nodes_[*k].parent].at;
    for (const auto& [robot, edge] : nodes_[*k].steps) all.push_back({robot, before[robot], edge});
  }
  return all;
}

}  // namespace coppice
