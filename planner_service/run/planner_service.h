// The planner service: missions in, progress and a report out.
//
// It publishes the map and the missions, follows what the agents and brokers say, ends the run, and makes the
// report. The report rests on the recorded tracks: what an agent says of its arrival does not count. A state
// machine: messages and the time go in, messages come out.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/motion/coordination.h"
#include "files/picture.h"
#include "files/pose_file.h"
#include "files/track_record.h"
#include "messages/bus.h"
#include "messages/messages.h"
#include "planner_service/orders/goal_source.h"
#include "planner_service/orders/order_book.h"
#include "planner_service/orders/order_intake.h"
#include "planner_service/report/driven.h"
#include "planner_service/report/robot_record.h"
#include "planner_service/report/seen_forest.h"
#include "planner_service/run/fleet_memory.h"
#include "planner_service/run/liveliness.h"
#include "planner_service/run/run_phase.h"
#include "planning/geometry/voronoi_roadmap.h"
#include "report.pb.h"
#include "ros2/conversion.h"
#include "saved_run.pb.h"

namespace coppice {

struct ServiceSettings {
  double time_scale = 1;  ///< fleet seconds in a wall second
  double timeout = 3600;  ///< fleet seconds after which the run ends, even if robots still drive
  PlannerKind planner = PlannerKind::ma_rrdt_star;
  TreeParameters trees{};
  ForestStart forest = ForestStart::ahead;
  double plan_budget = 1;  ///< wall seconds for a shorter path after the first one
  double lifelong = 0;     ///< fleet seconds in which each robot that arrives gets a new goal
  /// The run goes on when all have arrived, until it is interrupted. It takes orders.
  bool waits_for_goals = false;
  /// A joint plan that was made elsewhere: by robot, from its start at time 0; empty: none.
  std::vector<Trajectory> plan{};
  Coordination coordination = Coordination::reservations;
  bool robots_elsewhere = false;  ///< robots outside of Coppice follow (robot_agent/control/tracking.h)
  std::string map_frame{"map"};   ///< of goals over ROS
  /// Of a standing fleet: where robots begin, in place of their starts. A robot goes on where its agent knows
  /// it to stand, unless `starts_are_given`.
  std::vector<RobotPose> starts{};
  bool starts_are_given = false;
};

struct Progress {
  int robots = 0;
  int planned = 0;
  int arrived = 0;
  int missions = 0;           ///< fulfilled by all robots
  double elapsed = 0;         ///< fleet seconds
  std::uint64_t nodes = 0;    ///< valid nodes of the brokers and of the robots that have finished planning
  double periods_missed = 0;  ///< share of all control periods of this run
};

class PlannerService {
 public:
  /// The first step publishes the map. The missions follow when every agent has the trees that cover the map,
  /// or at once if the trees grow together with the missions. Fleet time is 0 then.
  PlannerService(Scenario scenario, const ServiceSettings& settings, WallTime now, TrackRecord tracks = {});
  PlannerService(const PlannerService&) = delete;  // its parts refer to its scenario
  PlannerService& operator=(const PlannerService&) = delete;

  /// Goes on with the run of a service that was killed, from the messages that it saved (saved_run.h), all
  /// at once or part by part. Call it before anything else. False: they are not of a run of this scenario
  /// with these settings, and this object is of no use any more.
  bool recall(std::span<const Message> saved, WallTime now);
  /// The same with the figures of a snapshot. Before its messages.
  bool recall(const proto::SavedRun& figures);
  /// What all that was saved of the run so far amounts to (compact_run.cpp). Only of a run that has begun.
  struct Snapshot {
    std::vector<Message> messages;
    proto::SavedRun figures;
  };
  Snapshot snapshot() const;
  /// Takes up the orders and halts of the fleet before this one. Before recall().
  void remember(const FleetMemory& memory);
  /// Orders that were sent before then are of a fleet before this one, unless its run goes on.
  void takes_orders_since(WallTime at) { intake_.fleet_began(at); }
  /// The run that it recalls was ended, and its service was killed before it had done all.
  bool recalls_an_end() const { return std::holds_alternative<CollectingTracks>(phase_); }
  /// What the next fleet on this state has to know (fleet_memory.h).
  FleetMemory memory() const;

