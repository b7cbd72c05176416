// The fields of all messages, once. Each format of a message walks this list: DDS (dds/conversion.cpp) and
// recordings (monitor/recording/recorded_messages.cpp). So a new field is written in three places: in
// messages.h, in idl/fleet.idl, and here.
//
// Recordings name a field by its number: a number is never given to another field.
#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "messages/messages.h"
#include "messages/wire_forms.h"

namespace coppice {

/// `member` and `in_dds` map a struct, and the type that fastddsgen generates for it, to the field in it.
template <class Member, class InDds>
struct Field {
  int number;
  const char* name;
  Member member;
  InDds in_dds;
  bool may_be_absent = false;  ///< from older recordings; it then keeps the value of messages.h
};

template <class Member, class InDds>  // clang 14 deduces nothing for aggregates
Field(int, const char*, Member, InDds, bool = false)->Field<Member, InDds>;

/// Specialised for each struct with fields: its `name` in recordings, and its `list` of fields.
template <class T>
struct Fields;

/// Specialised for each enumeration: its `name` and its `values` in recordings, in order from 0.
template <class E>
struct Enumerators;

// clang-format off
#define COPPICE_FIELDS(TYPE, NAME, ...)                   \
  template <>                                             \
  struct Fields<TYPE> {                                   \
    static constexpr std::string_view name = NAME;        \
    static constexpr auto list = std::tuple{__VA_ARGS__}; \
  }
#define COPPICE_ENUMERATORS(TYPE, NAME, ...)              \
  template <>                                             \
  struct Enumerators<TYPE> {                              \
    static constexpr std::string_view name = NAME;        \
    static constexpr std::array values{__VA_ARGS__};      \
  }
/// A field called NAME in recordings. It is MEMBER of the struct, and IN_DDS of the DDS type.
#define COPPICE_FIELD_AT(NUMBER, NAME, MEMBER, IN_DDS)    \
  Field{NUMBER, #NAME,                                    \
        [](auto& m) -> auto& { return m.MEMBER; },        \
        [](auto& dds) -> decltype(auto) { return dds.IN_DDS; }}
#define COPPICE_FIELD(NUMBER, NAME) COPPICE_FIELD_AT(NUMBER, NAME, NAME, NAME())
/// A field that older recordings lack.
#define COPPICE_NEW_FIELD_AT(NUMBER, NAME, IN_MESSAGE, IN_DDS) \
  Field{NUMBER, #NAME,                                    \
        [](auto& m) -> auto& { return m.IN_MESSAGE; },    \
        [](auto& dds) -> decltype(auto) { return dds.IN_DDS; }, true}
#define COPPICE_NEW_FIELD(NUMBER, NAME) COPPICE_NEW_FIELD_AT(NUMBER, NAME, NAME, NAME())
/// A part whose fields are fields of the message itself in DDS.
#define COPPICE_PART(NUMBER, NAME)                        \
  Field{NUMBER, #NAME,                                    \
        [](auto& m) -> auto& { return m.NAME; },          \
        [](auto& dds) -> auto& { return dds; }}
// clang-format on

/// The round in the DDS type of a state, where its fields have a prefix.
template <class State>
struct RoundOfState {
  State& dds;
  decltype(auto) epoch() const { return dds.round_epoch(); }
  decltype(auto) leader() const { return dds.round_leader(); }
  decltype(auto) centre() const { return dds.round_centre(); }
  decltype(auto) reach() const { return dds.round_reach(); }
};
template <class State>
RoundOfState(State&) -> RoundOfState<State>;

// clang-format off
COPPICE_ENUMERATORS(PlannerKind, "Planner", "MA_RRDT_STAR", "RRDT_STAR", "RRT_STAR");
COPPICE_ENUMERATORS(Coordination, "Coordination", "RESERVATIONS", "RVO", "RVO_WITHOUT_ROUNDS");
COPPICE_ENUMERATORS(Restarts, "Restarts", "EVEN", "RANDOM");
COPPICE_ENUMERATORS(Root, "Side", "START", "GOAL");
COPPICE_ENUMERATORS(Phase, "Phase", "WAITING", "PLANNING", "DRIVING", "ARRIVED", "NO_PATH", "STOPPED", "GAVE_UP", "HALTED");
COPPICE_ENUMERATORS(Stage, "Stage", "FREE", "WAITING_FOR_PLAN", "EXECUTING");
COPPICE_ENUMERATORS(Priority, "Priority", "URGENT", "WINDING", "USUAL", "LAST");

COPPICE_ENUMERATORS(Action, "Action", "GO", "CANCEL", "PAUSE", "RESUME", "STOP", "RELEASE");
COPPICE_ENUMERATORS(OrderState, "OrderState", "ACCEPTED", "ASSIGNED", "UNDER_WAY", "DONE", "CANCELLED", "FAILED");
COPPICE_ENUMERATORS(Halt, "HaltKind", "NOT_HALTED", "HALT_PAUSED", "HALT_STOPPED",
                    "HALT_PAUSED_AND_STOPPED");

COPPICE_FIELDS(Point2, "Point", COPPICE_FIELD_AT(1, x, x(), x()), COPPICE_FIELD_AT(2, y, y(), y()));

COPPICE_FIELDS(TreeParameters, "TreeParameters",
  COPPICE_FIELD(1, epsilon),
  COPPICE_FIELD(2, disjointed_trees),
  COPPICE_FIELD(3, kappa),
  COPPICE_FIELD(4, failure_factor),
  COPPICE_FIELD(5, restart_weight),
  COPPICE_FIELD(6, spacing),
  COPPICE_FIELD(7, restarts));

COPPICE_FIELDS(PackedMap, "Map",
  COPPICE_FIELD(1, map_id),
  COPPICE_FIELD(2, width),
  COPPICE_FIELD(3, height),
  COPPICE_FIELD(4, resolution),
  COPPICE_FIELD(5, origin),
  COPPICE_FIELD_AT(6, y_up, y_axis, y_axis()),
  COPPICE_FIELD_AT(7, occupancy, occupancy, packed_occupancy()),
  COPPICE_FIELD(8, radii),
  COPPICE_NEW_FIELD(9, trees),
  COPPICE_NEW_FIELD(10, margin));

COPPICE_FIELDS(Mission, "Mission",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, number),
  COPPICE_FIELD(3, fleet_size),
  COPPICE_FIELD(4, map_id),
  COPPICE_FIELD(5, start),
  COPPICE_FIELD(6, goal),
  COPPICE_FIELD(7, radius),
  COPPICE_FIELD(8, max_speed),
  COPPICE_FIELD(9, max_acceleration),
  COPPICE_FIELD(10, goal_tolerance),
  COPPICE_FIELD(11, seed),
  COPPICE_FIELD(12, planner),
  COPPICE_FIELD(13, plan_budget),
  COPPICE_FIELD(14, cancelled),
  COPPICE_FIELD_AT(15, clock_epoch, clock.epoch, clock_epoch()),
  COPPICE_FIELD_AT(16, clock_scale, clock.scale, clock_scale()),
  COPPICE_NEW_FIELD(17, trees),
  COPPICE_NEW_FIELD(18, max_angular_speed),
  COPPICE_NEW_FIELD(19, max_angular_acceleration),
  COPPICE_NEW_FIELD(20, start_yaw),
  COPPICE_NEW_FIELD(21, goal_yaw),
  COPPICE_NEW_FIELD(22, goal_yaw_tolerance),
  COPPICE_NEW_FIELD(23, tracking_tolerance),
  COPPICE_FIELD(24, footprint),
  COPPICE_NEW_FIELD(25, coordination),
  COPPICE_NEW_FIELD(26, starts_where_it_stands));

