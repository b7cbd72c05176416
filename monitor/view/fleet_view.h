// The view of a fleet, from its bus or from a recording: the latest of each message, as values.
//
// A state machine: messages go in with their times of arrival. Page, Foxglove, metrics, terminal and pictures
// all show this view.
//
// Units as in messages/messages.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "messages/messages.h"
#include "messages/name_index.h"
#include "monitor/view/order_counts.h"
#include "monitor/view/robot_progress.h"

namespace coppice {

/// The share of a processor that a process uses, from the totals that it reports.
struct ProcessorShare {
  double of_one_core = -1;  ///< recently; below 0: not known

  void on(double processor_seconds, WallTime at);

 private:
  std::optional<WallTime> since_{};
  double seconds_then_ = 0;
};

/// The share of control periods that a robot misses, from the totals that it reports.
struct MissedShare {
  double of_all = 0;  ///< recently

  void on(std::uint32_t periods, std::uint32_t missed);

 private:
  std::uint32_t periods_then_ = 0;
  std::uint32_t missed_then_ = 0;
};

struct SeenRobot {
  RobotName name;
  WallTime known_since = 0;  ///< its first message, of whatever kind, arrived
  std::optional<Mission> mission{};
  std::optional<RobotState> state{};  ///< the newest that the robot itself has sent
  WallTime heard = 0;                 ///< when `state` arrived
  std::optional<AgentStatus> status{};
  std::uint32_t missions_fulfilled = 0;
  Path path{};                                ///< of its current or its next mission; empty: none
  std::uint32_t path_mission = 0;             ///< the mission of the path
  std::uint32_t path_revision = 0;            ///< grows with each new path
  std::vector<RootNodes::Node> root_nodes{};  ///< of its current mission, in order; cleared with the next one
  RobotProgress progress{};
  ProcessorShare processor{};
  MissedShare missed{};
};

/// The robot's phase. A robot whose run has ended at its goal has arrived.
Phase phase_of(const SeenRobot& robot);
/// The length of the rest of its path at that fleet time, metres; nothing without a path or a state.
std::optional<double> way_left(const SeenRobot& robot, double time);

/// A robot does not come on.
struct Wait {
  double seconds = 0;  ///< how long, fleet time
  std::string cause{};
};
/// The wait of a robot at that fleet time, in the words of its agent. Older recordings give no cause: then by
/// the robot's state. None: the robot does not wait.
std::optional<Wait> wait_of(const SeenRobot& robot, double time);

/// Whether a fleet is alive.
enum class Life : unsigned char {
  nobody,  ///< no robot was ever heard
  alive,   ///< robots are heard
  silent,  ///< robots were heard, and are silent now
  ended,   ///< the service has ended their run
};

struct SeenBroker {
  BrokerStatus status{};
  WallTime heard = 0;  ///< when `status` arrived
  ProcessorShare processor{};
};

/// The planner service that was heard last.
struct SeenService {
  ServiceStatus status{};
  WallTime heard = 0;  ///< when `status` arrived
};

/// A fleet at one moment, in numbers.
struct FleetFigures {
  double time = 0;  ///< fleet time
  std::size_t robots = 0;
  std::size_t planned = 0;  ///< robots with a path
  std::size_t arrived = 0;
  std::size_t missions = 0;  ///< fulfilled by all robots
  std::size_t trees_published = 0;
  std::size_t trees_grafted = 0;
  /// Least distance between two robots, minus both radii; none for one robot.
  std::optional<double> separation{};
  double state_age_p50 = 0;  ///< median over the robots, seconds
  double state_age_p99 = 0;  ///< the largest of all robots, seconds
  double processors = -1;    ///< cores that agents and brokers use; below 0: not known
  double missed_share = 0;   ///< recent share of all control periods
};

/// The robot's position at a fleet time, by its promise. When the promise has expired, the robot stands.
Point2 position_at(const RobotState& state, double time);
/// The same for the yaw of a differential robot, radians.
double yaw_at(const RobotState& state, double time);

/// It belongs to a run that goes on.
bool is_in_service(const SeenRobot& robot);
/// When the robot's last state came, or else when anything was first heard of it: its mission may come before
/// its first state. Statuses do not count: the others avoid it by its states.
WallTime last_heard(const SeenRobot& robot);
/// How long nothing has been heard from the robot.
WallTime unheard_for(const SeenRobot& robot, WallTime now);
/// The robot is in service, and is not heard any more, or was never heard.
bool is_lost(const SeenRobot& robot, WallTime now);
/// Why the robot stands, in one sentence for people, or that it is not heard; empty: it drives, or has
/// arrived. `time`: fleet time. `now`: wall clock.
std::string sentence_of(const SeenRobot& robot, double time, WallTime now);
/// Fleet seconds until the robot arrives, if it drives on at its usual speed; none: it has nowhere to go, or
/// is not heard.
std::optional<double> time_left(const SeenRobot& robot, double time, WallTime now);

class FleetView {
 public:
  void on(const std::shared_ptr<const Message>& message, WallTime at);

  /// Grows when another run begins. Then everything seen before is obsolete.
  std::uint32_t run() const { return run_; }
  const std::optional<MapMessage>& map() const { return map_; }
  /// In the order in which they were first heard.
  const std::vector<SeenRobot>& robots() const { return robots_; }
  std::optional<std::size_t> find(const RobotName& name) const { return index_.find(name); }
  /// In the order of arrival. Each holds an InactiveTreesMessage.
  const std::vector<std::shared_ptr<const Message>>& inactive_trees() const { return trees_; }
  const std::map<std::uint64_t, SeenBroker>& brokers() const { return brokers_; }
  const OrderCounts& orders() const { return orders_; }
  const std::optional<SeenService>& service() const { return service_; }
  /// The trees that a broker is growing; null: none.
  const std::shared_ptr<const Message>& active_trees() const { return active_trees_; }

  /// The fleet time at a wall time; nothing before the first mission.
  std::optional<double> fleet_time(WallTime now) const;
  Life life(WallTime now) const;
  /// When any robot was last heard.
  WallTime heard() const { return heard_; }
  FleetFigures figures(WallTime now) const;

 private:
  void receive(const MapMessage& map, WallTime at);
  void receive(const Mission& mission, WallTime at);
  bool is_under_way(WallTime now) const;
  void follow_clock(const RobotState& state, WallTime at);
  template <class M>
  bool is_stale(const M& message) const {
    return clock_ && is_of_earlier_run(message, clock_->run());
  }
  void receive(const RootNodes& batch, WallTime at);
  void receive(const RobotState& state, WallTime at);
  void receive(const PathMessage& path, WallTime at);
  void receive(const AgentStatus& status, WallTime at);
  void receive(const BrokerStatus& status, WallTime at);
  void receive(const OrderStatus& status, WallTime) { orders_.on(status); }
  void receive(const ServiceStatus& status, WallTime at) { service_ = {status, at}; }
  SeenRobot* robot(const RobotName& name, WallTime at);
  void begin_anew();

  std::uint32_t run_ = 0;
  WallTime heard_ = 0;
  std::optional<MapMessage> map_;
  std::optional<FleetClock> clock_;
  double ahead_ = 0;  ///< fleet seconds by which the clock of the fleet is ahead of this process's
  NameIndex index_;
  std::vector<SeenRobot> robots_;
  OrderCounts orders_;
  std::vector<std::shared_ptr<const Message>> trees_;
  std::set<TreesId> tree_ids_;
  std::shared_ptr<const Message> active_trees_;
  std::map<std::uint64_t, SeenBroker> brokers_;
  std::optional<SeenService> service_;
};

}  // namespace coppice
