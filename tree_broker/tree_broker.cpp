#include "tree_broker/tree_broker.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "messages/tree_message.h"
#include "messages/validation.h"
#include "planning/quantities.h"
#include "planning/trees/suggestions.h"

namespace coppice {

namespace {

constexpr int iterations_a_step = 500;   // about 0.5 ms, so that new root nodes are seen soon
constexpr WallTime status_period = 0.5;  // seconds
constexpr std::size_t most_waiting_trees = 10'000;
constexpr WallTime lease = 1.5;            // seconds without a status after which a leader counts as gone
constexpr std::size_t most_others = 1000;  // other brokers at a time; the limit bounds the memory
constexpr WallTime first_listening = 1;    // seconds; a leader publishes its status twice in this time
constexpr WallTime longest_news = 2;       // seconds until all trees that other brokers publish have arrived
constexpr WallTime active_trees_period = 0.1;      // seconds
constexpr std::size_t most_active_edges = 20'000;  // edges that are published for display
constexpr std::size_t most_nodes = 4'000'000;  // about 500 MB of trees; a fleet that needs more has no path

}  // namespace

TreeBroker::Forest::Forest(const MapMessage& map, double radius, const TreeParameters& parameters,
                           Random random)
    : field(map.map, map.margin), planner(field, completed(parameters, field, radius), random) {}

void TreeBroker::Forest::name(const TreesId& id, std::vector<NodeId> nodes) {
  places.resize(planner.trees().node_count());
  for (std::size_t i = 0; i < nodes.size(); ++i) places[nodes[i]] = {id, static_cast<std::uint32_t>(i)};
  inactive.emplace(id, std::move(nodes));
  unsaid.push_back(id);
}

void TreeBroker::recall(std::span<const Message> known, WallTime now) {
  for (const Message& message : known) on(arrival_of(message, now));
  others_.clear();
  if (known.empty()) return;
  listens_until_ = now + first_listening;
  if (forest_) forest_->recalled.insert(forest_->unsaid.begin(), forest_->unsaid.end());
}

void TreeBroker::on(const Arrival& arrival) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, arrival.at); }) receive(m, arrival.at);
      },
      *arrival.message);
  next_wake_ = arrival.at;
}

void TreeBroker::receive(const MapMessage& message, WallTime arrived) {
  if (map_ && map_->map_id == message.map_id) return;
  map_ = message;
  forest_.reset();
  groups_.clear();
  if (!message.radii.empty()) {
    // The trees of large robots also serve small ones. Small robots need further trees only where no large
    // robot fits.
    std::vector<double> radii = message.radii;
    std::ranges::sort(radii);
    forest_ = std::make_unique<Forest>(*map_, radii.back(), map_->trees, Random(seed_));
    forest_->uncovered = std::move(radii);
  }
  take_up_waiting_trees(arrived);
  for (const auto& [robot, mission] : std::exchange(waiting_missions_, {})) receive(mission, arrived);
}

/// Trees that another broker grew, or this one before its restart.
void TreeBroker::receive(const InactiveTreesMessage& trees, WallTime) {
  if (!forest_ || map_->map_id != trees.map_id) {
    if (waiting_trees_.size() >= most_waiting_trees || waiting_nodes_ + trees.nodes.size() > most_nodes) {
      ++impossible_;
      return;
    }
    waiting_nodes_ += trees.nodes.size();
    waiting_trees_.push_back(trees);
    return;
  }
  forest_->recalled.erase(trees.id);
  if (forest_->inactive.contains(trees.id)) return;
  if (forest_->planner.trees().node_count() + trees.nodes.size() > most_nodes ||
      !are_free(trees, forest_->field)) {
    ++impossible_;
    return;
  }
  const NodeId first = forest_->planner.add_inactive_trees(frozen_trees_of(trees));
  forest_->planner.look_for_links(first);
  std::vector<NodeId> nodes(trees.nodes.size());
  std::iota(nodes.begin(), nodes.end(), first);
  forest_->name(trees.id, std::move(nodes));
  forest_->trees += number_of_trees(trees);
}

/// Processes the trees that arrived before the map. Trees of other maps belong to runs that are over.
void TreeBroker::take_up_waiting_trees(WallTime now) {
  if (!forest_) return;
  waiting_nodes_ = 0;
  for (const InactiveTreesMessage& trees : std::exchange(waiting_trees_, {})) {
    if (trees.map_id == map_->map_id) receive(trees, now);
  }
}