COPPICE_FIELDS(RootNodes::Node, "RootNode",
  COPPICE_FIELD(1, side),
  COPPICE_FIELD(2, position),
  COPPICE_FIELD(3, parent));
COPPICE_FIELDS(RootNodes, "RootNodes",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, mission),
  COPPICE_FIELD(3, first_index),
  COPPICE_FIELD(4, nodes),
  COPPICE_FIELD_AT(5, run, run.epoch, run()));

COPPICE_FIELDS(InactiveTreesMessage::Node, "TreeNode",
  COPPICE_FIELD(1, position),
  COPPICE_FIELD(2, parent),
  COPPICE_FIELD(3, edge_clearance));
COPPICE_FIELDS(InactiveTreesMessage::Link, "TreeLink",
  COPPICE_FIELD(1, node),
  COPPICE_FIELD_AT(2, other_broker, other.broker, other_broker()),
  COPPICE_FIELD_AT(3, other_number, other.number, other_number()),
  COPPICE_FIELD(4, other_node));
COPPICE_FIELDS(InactiveTreesMessage, "InactiveTree",
  COPPICE_FIELD_AT(1, broker, id.broker, broker()),
  COPPICE_FIELD_AT(2, number, id.number, number()),
  COPPICE_FIELD(3, map_id),
  COPPICE_FIELD(4, radius),
  COPPICE_FIELD(5, nodes),
  COPPICE_FIELD(6, links));