  void on(const Arrival& arrival);
  /// Requests a robot's next goal: it becomes the robot's mission in the next step of a run. A later request
  /// replaces an earlier one. Returns why the request is refused, if it is.
  std::optional<std::string> on(const RosGoal& goal);
  /// New orders are refused for this reason; empty: they are taken up. What the fleet has goes on.
  void refuse_orders(std::string reason) { no_orders_ = std::move(reason); }
  std::uint32_t goals_refused() const { return goals_refused_; }
  /// A line for each robot that arrived, was to get a new goal, and has none so far: its name and the reason.
  std::vector<std::string> robots_without_goal() const;
  std::vector<Message> step(WallTime now);
  WallTime next_wake() const { return next_wake_; }

  /// The run whose missions it has published, by the epoch of its clock; none yet.
  std::optional<RunId> run() const;

  /// Ends the run early, as Ctrl-C does. A run that has not begun is nothing that the agents need to hear of:
  /// they may drive for another service.
  void interrupt();
  /// The run has ended, and all tracks are complete or too late.
  bool finished() const;
  bool everybody_arrived() const;
  /// Every robot arrived, and every one that was to get a new goal got one.
  bool succeeded() const { return everybody_arrived() && robots_without_goal().empty(); }

  Progress progress(WallTime now) const;
  /// Takes up the end of the track of a robot whose agent was killed. After the run.
  void complete(TrackMessage rest, WallTime now);
  /// Made from the tracks that the agents sent.
  proto::Report report() const { return report(tracks(), counted_); }
  /// Made from other tracks of the same run, with its robots in the order of the scenario.
  proto::Report report(const TrackParts& tracks) const { return report(tracks, Driven(scenario_.robots)); }
  /// The tracks that the agents sent; of a fleet that waits for goals, their last minute. This object
  /// outlives them.
  TrackParts tracks() const;
  PictureContent picture() const;
  /// A robot's task, with its latest goal. The robot is in the scenario.
  const RobotTask& task(const RobotName& robot) const { return robots_.at(robot).task; }

 private:
  // The service receives messages.
  void receive(const AgentStatus& status, WallTime now);
  void receive(const BrokerStatus& status, WallTime now);
  void receive(const PathMessage& path, WallTime now);
  bool was_never_seen(const RobotRecord& robot) const;
  void receive(const TrackMessage& batch, WallTime now);
  void receive(const RootNodes& batch, WallTime now);
  void receive(const InactiveTreesMessage& trees, WallTime now);
  void receive(const OrderMessage& order, WallTime now);
  template <class M>
  RobotRecord* find_in_run(const M& message);
  template <class M>
  RobotRecord* find_in_mission(const M& message);

  // The service publishes messages.
  /// Whether the broker is to cover the map before the missions go out.
  bool grows_ahead() const;
  MapMessage map() const;
  Mission mission_of(const RobotRecord& robot) const;
  void publish_missions(std::vector<Message>& out) const;
  JointPlanMessage given_plan() const;

  // The phases.
  void begin_when_ready(const WaitingForTrees& waiting, WallTime now);
  bool every_agent_has(std::uint32_t trees) const;
  void continue_run(std::vector<Message>& out, WallTime now);
  std::optional<RunEnd> end_of_run(WallTime now) const;
  void finish_when_complete(const CollectingTracks& collecting, WallTime now);
  bool tracks_complete() const;
  void step_at_once() { next_wake_ = 0; }

