// The tree broker grows the disjointed trees of the whole fleet and publishes each tree once it is inactive.
//
// It grows ahead as soon as it has the map, so that a mission finds trees. Then it learns of groups from the
// missions, of their root trees from `root_nodes`, and of their success from `agent_status`.
//
// Several brokers may serve one fleet: one leads, the others stand by. Each knows all inactive trees, its own
// and those of others. If the leader falls silent, another broker follows it and publishes all trees again,
// for processes that come later.
//
// A state machine: messages and the time go in, messages come out; no clock, thread or I/O.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "messages/bus.h"
#include "messages/messages.h"
#include "planning/trees/ma_rrdt_star.h"

namespace coppice {

class TreeBroker {
 public:
  /// `id` distinguishes this broker's trees from those of others. `seed` determines all random choices.
  TreeBroker(std::uint64_t id, std::uint64_t seed) : id_(id), seed_(seed) {}

  /// Restores the saved state of a predecessor (journal.h): the map, its trees, and whether these cover the
  /// map. Call it first. The broker then listens for 1 s for a leader.
  void recall(std::span<const Message> known, WallTime now);

  void on(const Arrival& arrival);
  /// Takes the bus's counters, for the status.
  void note(const BusCounts& counts, WallTime) { counts_ = counts; }
  /// Runs at most 500 iterations, about 0.5 ms, if there is something to grow. Returns the messages to
  /// publish.
  std::vector<Message> step(WallTime now);
  /// When `step` has something to do even if nothing arrives.
  WallTime next_wake() const { return next_wake_; }
  /// Whether this broker grows and publishes trees; otherwise another one does.
  bool leads() const { return leads_since_.has_value(); }

 private:
  using Planner = MaRrdtStar<ClearanceField>;

  /// Where a node is published.
  struct Place {
    TreesId trees{};
    std::optional<std::uint32_t> index{};  ///< none: it belongs to no inactive tree
  };
  /// The trees of one map. A new map begins with none.
  struct Forest {
    /// A forest whose steps suit robots of `radius`.
    Forest(const MapMessage& map, double radius, const TreeParameters& parameters, Random random);
    void name(const TreesId& id, std::vector<NodeId> nodes);

    ClearanceField field;
    Planner planner;
    std::vector<double> uncovered{};  ///< radii to grow ahead for, the largest last
    /// The nodes of inactive trees, in the order in which they are published.
    std::map<TreesId, std::vector<NodeId>> inactive{};
    std::vector<Place> places{};    ///< by node
    std::uint32_t trees = 0;        ///< number of all of `inactive`
    std::vector<TreesId> unsaid{};  ///< inactive trees that this broker has not published yet
    std::set<TreesId> recalled{};   ///< trees of `unsaid` that no broker has published since the restart
  };
  using Leader = std::pair<WallTime, std::uint64_t>;  ///< since when it leads, and its id
  /// Another broker whose status is recent.
  struct Other {
    std::optional<WallTime> leads_since{};
    WallTime heard_at = 0;
  };
  struct Group {
    RunId run;
    std::uint32_t mission = 0;
    GroupIndex index = 0;
    std::uint32_t nodes_received = 0;
  };

  void receive(const MapMessage& message, WallTime arrived);
  void receive(const Mission& mission, WallTime arrived);
  void receive(const RootNodes& batch, WallTime arrived);
  void receive(const InactiveTreesMessage& trees, WallTime arrived);
  void receive(const AgentStatus& status, WallTime arrived);
  void receive(const BrokerStatus& status, WallTime arrived);
  Group* group_of(const RobotName& robot, const RunId& run, std::uint32_t mission);
  void end_group(const RobotName& robot);
  std::optional<Leader> leader_among_others() const;
  void follow(const Leader& leader, WallTime now);
  bool grow();
  void take_up_waiting_trees(WallTime now);
  void take_frozen();
  void publish_trees(std::vector<Message>& out);
  void publish_recalled(std::vector<Message>& out);
  InactiveTreesMessage describe(const TreesId& id) const;
  ActiveTreesMessage active_trees() const;
  BrokerStatus status() const;

  std::uint64_t id_;
  std::uint64_t seed_;
  std::optional<MapMessage> map_;
  std::map<RobotName, Mission> waiting_missions_;    ///< missions for a map that has not arrived yet
  std::vector<InactiveTreesMessage> waiting_trees_;  ///< trees for a map that has not arrived yet
  std::size_t waiting_nodes_ = 0;                    ///< number of nodes of `waiting_trees_`
  std::unique_ptr<Forest> forest_;
  std::map<RobotName, Group> groups_;
  std::map<std::uint64_t, Other> others_;
  std::uint32_t frozen_ = 0;    ///< number of sets of trees that this broker has frozen
  std::uint64_t followed_ = 0;  ///< id of the broker that leads while this one stands by; 0: none
  std::optional<WallTime> leads_since_;
  WallTime listens_until_ = 0;
  BusCounts counts_{};
  std::uint32_t impossible_ = 0;  ///< number of messages that exceeded a limit or were not valid
  WallTime next_wake_ = 0;
  WallTime next_status_ = 0;
  WallTime next_active_trees_ = 0;
  bool shows_active_trees_ = false;  ///< whether the last message about active trees held any
};

}  // namespace coppice