COPPICE_FIELDS(ActiveTreesMessage::Edge, "TreeEdge",
  COPPICE_FIELD(1, from),
  COPPICE_FIELD(2, to));
COPPICE_FIELDS(ActiveTreesMessage, "ActiveTrees",
  COPPICE_FIELD(1, broker),
  COPPICE_FIELD(2, map_id),
  COPPICE_FIELD(3, edges));

COPPICE_FIELDS(RoundId, "CoordinationRound",
  COPPICE_FIELD(1, epoch),
  COPPICE_FIELD(2, leader),
  COPPICE_FIELD(3, centre),
  COPPICE_FIELD(4, reach));
COPPICE_FIELDS(Echo, "Echo",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, stamp),
  COPPICE_FIELD(3, received));
COPPICE_FIELDS(ReservationId, "ReservationId",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, number));
COPPICE_FIELDS(RobotState, "RobotState",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD_AT(2, sequence, sequence, sequence_number()),
  COPPICE_FIELD_AT(3, stamp, promise.stamp, stamp()),
  COPPICE_FIELD_AT(4, position, promise.position, position()),
  COPPICE_FIELD_AT(5, velocity, promise.velocity, velocity()),
  COPPICE_FIELD(6, radius),
  COPPICE_FIELD(7, max_speed),
  COPPICE_FIELD(8, max_acceleration),
  COPPICE_FIELD(9, phase),
  COPPICE_FIELD_AT(10, promise_decision_time, promise.decision_time, promise_decision_time()),
  COPPICE_FIELD_AT(11, promise_velocity, promise.next_velocity, promise_velocity()),
  COPPICE_FIELD_AT(12, promise_expiry, promise.expiry, promise_expiry()),
  (Field{13, "round", [](auto& m) -> auto& { return m.round; }, [](auto& dds) { return RoundOfState{dds}; }}),
  COPPICE_FIELD(14, stage),
  COPPICE_FIELD(16, waits_for),  // 15 was the progress in a joint plan
  COPPICE_FIELD(17, copies),
  COPPICE_FIELD(18, copy),
  COPPICE_FIELD(19, passed_on),
  COPPICE_FIELD(20, counts_as_failed),
  COPPICE_FIELD(21, is_new),
  COPPICE_FIELD(22, wants_echo),
  COPPICE_FIELD(23, echoes),
  COPPICE_FIELD_AT(24, run, run.epoch, run()),
  COPPICE_FIELD(25, misses),
  COPPICE_NEW_FIELD(26, reservation),
  COPPICE_NEW_FIELD(27, reservation_progress),
  COPPICE_FIELD(28, knows),
  COPPICE_NEW_FIELD(29, max_angular_speed),
  COPPICE_NEW_FIELD(30, max_angular_acceleration),
  COPPICE_NEW_FIELD_AT(31, yaw, promise.yaw, yaw()),
  COPPICE_NEW_FIELD_AT(32, angular_velocity, promise.angular_velocity, angular_velocity()),
  COPPICE_NEW_FIELD_AT(33, promise_angular_velocity, promise.next_angular_velocity, promise_angular_velocity()),
  COPPICE_NEW_FIELD(34, may_be_unknown));

