// What can be seen of a fleet from its bus, or from a recording of it: the latest of everything, as values.
//
// A state machine: messages go in, with the time at which they came. Everything that shows a fleet (page,
// Foxglove, metrics, terminal, pictures) looks at this.
//
// Units as in messages/messages.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "messages/messages.h"
#include "messages/name_index.h"
#include "monitor/robot_progress.h"

namespace coppice {

/// What a process needs of its processor, from the totals that it tells of.
struct ProcessorShare {
  double of_one_core = -1;  ///< of late; below 0: not known

  void on(double processor_seconds, WallTime at);

 private:
  std::optional<WallTime> since_{};
  double seconds_then_ = 0;
};

/// Which share of its control periods a robot misses, likewise.
struct MissedShare {
  double of_all = 0;  ///< of late

  void on(std::uint32_t periods, std::uint32_t missed);

 private:
  std::uint32_t periods_then_ = 0;
  std::uint32_t missed_then_ = 0;
};

struct SeenRobot {
  RobotName name;
  std::optional<Mission> mission{};
  std::optional<RobotState> state{};  ///< its own word, the newest
  WallTime heard = 0;                 ///< when that came
  std::optional<AgentStatus> status{};
  std::uint32_t missions_fulfilled = 0;
  Path path{};                                ///< of its mission, or of its next; empty: none
  std::uint32_t path_mission = 0;             ///< of which one
  std::uint32_t path_revision = 0;            ///< grows when it changes
  std::vector<RootNodes::Node> root_nodes{};  ///< of its mission, in order: they only grow until the next
  RobotProgress progress{};
  ProcessorShare processor{};
  MissedShare missed{};
};

/// What it is at. Of a robot whose run has ended at its goal: it has arrived.
Phase phase_of(const SeenRobot& robot);
/// The length of the way that is left at that fleet time, metres; none without a path or a state.
std::optional<double> way_left(const SeenRobot& robot, double time);

/// Whether a fleet is there.
enum class Life : unsigned char {
  nobody,  ///< has been heard of
  alive,   ///< robots are heard
  silent,  ///< they were
  ended,   ///< their run is over, by the service's word
};

struct SeenBroker {
  BrokerStatus status{};
  WallTime heard = 0;  ///< when that came
  ProcessorShare processor{};
};

/// A fleet at one time, in numbers.
struct FleetFigures {
  double time = 0;  ///< of the fleet
  std::size_t robots = 0;
  std::size_t planned = 0;  ///< have a path
  std::size_t arrived = 0;
  std::size_t missions = 0;  ///< fulfilled, by all
  std::size_t trees_published = 0;
  std::size_t trees_grafted = 0;
  std::optional<double> separation{};  ///< least distance of two robots, less both radii; none for one robot
  double state_age_p50 = 0;            ///< median over the robots, seconds
  double state_age_p99 = 0;            ///< of the robot where it is worst
  double processors = -1;              ///< cores that agents and brokers use; below 0: not known
  double missed_share = 0;             ///< of all control periods, of late
};

/// Where a robot is at a fleet time, by what it has bound itself to; after that it stands.
Point2 position_at(const RobotState& state, double time);

class FleetView {
 public:
  void on(const std::shared_ptr<const Message>& message, WallTime at);

  /// Grows when another run begins: nothing that was seen before is true any more.
  std::uint32_t run() const { return run_; }
  const std::optional<MapMessage>& map() const { return map_; }
  /// In the order in which they were first heard of.
  const std::vector<SeenRobot>& robots() const { return robots_; }
  std::optional<std::size_t> find(const RobotName& name) const { return index_.find(name); }
  /// In the order in which they came; all hold an InactiveTreeMessage.
  const std::vector<std::shared_ptr<const Message>>& inactive_trees() const { return trees_; }
  const std::map<std::uint64_t, SeenBroker>& brokers() const { return brokers_; }
  /// What a broker grows just now; null: nothing.
  const std::shared_ptr<const Message>& active_trees() const { return active_trees_; }

  /// Fleet time at that time; none before the first mission.
  std::optional<double> fleet_time(WallTime now) const;
  Life life(WallTime now) const;
  /// When a robot last said anything.
  WallTime heard() const { return heard_; }
  FleetFigures figures(WallTime now) const;

 private:
  void receive(const MapMessage& map, WallTime at);
  void receive(const Mission& mission, WallTime at);
  bool is_under_way(WallTime now) const;
  bool is_of_earlier_run(WallTime run) const;
  void receive(const RootNodes& batch, WallTime at);
  void receive(const RobotState& state, WallTime at);
  void receive(const PathMessage& path, WallTime at);
  void receive(const AgentStatus& status, WallTime at);
  void receive(const BrokerStatus& status, WallTime at);
  SeenRobot* robot(const RobotName& name);
  void begin_anew();

  std::uint32_t run_ = 0;
  WallTime heard_ = 0;
  std::optional<MapMessage> map_;
  std::optional<FleetClock> clock_;
  NameIndex index_;
  std::vector<SeenRobot> robots_;
  std::vector<std::shared_ptr<const Message>> trees_;
  std::set<TreeId> tree_ids_;
  std::shared_ptr<const Message> active_trees_;
  std::map<std::uint64_t, SeenBroker> brokers_;
};

}  // namespace coppice