void TreeBroker::receive(const BrokerStatus& status, WallTime arrived) {
  if (others_.size() >= most_others && !others_.contains(status.broker)) {
    ++impossible_;
    return;
  }
  if (status.broker != id_)
    others_[status.broker] = {status.leads ? std::optional(status.leading_since) : std::nullopt, arrived};
  // A broker that has all trees of one that covered the map has covered it, too.
  const bool covers = forest_ && status.covered_map == map_->map_id;
  if (covers && forest_->trees >= status.trees_published) forest_->uncovered.clear();
}

/// Several brokers may lead because they did not hear of each other. The one that has led for longest
/// continues.
std::optional<TreeBroker::Leader> TreeBroker::leader_among_others() const {
  std::optional<Leader> leader;
  for (const auto& [id, other] : others_) {
    if (!other.leads_since) continue;
    const Leader one{*other.leads_since, id};
    if (!leader || one < *leader) leader = one;
  }
  return leader;
}

/// The new leader may have started without trees that its predecessor published and that only this broker has
/// received.
void TreeBroker::follow(const Leader& leader, WallTime now) {
  const std::uint64_t before = std::exchange(followed_, leader.second);
  if (before == 0 || before == followed_ || !forest_) return;
  listens_until_ = now;
  forest_->recalled.insert(forest_->unsaid.begin(), forest_->unsaid.end());
}

/// Each mission that is not over is a group. A newer mission of a robot ends the older one.
void TreeBroker::receive(const Mission& mission, WallTime arrived) {
  if (!map_ || map_->map_id != mission.map_id) {
    if (waiting_missions_.size() < most_robots || waiting_missions_.contains(mission.robot)) {
      waiting_missions_[mission.robot] = mission;
    } else {
      ++impossible_;
    }
    return;
  }
  const RunId run = mission.clock.run();
  if (group_of(mission.robot, run, mission.number) != nullptr && !mission.cancelled) return;
  end_group(mission.robot);
  if (mission.cancelled || mission.planner != PlannerKind::ma_rrdt_star) return;
  if (!forest_) {
    forest_ = std::make_unique<Forest>(*map_, driving_radius(mission), mission.trees, Random(seed_));
    take_up_waiting_trees(arrived);
  }
  const GroupIndex group = forest_->planner.add_remote_group(driving_radius(mission));
  groups_[mission.robot] = {run, mission.number, group, 0};
  // Both roots are known. If both see the forest, as the agent will find too, no tree need grow.
  forest_->planner.add_remote_node(group, Root::start, mission.start);
  forest_->planner.add_remote_node(group, Root::goal, mission.goal);
}

/// The group of that mission; null if the mission is over, or if another one is under way.
TreeBroker::Group* TreeBroker::group_of(const RobotName& robot, const RunId& run, std::uint32_t mission) {
  const auto known = groups_.find(robot);
  if (known == groups_.end()) return nullptr;
  Group& group = known->second;
  return group.run == run && group.mission == mission ? &group : nullptr;
}

void TreeBroker::receive(const RootNodes& batch, WallTime) {
  Group* const group = group_of(batch.robot, batch.run, batch.mission);
  if (group == nullptr) return;
  if (forest_->planner.trees().node_count() + batch.nodes.size() > most_nodes) {
    ++impossible_;
    return;
  }
  for (std::size_t i = 0; i < batch.nodes.size(); ++i) {
    // A batch that is delivered again contains nothing new.
    if (batch.first_index + i < group->nodes_received) continue;
    const RootNodes::Node& node = batch.nodes[i];
    forest_->planner.add_remote_node(group->index, node.side, node.position);
    ++group->nodes_received;
  }
}

void TreeBroker::receive(const AgentStatus& status, WallTime) {
  if (group_of(status.robot, status.run, status.mission) == nullptr) return;
  if (status.phase != Phase::waiting && status.phase != Phase::planning) end_group(status.robot);
}

void TreeBroker::end_group(const RobotName& robot) {
  const auto known = groups_.find(robot);
  if (known == groups_.end()) return;
  forest_->planner.close(known->second.index);
  groups_.erase(known);
}

std::vector<Message> TreeBroker::step(WallTime now) {
  std::vector<Message> out;
  std::erase_if(others_, [&](const auto& other) { return now - other.second.heard_at > lease; });
  const bool led = leads();
  const std::optional<Leader> other = leader_among_others();
  const bool another_leads = other && (!led || *other < Leader{*leads_since_, id_});
  const bool may_lead = now >= listens_until_ && !another_leads;
  if (may_lead != led) leads_since_ = may_lead ? std::optional(now) : std::nullopt;
  if (other && !leads()) follow(*other, now);
  bool grows = forest_ != nullptr && leads();
  for (int i = 0; i < iterations_a_step && grows; ++i) grows = grow();
  if (forest_ && leads()) publish_trees(out);
  if (forest_ && !leads() && now >= listens_until_ + longest_news) publish_recalled(out);
  if (now >= next_status_ || !out.empty() || leads() != led) {
    out.emplace_back(status());
    next_status_ = now + status_period;
  }
  if (forest_ && now >= next_active_trees_ && (grows || shows_active_trees_)) {
    out.emplace_back(active_trees());
    next_active_trees_ = now + active_trees_period;
    shows_active_trees_ = grows;
  }
  next_wake_ = grows ? now : next_status_;
  if (other && !leads()) next_wake_ = std::min(next_wake_, others_.at(other->second).heard_at + lease);
  return out;
}