COPPICE_FIELDS(TimedPoint, "TimedPoint",
  COPPICE_FIELD(1, time),
  COPPICE_FIELD(2, position));
COPPICE_FIELDS(ReservationBasis, "Basis",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, number),
  COPPICE_FIELD(3, offset));

COPPICE_FIELDS(SentPlan::Member, "Member",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, radius),
  COPPICE_FIELD(3, stranded),
  Field{4, "points", [](auto& m) -> auto& { return m.points; }, [](auto& dds) -> decltype(auto) { return dds.points(); }, true});
COPPICE_FIELDS(SentPlan, "JointPlan",
  COPPICE_PART(1, round),
  COPPICE_FIELD(2, members),
  COPPICE_FIELD_AT(4, run, run.epoch, run()),
  COPPICE_FIELD(5, basis),
  COPPICE_FIELD(6, points));  // 3 were moves

COPPICE_FIELDS(ReservationMessage, "Reservation",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, number),
  COPPICE_FIELD(3, radius),
  COPPICE_FIELD(4, way),
  COPPICE_FIELD(5, trajectory),
  COPPICE_FIELD(6, basis),
  COPPICE_FIELD_AT(7, run, run.epoch, run()),
  COPPICE_FIELD_AT(8, plan_leader, plan.leader, plan_leader()),
  COPPICE_FIELD_AT(9, plan_epoch, plan.epoch, plan_epoch()),
  COPPICE_FIELD_AT(10, plan_shift, plan.shift, plan_shift()),
  COPPICE_FIELD(11, priority),
  COPPICE_FIELD(12, first_number));

COPPICE_FIELDS(PathMessage, "Path",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, mission),
  COPPICE_FIELD(3, waypoints),
  COPPICE_FIELD_AT(4, run, run.epoch, run()));

COPPICE_FIELDS(TrackMessage::Point, "Sample",
  COPPICE_FIELD(1, time),
  COPPICE_FIELD(2, position),
  COPPICE_FIELD(3, velocity),
  COPPICE_NEW_FIELD(4, yaw),
  COPPICE_NEW_FIELD(5, angular_velocity));
COPPICE_FIELDS(TrackMessage, "Track",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, mission),
  COPPICE_FIELD(3, first_index),
  COPPICE_FIELD(4, points),
  COPPICE_FIELD_AT(5, run, run.epoch, run()));

COPPICE_FIELDS(AgentLoad, "Load",
  COPPICE_FIELD(1, samples_received),
  COPPICE_FIELD(2, states_received),
  COPPICE_FIELD(3, periods),
  COPPICE_FIELD(4, periods_missed),
  COPPICE_FIELD(5, agents_matched),
  COPPICE_FIELD(6, matched_at),
  COPPICE_FIELD(7, bytes_sent),
  COPPICE_FIELD(8, bytes_received),
  COPPICE_FIELD(9, state_age_p50),
  COPPICE_FIELD(10, state_age_p99),
  COPPICE_FIELD(11, state_age_max),
  COPPICE_FIELD(12, processor_seconds));
COPPICE_FIELDS(WaitTimes, "WaitTimes",
  COPPICE_FIELD_AT(1, startup, startup, waited_startup()),
  COPPICE_FIELD_AT(2, planning, planning, waited_planning()),
  COPPICE_FIELD_AT(3, joint_plan, joint_plan, waited_joint_plan()),
  COPPICE_FIELD_AT(4, gate, gate, waited_gate()),
  COPPICE_FIELD_AT(5, promise, promise, waited_promise()),
  COPPICE_FIELD_AT(6, connection, connection, waited_connection()),
  COPPICE_FIELD_AT(7, odometry, odometry, waited_odometry()),
  COPPICE_FIELD_AT(8, reservation, reservation, waited_reservation()));
