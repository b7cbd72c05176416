// The tree broker: grows the disjointed trees of the whole fleet and publishes each once it is inactive.
//
// It grows ahead as soon as it has the map, so that a mission finds trees in place. Then it learns of the
// groups from the missions, of their root trees from `root_nodes`, and of their success from `agent_status`.
//
// Several brokers may serve one fleet: one leads, the others stand by. Each knows every inactive tree, its
// own and those that it hears of; who leads and falls silent is followed by another, which publishes all of
// them anew, for those who come later.
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

#include "messages/bus.h"
#include "messages/messages.h"
#include "planning/clearance_field.h"
#include "planning/ma_rrdt_star.h"

namespace coppice {

class TreeBroker {
 public:
  /// `id` tells this broker's trees from those of every other one; `seed` is of every random choice.
  TreeBroker(std::uint64_t id, std::uint64_t seed) : id_(id), seed_(seed) {}

  /// What a broker knew whose place it takes (journal.h): the map and trees, and that these cover the map.
  /// Before anything else; it then listens for a second to who leads by now.
  void recall(std::span<const Message> known, WallTime now);

  void on(const Arrival& arrival);
  /// What the process's bus has counted, for the status.
  void note(const BusCounts& counts, WallTime) { counts_ = counts; }
  /// Grows for about a millisecond if there is something to grow; returns what is to be published.
  std::vector<Message> step(WallTime now);
  /// When `step` has something to do even if nothing arrives.
  WallTime next_wake() const { return next_wake_; }
  /// It grows trees, and publishes them; otherwise another one does.
  bool leads() const { return leads_since_.has_value(); }

 private:
  using Planner = MaRrdtStar<ClearanceField>;

  /// The trees of one map; a new map begins with none.
  struct Forest {
    /// With steps that suit robots of `radius`.
    Forest(const OccupancyMap& map, double radius, Random random);
    ClearanceField field;
    double epsilon;
    Planner planner;
    std::vector<double> uncovered{};  ///< radii to grow ahead for, the largest last
    std::map<TreeId, TreeIndex> inactive{};
    std::vector<TreeId> unsaid{};  ///< inactive, and not published by this broker yet
    std::set<TreeId> recalled{};   ///< of these, those that nobody has published since
  };
  using Leader = std::pair<WallTime, std::uint64_t>;  ///< since when, and who
  /// Another broker that was heard of a moment ago.
  struct Other {
    std::optional<WallTime> leads_since{};
    WallTime heard_at = 0;
  };
  struct Group {
    WallTime run = 0;
    std::uint32_t mission = 0;
    GroupIndex index = 0;
    std::uint32_t nodes_received = 0;
  };

  void receive(const MapMessage& message, WallTime arrived);
  void receive(const Mission& mission, WallTime arrived);
  void receive(const RootNodes& batch, WallTime arrived);
  void receive(const InactiveTreeMessage& tree, WallTime arrived);
  void receive(const AgentStatus& status, WallTime arrived);
  void receive(const BrokerStatus& status, WallTime arrived);
  Group* group_of(const RobotName& robot, WallTime run, std::uint32_t mission);
  void end_group(const RobotName& robot);
  void reckon_with_a_clock_set_back(WallTime now);
  std::optional<Leader> leader_among_others() const;
  void follow(const Leader& leader, WallTime now);
  bool grow();
  void take_up_waiting_trees(WallTime now);
  void publish_trees(std::vector<Message>& out);
  void publish_recalled(std::vector<Message>& out);
  InactiveTreeMessage describe(const TreeId& id) const;
  ActiveTreesMessage active_trees() const;
  BrokerStatus status() const;

  std::uint64_t id_;
  std::uint64_t seed_;
  std::optional<MapMessage> map_;
  std::map<RobotName, Mission> waiting_missions_;   ///< for a map that is not there yet
  std::vector<InactiveTreeMessage> waiting_trees_;  ///< likewise
  std::size_t waiting_nodes_ = 0;                   ///< of these
  std::unique_ptr<Forest> forest_;
  std::map<RobotName, Group> groups_;
  std::map<std::uint64_t, Other> others_;
  std::uint32_t frozen_ = 0;    ///< by this broker
  std::uint64_t followed_ = 0;  ///< the broker that leads while this one stands by; 0: none
  std::optional<WallTime> leads_since_;
  WallTime listens_until_ = 0;
  BusCounts counts_{};
  std::uint32_t impossible_ = 0;  ///< messages that were too many
  WallTime next_wake_ = 0;
  WallTime next_status_ = 0;
  WallTime next_active_trees_ = 0;
  bool shows_active_trees_ = false;  ///< what it said last of them holds some
};

}  // namespace coppice
