// The messages between the processes as plain structs: one for each topic of topics.h.
//
// Units: metres in the map frame, seconds, metres per second. Times named `stamp`, `expiry` or `..._time` are
// fleet time (fleet_clock.h). validation.h checks each message that comes off a bus. A field `run` names the
// run of the mission by the epoch of its clock.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "coppice/motion/coordination.h"
#include "coppice/motion/kinematics.h"
#include "coppice/motion/trajectory.h"
#include "coppice/planning/geometry.h"
#include "coppice/planning/occupancy_map.h"
#include "coppice/planning/planner_kind.h"
#include "coppice/planning/tree_parameters.h"
#include "messages/fleet_clock.h"
#include "messages/orders.h"
#include "motion/body/promise.h"
#include "planning/trees/root.h"

namespace coppice {

using RobotName = std::string;

/// The name of disjointed trees that were published together: the broker that froze them, and their number
/// there.
struct TreesId {
  std::uint64_t broker = 0;
  std::uint32_t number = 0;
  auto operator<=>(const TreesId&) const = default;
};

/// map: service -> all.
struct MapMessage {
  std::string map_id;
  OccupancyMap map;
  /// The radii of the robots that are to drive on it, each once, if brokers are to grow trees before missions
  /// come.
  std::vector<double> radii{};
  TreeParameters trees{};
  double margin = 0;  ///< metres that robots keep from obstacles beyond their radius
  bool operator==(const MapMessage&) const = default;
};

/// mission: service -> agents, broker. One for each robot; a newer one for the same robot replaces the older.
struct Mission {
  RobotName robot;
  std::uint32_t number = 0;      ///< grows with each mission of the run; statuses name it
  std::uint32_t fleet_size = 1;  ///< robots in this run: none sets off before it has heard of all of them
  std::string map_id;
  Point2 start = Point2::Zero();
  Point2 goal = Point2::Zero();
  double radius = 0;
  double max_speed = 0;
  double max_acceleration = 0;
  double goal_tolerance = 0;
  std::uint64_t seed = 0;
  PlannerKind planner = PlannerKind::ma_rrdt_star;
  TreeParameters trees{};
  double plan_budget = 1;  ///< wall seconds to look for a shorter path after the first one
  bool cancelled = false;  ///< the run has ended: stop planning, brake and stand
  FleetClock clock;        ///< its epoch names the run: agents outlive it, and so does what they said in it
  double max_angular_speed = 0;         ///< of a differential robot; 0: holonomic
  double max_angular_acceleration = 0;  ///< of a differential robot
  double start_yaw = 0;                 ///< of a differential robot: its heading where it starts, radians
  double goal_yaw = 0;                  ///< where it is to head in the end
  double goal_yaw_tolerance = 0;        ///< radians by which it may be off; 0: it may head anywhere
  double tracking_tolerance = 0;  ///< part of the radius: what a robot that follows may be off its reference
  std::vector<Point2> footprint{};  ///< corners in the robot's own frame, within its radius; empty: a disc
  Coordination coordination = Coordination::reservations;  ///< the same in all missions of a run
  /// The robot begins the run where its agent knows it to stand; at `start` if the agent does not know. A
  /// goal that is the start goes along.
  bool starts_where_it_stands = false;
  bool operator==(const Mission&) const = default;
};

/// The radius of the robot itself, metres.
inline double own_radius(const Mission& mission) {
  return mission.radius - mission.tracking_tolerance;
}
inline Limits limits_of(const Mission& mission) {
  return {mission.max_speed, mission.max_acceleration, mission.max_angular_speed,
          mission.max_angular_acceleration};
}
/// The radius with which the robot is planned, metres.
inline double driving_radius(const Mission& mission) {
  return driving_radius(mission.radius, limits_of(mission));
}

/// root_nodes: agent -> broker. Nodes that joined a root tree since the last batch.
struct RootNodes {
  RobotName robot;
  std::uint32_t mission = 0;
  struct Node {
    Root side = Root::start;
    Point2 position = Point2::Zero();
    std::int32_t parent =
        -1;  ///< index among the root nodes that this agent sent for this mission; -1: a root
    bool operator==(const Node&) const = default;
  };
  std::uint32_t first_index = 0;  ///< of nodes[0] among all that this agent sent for this mission
  std::vector<Node> nodes;
  RunId run;
  bool operator==(const RootNodes&) const = default;
};

/// inactive_trees: broker -> agents, brokers. Trees that became inactive at about the same time. They never
/// change.
struct InactiveTreesMessage {
  TreesId id;
  std::string map_id;
  double radius = 0;  ///< every node and edge keeps at least this clearance
  struct Node {
    Point2 position = Point2::Zero();
    /// Index in nodes, below the node's own and at or above that of its tree's root; -1: the root of a tree.
    /// The nodes of a tree follow each other.
    std::int32_t parent = -1;
    double edge_clearance = 0;  ///< of the edge to the parent; of the node itself for a root
    bool operator==(const Node&) const = default;
  };
  std::vector<Node> nodes;
  /// Two trees see each other between two of their nodes. A broker tells all such links of its trees: no
  /// process needs to look for more between trees.
  struct Link {
    std::uint32_t node = 0;  ///< index in nodes
    TreesId other{};         ///< the message with the other tree, perhaps this one
    std::uint32_t other_node = 0;
    auto operator<=>(const Link&) const = default;
  };
  std::vector<Link> links{};
  bool operator==(const InactiveTreesMessage&) const = default;
};

/// active_trees: broker -> monitor, recorder. The trees that the leading broker grows now, several times a
/// second.
struct ActiveTreesMessage {
  std::uint64_t broker = 0;
  std::string map_id;
  struct Edge {
    Point2 from = Point2::Zero();
    Point2 to = Point2::Zero();  ///< a tree of one node has one edge, from it to itself
    bool operator==(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  bool operator==(const ActiveTreesMessage&) const = default;
};

enum class Phase : std::uint8_t {
  waiting,   ///< no map or no mission yet
  planning,  ///< has a mission, looks for a path
  driving,   ///< follows its path
  arrived,   ///< stands within the tolerance of its goal
  no_path,   ///< it is proved that no path exists; stands at its start
  stopped,   ///< the run has ended: stands
  gave_up,   ///< stands, and tries again when something has changed
  halted,    ///< an operator paused or stopped it: brakes and stands until it may go on
};

/// The robot stands where it is and wants to go nowhere, though it has not arrived.
constexpr bool has_no_way(Phase phase) {
  return phase == Phase::no_path || phase == Phase::gave_up || phase == Phase::halted;
}

/// Whether an epoch of a round is later than the other one. Epochs wrap around (RFC 1982, serial numbers):
/// each has a later one, also an epoch that a faulty peer made up. 0 comes before all.
constexpr bool is_later_epoch(std::uint32_t epoch, std::uint32_t other) {
  if (epoch == 0 || other == 0) return epoch > other;
  return epoch != other && epoch - other <= ~std::uint32_t{0} / 2;
}
constexpr std::uint32_t epoch_after(std::uint32_t epoch) {
  return epoch + 1 == 0 ? 1 : epoch + 1;
}

/// The name of a coordination round of the robots within reach of a centre. A later epoch overrides an
/// earlier one. Within an epoch the leader with the lower name wins.
struct RoundId {
  std::uint32_t epoch = 0;  ///< 0: none yet
  RobotName leader{};
  Point2 centre = Point2::Zero();
  double reach = 0;  ///< metres