COPPICE_FIELDS(AgentStatus, "AgentStatus",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, mission),
  COPPICE_FIELD(3, phase),
  COPPICE_FIELD(4, reason),
  COPPICE_FIELD(5, mission_time),
  COPPICE_FIELD(6, path_time),
  COPPICE_FIELD(7, arrival_time),
  COPPICE_FIELD(8, plan_seconds),
  COPPICE_FIELD(9, improve_seconds),
  COPPICE_FIELD(10, driven_length),
  COPPICE_FIELD(11, nodes_valid),
  COPPICE_FIELD(12, nodes_invalid),
  COPPICE_FIELD(13, trees_received),
  COPPICE_FIELD(14, trees_grafted),
  COPPICE_FIELD(15, track_points),
  COPPICE_FIELD(16, rejected),
  COPPICE_PART(17, load),
  COPPICE_FIELD_AT(18, run, run.epoch, run()),
  (Field{19, "way_left", [](auto& m) -> auto& { return m.way_left; }, [](auto& dds) -> decltype(auto) { return dds.way_left(); }, true}),
  COPPICE_FIELD(20, wait_cause),
  COPPICE_FIELD(21, came_on_at),
  COPPICE_PART(23, waits)); // 22 was their sum

COPPICE_FIELDS(BrokerStatus, "BrokerStatus",
  COPPICE_FIELD(1, broker),
  COPPICE_FIELD(2, leads),
  COPPICE_FIELD(3, leading_since),
  COPPICE_FIELD(4, nodes_valid),
  COPPICE_FIELD(5, nodes_invalid),
  COPPICE_FIELD(6, trees_active),
  COPPICE_FIELD(7, trees_published),
  COPPICE_FIELD(8, covered_map),
  COPPICE_FIELD(9, rejected),
  COPPICE_FIELD(10, processor_seconds));

COPPICE_FIELDS(ServiceStatus, "ServiceStatus",
  COPPICE_FIELD(1, service),
  COPPICE_FIELD(2, host),
  COPPICE_FIELD(3, process),
  COPPICE_FIELD(4, since),
  COPPICE_FIELD_AT(5, run, run.epoch, run()),
  COPPICE_FIELD(6, problem));

COPPICE_FIELDS(Claim, "Claim",
  COPPICE_FIELD(1, claimant),
  COPPICE_FIELD(2, number),
  COPPICE_FIELD(3, robot));

COPPICE_FIELDS(Assignment, "Assignment",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, claimant),
  COPPICE_FIELD(3, number));

COPPICE_FIELDS(Visit, "Visit",
  COPPICE_FIELD(1, position),
  COPPICE_FIELD(2, has_yaw),
  COPPICE_FIELD(3, yaw),
  COPPICE_FIELD(4, wait));
COPPICE_FIELDS(OrderMessage, "Order",
  COPPICE_FIELD(1, id),
  COPPICE_FIELD(2, action),
  COPPICE_FIELD(3, robots),
  COPPICE_FIELD(4, visits),
  COPPICE_FIELD(5, cancels),
  COPPICE_FIELD(6, priority),
  COPPICE_FIELD(7, deadline),
  COPPICE_FIELD(8, by),
  COPPICE_FIELD(9, why),
  COPPICE_FIELD(10, replaces));
COPPICE_FIELDS(OrderStatus, "OrderStatus",
  COPPICE_FIELD_AT(1, id, order.id, id()),
  COPPICE_FIELD_AT(2, given, order, given()),
  COPPICE_FIELD(3, state),
  COPPICE_FIELD(4, robot),
  COPPICE_FIELD(5, reason),
  COPPICE_FIELD(6, visited),
  COPPICE_FIELD(7, mission),
  COPPICE_FIELD(8, accepted_at),
  COPPICE_FIELD(9, begun_at),
  COPPICE_FIELD(10, ended_at));

COPPICE_FIELDS(HaltMessage::Robot, "HaltedRobot",
  COPPICE_FIELD(1, robot),
  COPPICE_FIELD(2, halt));
COPPICE_FIELDS(HaltMessage, "Halt",
  COPPICE_FIELD(1, number),
  COPPICE_FIELD(2, everybody),
  COPPICE_FIELD(3, robots));
// clang-format on

#undef COPPICE_PART
#undef COPPICE_FIELD
#undef COPPICE_FIELD_AT
#undef COPPICE_ENUMERATORS
#undef COPPICE_FIELDS

}  // namespace coppice