  // Goals.
  std::vector<RoomOfRobot> rooms() const;
  void assign_requested_goals(std::vector<Message>& out, WallTime now);
  void send(RobotRecord& robot, const NextGoal& goal, std::vector<Message>& out);
  void assign_drawn_goals(std::vector<Message>& out, WallTime now);
  void begin_next_mission(RobotRecord& robot, const Point2& start, const NextGoal& goal);

  // Orders (serve_orders.cpp).
  std::string why_never(const OrderMessage& order);
  bool can_reach(const RobotRecord& robot, const Point2& place);
  const std::vector<bool>& able_robots(const OrderMessage& order);
  void refuse_outdated_orders(WallTime now);
  WallTime silence_of(std::size_t robot) const;
  std::vector<RobotAtWork> robots_at_work() const;
  void serve_orders(std::vector<Message>& out, WallTime now);
  struct KeptPlace {
    Point2 place;
    double radius;  ///< metres
    std::string by;
  };
  bool must_stay(std::size_t robot) const;
  std::vector<KeptPlace> kept_places() const;
  std::vector<const OrderMessage*> open_orders_for(std::span<const std::size_t> free);
  void give_out_open_orders(std::span<const RobotAtWork> robots);
  void carry_out(const DueOrder& due, std::vector<Message>& missions, WallTime now);
  bool step_aside(std::size_t robot, std::size_t for_robot, const Point2& place,
                  std::vector<Message>& missions, WallTime now);
  void stop_on_the_way(std::size_t robot, std::vector<Message>& missions, WallTime now);
  Point2 place_of(const RobotRecord& robot) const;

  // Going on with the run of another service.
  bool recall_mission(const Mission& mission, WallTime now);
  void recall_silence(const Message& saved, WallTime now);
  WallTime time_to_rediscover() const;

  void recall(const proto::SavedRun::Robot& from, RobotRecord& robot);

  // A run that does not end (compact_run.cpp).
  void count_tracks(WallTime now);
  TrackPart part_of_tracks(double from, double until) const;
  std::vector<TrackMessage> tracks_not_counted(const RobotRecord& robot) const;

  // The service judges what became of a robot.
  bool is_at_goal(const RobotRecord& robot, const std::optional<TrackPoint>& last) const;
  bool stands(const TrackPoint& point) const;
  bool drives_on(const RobotRecord& robot) const;
  bool is_done(const RobotRecord& robot, WallTime now) const;
  AgentStage stage_of(const RobotRecord& robot) const;

  // The report (run_report.cpp). `comes_to_stand`: by its track.
  proto::Report report(const TrackParts& tracks, Driven counted) const;
  void describe_robot(const RobotRecord& robot, bool comes_to_stand, proto::Report::Robot& row) const;
  void describe_run(proto::Report& report) const;
  std::string reason_of(const RobotRecord& robot, bool at_goal, bool comes_to_stand) const;
  std::string why_it_is_under_way(const RobotRecord& robot) const;
  std::string rest_of_way(const RobotRecord& robot) const;

  Scenario scenario_;
  ServiceSettings settings_;
  std::string map_id_;
  RobotRecords robots_;
  Liveliness liveliness_;
  TrackRecord tracks_;
  Driven counted_;  ///< what the tracks showed before `counted_until_`
  double counted_until_ = -std::numeric_limits<double>::infinity();  ///< fleet time
  std::unique_ptr<const ClearanceField> counting_field_;             ///< of the map; null: nothing is counted
  SeenForest forest_;
  GoalSource goals_;
  std::uint32_t goals_refused_ = 0;
  OrderBook orders_;
  std::string no_orders_;  ///< why there can be no new ones; empty: there can
  OrderIntake intake_;
  std::map<std::string, std::vector<bool>> able_;  ///< of open orders for any robot, by robot
  std::unique_ptr<const VoronoiRoadmap> roadmap_;  ///< null: the run takes no orders
  RunPhase phase_;
  bool map_due_ = true;  ///< the next step publishes the map, in whatever phase
  WallTime next_wake_ = 0;
};

}  // namespace coppice