  bool includes(const Point2& p) const { return (p - centre).norm() <= reach; }
  bool overrides(const RoundId& other) const {
    return epoch != other.epoch ? is_later_epoch(epoch, other.epoch) : leader < other.leader;
  }
  bool operator==(const RoundId&) const = default;
};

/// The stage of a robot in its round.
enum class Stage : std::uint8_t {
  free,       ///< takes part in none, or has made all its moves: drives by itself
  waiting,    ///< stands, or brakes, until there is a joint plan
  executing,  ///< drives as the joint plan says
};

/// Reports when a state of another robot arrived. That robot compares clocks by it (clock_offset.h).
struct Echo {
  RobotName robot;
  double stamp = 0;     ///< of its state
  double received = 0;  ///< by the clock of the robot that reports it
  bool operator==(const Echo&) const = default;
};

/// A reservation of a robot.
struct ReservationId {
  RobotName robot;
  std::uint32_t number = 0;  ///< above 0
  bool operator==(const ReservationId&) const = default;
};

/// robot_state: agent -> agents, monitor. Close agents receive one for each control period, distant agents at
/// their send interval. A robot that stands sends heartbeats only.
struct RobotState {
  RobotName robot;
  std::uint32_t sequence = 0;
  Promise promise;  ///< its stamp is that of the state
  double radius = 0;
  double max_speed = 0;
  double max_acceleration = 0;
  Phase phase = Phase::waiting;
  RoundId round;
  Stage stage = Stage::free;
  std::uint32_t reservation = 0;    ///< the number of the one that it carries out or has carried out; 0: none
  double reservation_progress = 0;  ///< metres along its trajectory
  RobotName waits_for;              ///< empty: the robot waits for no other robot
  /// This state and those after it are each sent at least so often, until a state gives another number.
  std::uint8_t copies = 1;
  std::uint8_t copy = 0;          ///< the number of this copy
  bool passed_on = false;         ///< another robot relays it, which no longer hears this robot
  bool counts_as_failed = false;  ///< the relaying robot counts this robot as failed
  /// The agent was started in mid-run, or was out of touch of late: it may not know where all others are.
  bool is_new = false;
  bool wants_echo = false;  ///< no peer has echoed its states of late
  /// Some peer may not have heard the robot since it was started or was out of touch. Its echoes prove no
  /// contact.
  bool may_be_unknown = false;
  std::vector<RobotName>
      misses{};                ///< peers that are silent here, in turn; a robot that hears them echoes them
  std::vector<Echo> echoes{};  ///< of states of other robots, in turn
  std::vector<ReservationId> knows{};  ///< reservations of other robots, in turn; it heeds them
  RunId run;
  double max_angular_speed = 0;         ///< of a differential robot; 0: holonomic
  double max_angular_acceleration = 0;  ///< of a differential robot
  bool operator==(const RobotState&) const = default;
};

/// A reservation of another robot that trajectories were planned around.
struct ReservationBasis {
  RobotName robot;
  std::uint32_t number = 0;
  double offset = 0;  ///< seconds; to be added to the other robot's times
  bool operator==(const ReservationBasis&) const = default;
};

/// The leader of the round of a joint plan that was made elsewhere: the planner service hands it out with the
/// missions. No robot can have this name (planning/robot_name.h).
inline constexpr const char* service_as_leader = "planner service";

/// joint_plan: agent, service -> agents, monitor. The joint plan that the leader of a round made
/// (motion/joint/joint_schedule.h).
struct JointPlanMessage {
  RoundId round;
  struct Member {
    RobotName robot;
    double radius = 0;
    bool stranded = false;    ///< the plan does not bring it to its goal
    Trajectory trajectory{};  ///< by the leader's clock; empty: it does not move
    bool operator==(const Member&) const = default;
  };
  std::vector<Member> members;
  std::vector<ReservationBasis> basis{};  ///< reservations of robots that are no members; by the same clock
  RunId run;                              ///< of the leader's mission
  bool operator==(const JointPlanMessage&) const = default;
};

/// Which of the robots that want a reservation plans first (docs/coordination.md).
enum class Priority : std::uint8_t {
  urgent,   ///< it found no trajectory around the others: these give way to it
  winding,  ///< its way is much longer than the straight line; the longest way is first
  usual,    ///< the shortest way is first
  last,     ///< where it stands in the end, it closes a passage; the longest way is first
};

/// reservation: agent -> agents, monitor. The trajectory that a robot has reserved in space and time
/// (docs/coordination.md). A later number replaces an earlier one.
struct ReservationMessage {
  RobotName robot;
  std::uint32_t number = 0;        ///< above 0
  std::uint32_t first_number = 0;  ///< of this trajectory: it may have been renewed under later numbers
  double radius = 0;
  double way = 0;                         ///< metres to its goal; 0: it wants no reservation
  Trajectory trajectory{};                ///< by its clock; empty: it has none
  std::vector<ReservationBasis> basis{};  ///< those that it comes near
  /// The joint plan that it is a part of. It was planned around all other parts.
  struct Plan {
    RobotName leader{};  ///< empty: of none
    std::uint32_t epoch = 0;
    double shift = 0;  ///< seconds that were added to the times of the plan
    bool operator==(const Plan&) const = default;
  };
  Plan plan{};
  Priority priority = Priority::usual;
  RunId run;
  bool operator==(const ReservationMessage&) const = default;
};

/// path: agent -> service, monitor.
struct PathMessage {
  RobotName robot;
  std::uint32_t mission = 0;
  Path waypoints;  ///< from start to goal; empty: none
  RunId run;
  bool operator==(const PathMessage&) const = default;
};

/// track: agent -> service, recorder. Every control step, in batches, so that a report can be checked.
struct TrackMessage {
  RobotName robot;
  std::uint32_t mission = 0;
  struct Point {
    double time = 0;
    Point2 position = Point2::Zero();
    Point2 velocity = Point2::Zero();
    double yaw = 0;               ///< radians; of a differential robot, like the next one
    double angular_velocity = 0;  ///< radians a second
    bool operator==(const Point&) const = default;
  };
  std::uint32_t first_index = 0;  ///< of points[0] among all of this run: gaps show
  std::vector<Point> points;
  RunId run;
  bool operator==(const TrackMessage&) const = default;
};

/// The load of an agent's process, counted since it began.
struct AgentLoad {
  std::uint32_t samples_received = 0;  ///< of all topics
  std::uint32_t states_received = 0;   ///< of these: states of other robots, copies included
  std::uint32_t periods = 0;           ///< of control
  std::uint32_t periods_missed = 0;    ///< of these: over before the process decided for them
  std::uint32_t agents_matched = 0;    ///< peers that receive its states
  WallTime matched_at = 0;             ///< when the last of these was matched
  std::uint64_t bytes_sent = 0;        ///< in UDP datagrams, without their headers
  std::uint64_t bytes_received = 0;
  /// Age of a state, when this robot uses it, of a robot that it might touch soon. Seconds of fleet time.
  double state_age_p50 = 0;
  double state_age_p99 = 0;  ///< to within a tenth
  double state_age_max = 0;
  double processor_seconds = 0;  ///< of all its threads; 0 in a simulation
  bool operator==(const AgentLoad&) const = default;
};

/// Fleet seconds that a robot waited, by what it waited for. A robot waits while it has a goal to reach and
/// is slower than a tenth of its maximum speed.
struct WaitTimes {
  double startup = 0;      ///< for the missions of all robots, and to hear where all are
  double planning = 0;     ///< for its first path
  double reservation = 0;  ///< for its turn to reserve, or for room in space and time
  double joint_plan = 0;   ///< for a joint plan, or for others to finish theirs
  double gate = 0;         ///< for a robot that goes first by the reservations or the joint plan
  double promise = 0;      ///< because other robots may come where it wants to go
  double connection = 0;   ///< because it is cut off, or was, or its agent was restarted
  double odometry = 0;     ///< for odometry, or for its robot to come to where it should be
  bool operator==(const WaitTimes&) const = default;
};

inline constexpr std::array wait_kinds{&WaitTimes::startup,    &WaitTimes::planning, &WaitTimes::reservation,
                                       &WaitTimes::joint_plan, &WaitTimes::gate,     &WaitTimes::promise,
                                       &WaitTimes::connection, &WaitTimes::odometry};
/// Of its maximum speed: a robot that has a goal to reach and is slower waits.
inline constexpr double waiting_speed_share = 0.1;

inline double sum_of(const WaitTimes& waits) {
  double sum = 0;
  for (const auto kind : wait_kinds) sum += waits.*kind;
  return sum;
}

/// agent_status: agent -> service, monitor. On every change, and twice a second.
struct AgentStatus {
  RobotName robot;
  std::uint32_t mission = 0;
  Phase phase = Phase::waiting;
  std::string reason;          ///< why the robot does not arrive
  double mission_time = 0;     ///< when the mission and its map were there
  double path_time = 0;        ///< when the path was found (or given up); 0: not yet
  double arrival_time = 0;     ///< 0: not yet
  double plan_seconds = 0;     ///< wall-clock seconds between mission and first path
  double improve_seconds = 0;  ///< from then to the path that it drives; 0: the first
  double driven_length = 0;
  std::uint32_t nodes_valid = 0;
  std::uint32_t nodes_invalid = 0;
  std::uint32_t trees_received = 0;
  std::uint32_t trees_grafted = 0;
  std::uint32_t track_points = 0;  ///< how many the agent has sent in all
  std::uint32_t rejected = 0;      ///< messages dropped as invalid
  AgentLoad load{};
  RunId run;                 ///< 0: no mission yet
  double way_left = -1;      ///< metres along its way to its goal; below 0: it has none
  std::string wait_cause{};  ///< why it does not come on, though it has a goal to reach; empty: it does
  double came_on_at = 0;     ///< fleet time at which it last came on, or its mission came
  WaitTimes waits{};         ///< in this mission
  bool operator==(const AgentStatus&) const = default;
};

/// The later status holds no news except how far the robot has come.
inline bool same_progress(const AgentStatus& earlier, const AgentStatus& later) {
  return earlier.run == later.run && earlier.mission == later.mission && earlier.phase == later.phase &&
         earlier.reason == later.reason && earlier.path_time == later.path_time &&
         earlier.arrival_time == later.arrival_time && earlier.improve_seconds == later.improve_seconds;
}

/// broker_status: broker -> brokers, service, monitor.
struct BrokerStatus {
  std::uint64_t broker = 0;
  bool leads = true;           ///< grows and publishes trees; otherwise it stands by
  WallTime leading_since = 0;  ///< if it leads
  std::uint32_t nodes_valid = 0;
  std::uint32_t nodes_invalid = 0;
  std::uint32_t trees_active = 0;
  std::uint32_t trees_published = 0;  ///< inactive trees that it knows; a leader has published all of them
  std::string covered_map{};  ///< id of the map that its trees cover by now, for all radii; empty: not yet
  std::uint32_t rejected = 0;
  double processor_seconds = 0;  ///< of all its threads, since the process began
  bool operator==(const BrokerStatus&) const = default;
};

/// service_status: service -> services, monitor. A fleet has one service. A second service hears of the first
/// and refuses to start.
struct ServiceStatus {
  std::uint64_t service = 0;  ///< drawn at random at each start, above 0
  std::string host{};
  std::uint32_t process = 0;  ///< its id there
  WallTime since = 0;         ///< it was started
  RunId run;                  ///< the run whose missions it handed out; 0: none yet
  std::string problem{};      ///< why it refuses new orders; empty: it takes them
  bool operator==(const ServiceStatus&) const = default;
};

/// claim: agent without a name -> service. Repeated until the agent has a robot. The last claim names it.
struct Claim {
  std::uint64_t claimant = 0;  ///< drawn at random at each start, above 0
  std::uint32_t number = 0;    ///< grows with each claim of this claimant
  RobotName robot{};           ///< the robot that the agent has; empty: none yet
  bool operator==(const Claim&) const = default;
};

/// assignment: service -> agents that were started without a name. The newest assignment of a robot counts.
struct Assignment {
  RobotName robot;
  std::uint64_t claimant = 0;
  std::uint32_t number = 0;  ///< of the claim that it answers
  bool operator==(const Assignment&) const = default;
};

/// Seconds. An agent that the service has not heard for so long loses its robot. The agent counts this time
/// itself.
inline constexpr WallTime claim_lease = 10;

using Message =
    std::variant<MapMessage, Mission, RootNodes, InactiveTreesMessage, RobotState, JointPlanMessage,
                 ReservationMessage, PathMessage, TrackMessage, AgentStatus, BrokerStatus, Claim, Assignment,
                 ActiveTreesMessage, ServiceStatus, OrderMessage, OrderStatus, HaltMessage>;

}  // namespace coppice
