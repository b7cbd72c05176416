// The tree broker: grows the disjointed trees of the whole fleet and publishes each once it is inactive.
//
// It grows ahead as soon as it has the map, so that a mission finds trees in place. Then it learns of the
// groups from the missions, of their root trees from `root_nodes`, and of their success from `agent_status`.
// A state machine: messages and the time go in, messages come out; no clock, thread or I/O.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.h"
#include "bus/messages.h"
#include "planning/clearance_field.h"
#include "planning/ma_rrdt_star.h"

namespace coppice {

class TreeBroker {
 public:
  /// `id` tells this broker's trees from those of every other one; `seed` is of every random choice.
  TreeBroker(std::uint64_t id, std::uint64_t seed) : id_(id), seed_(seed) {}

  void on(const Arrival& arrival);
  /// Grows for about a millisecond if there is something to grow; returns what is to be published.
  std::vector<Message> step(WallTime now);
  /// When `step` has something to do even if nothing arrives.
  WallTime next_wake() const { return next_wake_; }

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
  };
  struct Group {
    std::uint32_t mission = 0;
    GroupIndex index = 0;
    std::uint32_t nodes_received = 0;
  };

  void receive(const MapMessage& message);
  void receive(const Mission& mission);
  void receive(const RootNodes& batch);
  void receive(const AgentStatus& status);
  void end_group(const RobotName& robot);
  bool grow();
  InactiveTreeMessage describe(TreeIndex tree);
  BrokerStatus status() const;

  std::uint64_t id_;
  std::uint64_t seed_;
  std::optional<MapMessage> map_;
  std::map<RobotName, Mission> waiting_missions_;  ///< for a map that is not there yet
  std::unique_ptr<Forest> forest_;
  std::map<RobotName, Group> groups_;
  std::uint32_t published_ = 0;
  WallTime next_wake_ = 0;
  WallTime next_status_ = 0;
};

}  // namespace coppice
