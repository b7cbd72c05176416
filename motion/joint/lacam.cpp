#include "motion/joint/lacam.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "planning/shuffle.h"

namespace coppice {

namespace {

constexpr float unreachable = std::numeric_limits<float>::infinity();
// A way without robots to push is preferred if its detour is at most this share of the edge's length. Among
// ways that are about equally good, the choice is random.
constexpr double detour_for_a_free_way = 0.3;
constexpr double indifference = 0.01;
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

bool contains(const std::vector<Vertex>& places, Vertex place) {
  return std::ranges::binary_search(places, place);
}

}  // namespace

Lacam::Lacam(const AnnotatedRoadmap& graph, std::vector<VertexTask> tasks, Random random)
    : graph_(graph),
      tasks_(std::move(tasks)),
      random_(random),
      numbers_(numbers_by_neighbourhood(graph)),
      cost_to_go_(tasks_.size()),
      occupant_(graph.size(), nobody),
      decided_(tasks_.size()),
      forced_(tasks_.size()) {
  for (std::uint32_t i = 0; i < tasks_.size(); ++i) {
    at_.push_back(tasks_[i].start);
    least_.push_back(-1);
    if (!tasks_[i].goal) continue;
    cost_to_go_[i].emplace(graph_, numbers_, *tasks_[i].goal, tasks_[i].start);
    least_.back() = 1 - 1 / (1 + cost(i, tasks_[i].start));
    if (cost(i, tasks_[i].start) != unreachable) continue;
    least_.back() = -1;
    cost_to_go_[i].reset();
    tasks_[i].goal.reset();
    shut_in_.push_back(i);
  }
  open_.push_back(add(at_, 0));
}

/// `steps_` lead from the parent to this configuration.
std::size_t Lacam::add(const Configuration& at, std::size_t parent) {
  Node node{at, static_cast<std::uint32_t>(parent), steps_, std::vector<std::uint16_t>(at.size()), {{}}};
  for (std::uint32_t i = 0; i < at.size() && !nodes_.empty(); ++i) {
    constexpr std::uint16_t most = std::numeric_limits<std::uint16_t>::max();
    const std::uint16_t before = nodes_[parent].waits[i];
    if (!at_goal(i, at[i])) node.waits[i] = before < most ? static_cast<std::uint16_t>(before + 1) : most;
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

Lacam::Outcome Lacam::search(std::size_t configurations) {
  for (std::size_t k = 0; k < configurations; ++k) {
    if (least_under_way_ == 0) return Outcome::solved;
    if (open_.empty()) return Outcome::no_solution;
    if (nodes_.size() * tasks_.size() > most_remembered) return Outcome::too_large;
    const bool stuck = nodes_.size() > before_it_is_stuck && random_.index(between_looks_back) == 0;
    if (stuck) open_.push_back(random_.index(nodes_.size()));
    const std::size_t deepest = open_.back();
    Node& node = nodes_[deepest];
    if (node.tried == node.constraints.size()) {
      open_.pop_back();
      continue;
    }
    set_order(node);
    if (!generate(node, next_constraints(node))) continue;
    const auto again = known(at_);
    open_.push_back(again ? *again : add(at_, deepest));
  }
  return Outcome::searching;
}

/// The next set of constraints. Sets that force one robot more are appended, in the order of the priorities.
std::vector<Lacam::Forced> Lacam::next_constraints(Node& node) {
  const std::uint32_t number = node.tried++;
  std::vector<Forced> set;
  for (std::uint32_t k = number; k != 0; k = node.constraints[k].others)
    set.push_back(node.constraints[k].last);
  std::ranges::reverse(set);
  if (set.size() < node.at.size()) {
    const std::uint32_t robot = order_[set.size()];
    std::vector<Vertex> ends{node.at[robot]};
    for (const AnnotatedRoadmap::Edge& edge : graph_.edges(node.at[robot])) ends.push_back(edge.to);
    shuffle(ends, random_);
    for (const Vertex end : ends) node.constraints.push_back({number, {robot, end}});
  }
  return set;
}

/// Generates the next configuration in `at_`, and the moves that lead there. Returns false if the forced
/// moves cannot be made.
bool Lacam::generate(const Node& node, const std::vector<Forced>& forced) {
  for (const Vertex place : at_) occupant_[place] = nobody;
  at_ = node.at;
  for (std::uint32_t i = 0; i < at_.size(); ++i) occupant_[at_[i]] = i;
  decided_.assign(at_.size(), false);
  forced_.assign(at_.size(), std::nullopt);
  for (const auto& [robot, to] : forced) forced_[robot] = to;
  steps_.clear();
  for (const auto& [robot, to] : forced) {
    if (!decided_[robot]) push(robot);
    if (at_[robot] != to) return false;
  }
  for (const std::uint32_t robot : order_) {
    if (!decided_[robot]) push(robot);
  }
  return true;
}

/// The next moves of a robot, the best first.
std::vector<Lacam::Candidate> Lacam::candidates(std::uint32_t robot) {
  const Vertex here = at_[robot];
  std::vector<Candidate> result;
  if (!forced_[robot] || forced_[robot] == here) result.push_back({cost(robot, here), nullptr});
  for (const AnnotatedRoadmap::Edge& edge : graph_.edges(here)) {
    if (forced_[robot] && forced_[robot] != edge.to) continue;
    const float there = cost(robot, edge.to);
    if (there == unreachable) continue;
    const double pushing = empty_around(edge, robot) ? 0 : detour_for_a_free_way;
    const double whim = indifference * random_.uniform();
    result.push_back({there + static_cast<float>((pushing + whim) * edge.length), &edge});
  }
  std::ranges::stable_sort(result, std::less{}, &Candidate::cost);
  return result;
}

/// Whether a move is out of the way of all robots that wait for this one: it does not touch them where they
/// are, and it ends where they do not touch this robot.
bool Lacam::in_nobodys_way(Vertex here, const AnnotatedRoadmap::Edge* edge) const {
  const Vertex end = edge != nullptr ? edge->to : here;
  return std::ranges::none_of(reserved_, [&](const Reserved& other) {
    return contains(other.edge->near, end) || (edge != nullptr && contains(edge->near, other.from));
  });
}

bool Lacam::empty_around(const AnnotatedRoadmap::Edge& edge, std::uint32_t robot) const {
  return std::ranges::all_of(
      edge.near, [&](Vertex place) { return occupant_[place] == nobody || occupant_[place] == robot; });
}

/// Makes all robots move that stand near the edge. Robots that have moved stay there even if another robot
/// cannot move.
bool Lacam::clear(const AnnotatedRoadmap::Edge& edge, std::uint32_t robot) {
  const auto stays = [&](Vertex place) {
    const std::uint32_t other = occupant_[place];
    return other != nobody && other != robot && decided_[other];
  };
  if (std::ranges::any_of(edge.near, stays)) return false;
  reserved_.push_back({at_[robot], &edge});
  for (const Vertex place : edge.near) {
    const std::uint32_t other = occupant_[place];
    if (other != nobody && other != robot && (decided_[other] || !push(other))) break;
  }
  reserved_.pop_back();
  return empty_around(edge, robot);
}

/// PIBT: the robot takes the best move for which all robots in its way can make room. Returns false if the
/// robot stays where it is.
bool Lacam::push(std::uint32_t robot) {
  decided_[robot] = true;
  const Vertex here = at_[robot];
  for (const auto& [cost, edge] : candidates(robot)) {
    if (!in_nobodys_way(here, edge)) continue;
    if (edge == nullptr) return false;
    if (!clear(*edge, robot)) continue;
    occupant_[here] = nobody;
    occupant_[edge->to] = robot;
    at_[robot] = edge->to;
    steps_.push_back(
        {static_cast<std::uint16_t>(robot), static_cast<std::uint16_t>(edge - graph_.edges(here).data())});
    return true;
  }
  return false;
}

std::vector<std::uint32_t> Lacam::under_way() const {
  return under_way_in(nodes_[open_.empty() ? 0 : open_.back()].at);
}

std::vector<std::uint32_t> Lacam::under_way_in(const Configuration& at) const {
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < at.size(); ++i) {
    if (!at_goal(i, at[i])) result.push_back(i);
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