/// Trees that became inactive here get their names, those of one radius together.
void TreeBroker::take_frozen() {
  const Trees<2>& trees = forest_->planner.trees();
  std::map<double, std::vector<NodeId>> frozen;  // by radius
  for (const TreeIndex t : forest_->planner.take_frozen()) {
    std::ranges::copy(breadth_first(trees, t), std::back_inserter(frozen[trees.tree(t).radius]));
    ++forest_->trees;
  }
  for (auto& [radius, nodes] : frozen) forest_->name({id_, frozen_++}, std::move(nodes));
}

/// Publishes all trees that this broker has not published itself: those that it grew and those that it took
/// over.
void TreeBroker::publish_trees(std::vector<Message>& out) {
  take_frozen();
  for (const TreesId& id : std::exchange(forest_->unsaid, {})) out.emplace_back(describe(id));
  forest_->recalled.clear();
}

/// Publishes trees that the leader does not publish: its predecessor was killed before another broker
/// received them.
void TreeBroker::publish_recalled(std::vector<Message>& out) {
  for (const TreesId& id : std::exchange(forest_->recalled, {})) out.emplace_back(describe(id));
}

/// Grows for the groups that wait for trees; if there are none, grows ahead. Returns false if there is
/// nothing to do.
bool TreeBroker::grow() {
  Planner& planner = forest_->planner;
  if (planner.trees().node_count() >= most_nodes) return false;
  if (planner.step()) return true;
  if (forest_->uncovered.empty()) return false;
  if (!planner.grow_ahead(forest_->uncovered.back())) forest_->uncovered.pop_back();
  return true;
}

InactiveTreesMessage TreeBroker::describe(const TreesId& id) const {
  const Trees<2>& trees = forest_->planner.trees();
  const std::vector<NodeId>& nodes = forest_->inactive.at(id);
  const double radius = trees.tree(trees.tree_of(nodes.front())).radius;
  InactiveTreesMessage message{.id = id, .map_id = map_->map_id, .radius = radius, .nodes = {}, .links = {}};
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    std::int32_t parent = -1;
    trees.for_each_edge(nodes[i], [&](const auto& edge) {
      if (edge.to >= forest_->places.size()) return;
      const auto& [other, k] = forest_->places[edge.to];
      if (!k || (other == id && *k > i)) return;  // the later node names the earlier one
      if (trees.tree_of(edge.to) == trees.tree_of(nodes[i])) {
        parent = static_cast<std::int32_t>(*k);
      } else {
        message.links.push_back({i, other, *k});
      }
    });
    const Point2& p = trees.position(nodes[i]);
    const Point2& from = parent < 0 ? p : trees.position(nodes[static_cast<std::size_t>(parent)]);
    // The clearance of the segment may be slightly below the radius by rounding. The check when the edge was
    // added was exact.
    const double clearance = std::max(radius, forest_->field.segment_clearance(from, p));
    message.nodes.push_back({p, parent, clearance});
  }
  return message;
}

ActiveTreesMessage TreeBroker::active_trees() const {
  ActiveTreesMessage message{.broker = id_, .map_id = map_->map_id, .edges = {}};
  if (!leads()) return message;
  forest_->planner.for_each_active_edge([&](const Point2& from, const Point2& to) {
    if (message.edges.size() < most_active_edges) message.edges.push_back({from, to});
  });
  return message;
}

BrokerStatus TreeBroker::status() const {
  BrokerStatus status{.broker = id_,
                      .leads = leads(),
                      .leading_since = leads_since_.value_or(0),
                      .rejected = static_cast<std::uint32_t>(counts_.rejected) + impossible_,
                      .processor_seconds = counts_.processor_seconds};
  if (forest_) {
    status.trees_published = forest_->trees;
    status.nodes_valid = forest_->planner.disjointed_counts().valid;
    status.nodes_invalid = forest_->planner.disjointed_counts().invalid;
    if (forest_->uncovered.empty() && leads()) status.covered_map = map_->map_id;
    status.trees_active = static_cast<std::uint32_t>(forest_->planner.active_trees());
  }
  return status;
}

}  // namespace coppice
