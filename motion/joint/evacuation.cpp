#include "motion/joint/evacuation.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "planning/shuffle.h"

namespace coppice {

namespace {

constexpr int ways_a_step = 8;                   // about 10 ms
constexpr std::size_t most_effort = 20'000'000;  // edges examined: about 1 s
constexpr std::size_t configurations_at_once = 100;
constexpr int exchange_steps = 50;
constexpr int most_attempts = 12;
constexpr int first_with_everybody = 1;  // first attempt that also evacuates robots that stand at their goals
constexpr int first_shuffled = 2;        // first attempt with the robots in a random order

std::vector<VertexMove> reversed(const AnnotatedRoadmap& graph, const std::vector<VertexMove>& moves) {
  std::vector<VertexMove> back;
  for (auto move = moves.rbegin(); move != moves.rend(); ++move) {
    const Vertex to = graph.edges(move->from)[move->edge].to;
    const auto edge = std::ranges::find(graph.edges(to), move->from, &AnnotatedRoadmap::Edge::to);
    back.push_back({move->robot, to, static_cast<std::uint32_t>(edge - graph.edges(to).begin())});
  }
  return back;
}

}  // namespace

Evacuation::Evacuation(Cluster& cluster, Random random)
    : cluster_(cluster), random_(random), stage_(begun_attempt()) {
  if (goals_touch()) attempts_ = most_attempts;
}

/// Whether two robots cannot stand at their goals at the same time.
bool Evacuation::goals_touch() const {
  const std::vector<VertexTask>& tasks = cluster_.tasks();
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    for (std::size_t k = 0; tasks[i].goal && k < i; ++k) {
      if (tasks[k].goal && cluster_.graph().touch(*tasks[i].goal, *tasks[k].goal)) return true;
    }
  }
  return false;
}

Evacuation::Leaves Evacuation::begun_attempt() {
  order_.resize(cluster_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  if (attempts_ >= first_shuffled) shuffle(order_, random_);
  std::vector<Parking::Robot> robots;
  for (const auto& [start, goal] : cluster_.tasks())
    robots.push_back({start, goal, goal != start || attempts_ >= first_with_everybody});
  return {Parking(cluster_.graph(), std::move(robots), order_)};
}

Parking Evacuation::from_the_goals(const Parking& first) const {
  std::vector<Parking::Robot> robots;
  for (std::uint32_t i = 0; i < cluster_.size(); ++i) {
    const auto& [start, goal] = cluster_.tasks()[i];
    robots.push_back(
        {goal.value_or(first.at(i)), first.at(i), goal != start || attempts_ >= first_with_everybody});
  }
  return {cluster_.graph(), std::move(robots), order_};
}

Evacuation::Exchanges Evacuation::exchange(Parking first, Parking second) const {
  std::vector<VertexTask> tasks;
  for (std::uint32_t i = 0; i < cluster_.size(); ++i) tasks.push_back({first.at(i), second.at(i)});
  auto cluster = std::make_unique<Cluster>(cluster_.graph(), std::move(tasks));
  Lacam lacam(*cluster, random_);
  return {std::move(first), std::move(second), std::move(cluster), std::move(lacam), exchange_steps};
}

SearchState Evacuation::Exchanges::step() {
  if (!cluster->shut_in().empty() || steps_left-- == 0) return SearchState::gave_up;
  return lacam.search(configurations_at_once);
}

SearchState Evacuation::step() {
  for (int k = 0; k < ways_a_step && attempts_ < most_attempts; ++k) {
    const SearchState progress = std::visit([](auto& stage) { return stage.step(); }, stage_);
    if (progress == SearchState::solved && !go_on()) return SearchState::solved;
    const std::size_t effort = std::visit([](const auto& stage) { return stage.effort(); }, stage_);
    if (effort_ + effort > most_effort) attempts_ = most_attempts;
    if (progress == SearchState::gave_up && ++attempts_ < most_attempts) {
      effort_ += effort;
      Leaves next = begun_attempt();
      stage_.emplace<Leaves>(std::move(next));
    }
  }
  return attempts_ < most_attempts ? SearchState::searching : SearchState::gave_up;
}

/// The next stage. False: there is none.
bool Evacuation::go_on() {
  if (auto* const leaves = std::get_if<Leaves>(&stage_)) {
    Parking second = from_the_goals(leaves->first);
    Returns next{std::move(leaves->first), std::move(second)};
    stage_.emplace<Returns>(std::move(next));
    return true;
  }
  if (auto* const returns = std::get_if<Returns>(&stage_)) {
    Exchanges next = exchange(std::move(returns->first), std::move(returns->second));
    stage_.emplace<Exchanges>(std::move(next));
    return true;
  }
  return false;
}

std::vector<VertexMove> Evacuation::moves() const {
  const auto& exchanges = std::get<Exchanges>(stage_);
  std::vector<VertexMove> all = exchanges.first.moves();
  for (const auto& moves : {exchanges.lacam.moves(), reversed(cluster_.graph(), exchanges.second.moves())})
    all.insert(all.end(), moves.begin(), moves.end());
  return all;
}

}  // namespace coppice
