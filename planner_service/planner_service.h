// The planner service: a mission in, progress and a report out.
//
// It hands out the map and the missions, follows what the roles say, ends the run, and makes the report from
// the recorded tracks rather than from anybody's word. A state machine: messages and the time go in, messages
// come out.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "files/picture.h"
#include "files/scenario.h"
#include "files/track_record.h"
#include "messages/bus.h"
#include "messages/messages.h"
#include "planning/clearance_field.h"
#include "planning/ma_rrdt_star.h"
#include "planning/random.h"
#include "planning/random_places.h"
#include "planning/reachability.h"
#include "report.pb.h"
#include "ros2/conversion.h"

namespace coppice {

struct ServiceSettings {
  double time_scale = 1;  ///< fleet seconds a wall second
  double timeout = 3600;  ///< fleet seconds after which the run ends whoever is still under way
  PlannerKind planner = PlannerKind::ma_rrdt_star;
  double plan_budget = 1;        ///< wall seconds for a shorter path after the first one
  double lifelong = 0;           ///< fleet seconds in which every robot that arrives gets a new goal
  bool waits_for_goals = false;  ///< goes on when all have arrived, until it is told to stop
  double margin = 0;             ///< metres beside its radius that each robot takes (robot_agent/tracking.h)
};

struct Progress {
  int robots = 0;
  int planned = 0;
  int arrived = 0;
  int missions = 0;           ///< fulfilled, by all
  double elapsed = 0;         ///< fleet seconds
  std::uint64_t nodes = 0;    ///< valid nodes of the broker and of the robots that have finished planning
  double periods_missed = 0;  ///< share of all control periods of this run
};

class PlannerService {
 public:
  /// Hands out the map at once, and the missions when every agent has trees that cover it; fleet time is 0
  /// then.
  PlannerService(Scenario scenario, const ServiceSettings& settings, WallTime now, TrackRecord record = {});
  PlannerService(const PlannerService&) = delete;  // it points into itself
  PlannerService& operator=(const PlannerService&) = delete;

  /// Goes on with a run whose service was killed, by what that kept (run_record.h), at once or part by part.
  /// False, and nothing of use any more, if it is not a run of this scenario with these settings. Before
  /// anything else.
  bool recall(std::span<const Message> kept, WallTime now);

  void on(const Arrival& arrival);
  /// Somebody wants a robot to go elsewhere: its next mission, in the next step that hands out missions. Of
  /// several the last counts. What is wrong with it, or nothing: then it is refused, and counted.
  std::optional<std::string> on(const RosGoal& goal);
  std::uint32_t goals_refused() const { return goals_refused_; }
  /// Of each robot that arrived, was to get a new goal, and has none so far: its name and the reason.
  std::vector<std::string> robots_without_goal() const;
  std::vector<Message> step(WallTime now);
  WallTime next_wake() const { return next_wake_; }

  /// The one whose missions it has handed out, by the epoch of its clock; none yet.
  std::optional<WallTime> run() const {
    return missions_published_ ? std::optional(clock_.epoch) : std::nullopt;
  }

  /// Ends the run early, as Ctrl-C does.
  void interrupt() { interrupted_ = true; }
  /// The run has ended and all tracks are there, or nobody sends them any more.
  bool finished() const { return finished_; }
  bool everybody_arrived() const;
  /// Every robot arrived, and every one that was to get a new goal got one.
  bool succeeded() const { return everybody_arrived() && robots_without_goal().empty(); }

  Progress progress(WallTime now) const;
  /// From what the agents recorded.
  proto::Report report() const { return report(tracks()); }
  /// From another record of the same run, of its robots in the scenario's order.
  proto::Report report(const TrackParts& tracks) const;
  /// Of this one's record, for as long as it lives.
  TrackParts tracks() const;
  PictureContent picture() const;
  /// A robot's task, with its latest goal. It is in the scenario.
  const RobotTask& task(const RobotName& robot) const { return robots_.at(robot).task; }

 private:
  /// What is known of one robot.
  struct Robot {
    RobotTask task;         ///< with its latest goal
    std::size_t index = 0;  ///< in the scenario's order
    std::uint32_t mission = 1;
    std::uint32_t replaced = 0;               ///< missions that another one ended before they were fulfilled
    std::optional<Point2> wanted;             ///< where somebody wants it to go next
    std::string without_goal;                 ///< why it gets no new one; empty: it does
    WallTime next_draw = 0;                   ///< then: when that is tried again
    std::optional<AgentStatus> status;        ///< of this mission
    std::optional<AgentStatus> first_status;  ///< of its first
    std::uint32_t periods_before = 0;  ///< of control that its process counts, and were before this run
    std::uint32_t missed_before = 0;   ///< of these
    std::uint32_t periods = 0;         ///< of this run
    std::uint32_t periods_missed = 0;
    SampleCounts earlier_nodes;  ///< of the missions before this one
    std::uint32_t earlier_grafts = 0;
    WallTime last_heard = 0;
    std::optional<std::uint32_t> trees_received;  ///< none: it has not appeared yet
    bool lost = false;
    std::optional<double> track_begins;  ///< fleet time of its first point
    bool began_anew = false;             ///< its agent was started anew and does not know where it was
    Path path;
    std::vector<RootNodes::Node> root_nodes;
    bool arrived() const { return status && status->phase == Phase::arrived; }
    /// Until the run has ended; then all are.
    bool was_told_to_stop() const { return status && status->phase == Phase::stopped; }
    bool done(WallTime now) const;
    std::uint32_t missions_fulfilled(bool there) const { return mission - 1 - replaced + there; }
  };

  bool at_goal(const Robot& robot, const std::optional<TrackPoint>& last) const;
  bool stands(const TrackPoint& point) const;
  static bool goes_on(const Robot& robot);
  bool is_of_this_run(WallTime run) const;
  void receive(const AgentStatus& status, WallTime now);
  void receive(const BrokerStatus& status, WallTime now);
  void receive(const PathMessage& path, WallTime now);
  void receive(const TrackMessage& batch, WallTime now);
  void receive(const RootNodes& batch, WallTime now);
  void receive(const InactiveTreeMessage& tree, WallTime now);

  static void count_periods(Robot& robot, const AgentLoad& load);
  double share_of_periods_missed() const;
  void watch_beginning(Robot& robot, double begins);
  MapMessage map() const;
  Mission mission_of(const Robot& robot) const;
  void publish_missions(std::vector<Message>& out) const;
  WallTime meeting() const;
  void reckon_with_silence_before(const Message& kept, WallTime now);
  bool take_up(const Mission& mission, WallTime now);
  static void begin_next_mission(Robot& robot, const Point2& start, const Point2& goal);
  std::optional<std::string> problem_with_goal(const Robot& robot, const Point2& goal);
  const ClearanceField& field();
  void give_wanted_goals(std::vector<Message>& out);
  void give_new_goals(std::vector<Message>& out, WallTime now);
  const ReachablePart& part_of(const Robot& robot);
  std::vector<KeepOut> taken_by_others(const Robot& robot, double spare) const;
  std::optional<Point2> draw_goal(const Robot& robot);
  void goes_without_goal(Robot& robot, WallTime now);
  bool goals_go_on(WallTime now) const;
  bool everybody_has_the_forest() const;
  bool time_for_missions(WallTime now) const;
  void watch_liveliness(WallTime now);
  bool run_is_over(WallTime now);
  bool tracks_complete() const;
  void describe_robot(const Robot& robot, proto::Report::Robot& row) const;
  void describe_run(proto::Report& report) const;
  std::string reason_of(const Robot& robot, bool at_goal) const;
  std::string when_it_fell_silent(const Robot& robot) const;
  std::string how_far_it_came(const Robot& robot) const;
  double plan_time() const;
  double last_path() const;
  double improve_time() const;

  Scenario scenario_;
  ServiceSettings settings_;
  std::string map_id_;
  Random random_;                        ///< of new goals
  std::optional<ClearanceField> field_;  ///< of the map, once it is needed
  std::vector<ReachablePart> parts_{};   ///< of it, in which goals are drawn
  std::uint32_t goals_refused_ = 0;
  FleetClock clock_;
  std::map<RobotName, Robot> robots_;
  TrackRecord record_;
  std::vector<Robot*> order_;  ///< those of `robots_`, as in the scenario
  std::map<std::uint64_t, BrokerStatus> brokers_;
  std::vector<PictureContent::Edge> shared_edges_;
  std::set<TreeId> trees_seen_;
  WallTime begun_;
  WallTime wait_for_tracks_;  ///< after the end
  WallTime last_step_;
  bool map_published_ = false;
  std::optional<std::uint32_t> forest_size_;  ///< trees that cover the map; none: not yet
  bool missions_published_ = false;
  bool says_missions_again_ = false;
  WallTime meets_until_ = 0;  ///< the agents, who were told missions by the one before
  bool interrupted_ = false;
  bool timed_out_ = false;
  bool finished_ = false;
  std::optional<WallTime> ended_;
  WallTime next_wake_ = 0;
};

}  // namespace coppice
