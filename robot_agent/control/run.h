// A robot in one run, from its first mission on: its body, its task, and what it tells the others.
//
// A state machine. The body (motion/body/driver.h) exists all the time, whatever the robot does. Each control
// period the run brings the body up to the present, decides what the body does next (decision.h), and says so
// (control_step.cpp).
//
// Metres in the map frame; fleet time in seconds unless a name or a comment says wall clock.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"
#include "motion/body/driver.h"
#include "motion/trajectory/trail.h"
#include "planning/trees/path_improvement.h"
#include "robot_agent/agreement/coordination_round.h"
#include "robot_agent/agreement/reserver.h"
#include "robot_agent/control/agent_process.h"
#include "robot_agent/control/connectivity.h"
#include "robot_agent/control/decision.h"
#include "robot_agent/control/progress_watch.h"
#include "robot_agent/control/state_counter.h"
#include "robot_agent/control/task.h"
#include "robot_agent/control/track_log.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

class Run {
 public:
  /// `process` and `fleet` outlive it. `mission`: the robot's first in this run, as it carries it out; its
  /// map is the newest. The body begins where the saved state of the process says, if that is of this run.
  Run(AgentProcess& process, Fleet& fleet, const Reservations& others, const Mission& mission, WallTime now)
      : Run(process, fleet, others, mission, take_saved_state(process, mission), now) {}
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Takes up a mission of this run. A cancelled one stops the robot.
  void take_up(const Mission& mission, WallTime now);
  /// Brakes, and takes part in nothing any more.
  void stop();
  /// The same, for `reason`, unless the robot has another reason already.
  void stop(const std::string& reason);

  void hear(const RobotState& state) {
    reserver_.hear(state);
    round_.hear(state, takes_part() ? std::optional(body_.position()) : std::nullopt);
  }
  void hear(std::shared_ptr<const JointPlanMessage> plan);
  /// Another robot may wait to hear that this one does not count on its strip any more.
  void hear(const ReservationMessage& reservation) {
    if (reserver_.has_told(reservation.robot)) fleet_.answer(reservation.robot);
  }
  void hear(const InactiveTreesMessage& trees);
  /// The robot that follows the body was seen.
  void see(const OdometrySample& robot);

  /// A control step if it is due, and some planning if there is something to plan.
  void step(WallTime now, std::vector<Outgoing>& out);
  /// Wall clock.
  WallTime next_wake(WallTime now) const;

  /// Sends the track in batches, or all of it.
  void send_track(bool all, std::vector<Outgoing>& out);
  /// The track ends where the body is now.
  void end_track();
  /// The end of the track, if the process is killed now: the points that were not sent, and those of the body
  /// as it brakes (docs/safety.md, A1). None of a robot that is elsewhere.
  std::optional<TrackMessage> rest_of_track() const;
  /// Whether the status has changed since the last call.
  bool take_status_change();
  /// The status, without the counters of the process.
  AgentStatus status(WallTime now);

  const Driver& body() const { return body_; }
  /// Where robots that count as failed may stand.
  std::vector<Disc> places_of_failed() const {
    return fleet_.zones_of_failed(body_.position(), body_.time());
  }
  /// What it knows of the others.
  const Fleet& fleet() const { return fleet_; }
  /// The reservations that other robots hold, and because of which the last decision left these out.
  std::span<const ReservationId> left_out() const { return left_out_; }
  const Mission& mission() const { return mission_; }
  const std::optional<Tracking>& tracking() const { return tracking_; }
  const std::shared_ptr<MapContext>& map() const { return map_; }
  /// How the robot that follows the body is to drive. It stands if there is none.
  DriveCommand command(WallTime now);

 private:
  Phase phase() const { return phase_of(task_); }
  bool is(Phase phase) const { return phase_of(task_) == phase; }
  bool stopped() const { return std::holds_alternative<Stopped>(task_); }
  bool halted() const { return std::holds_alternative<Halted>(task_); }
  bool driving() const { return std::holds_alternative<Driving>(task_); }
  template <class T>
  void enter(T task) {
    task_ = std::move(task);
    status_changed_ = true;
  }

  Run(AgentProcess& process, Fleet& fleet, const Reservations& others, const Mission& mission,
      const std::optional<SavedState>& saved, WallTime now);
  static std::optional<SavedState> take_saved_state(AgentProcess& process, const Mission& mission);

  // run.cpp: missions and paths
  void begin(const Mission& mission, double now);
  void go_on_from(const SavedState& saved, double now);
  void join_in_mid_run(std::span<const Heard> silent, double now);
  void set_out(double now);
  const char* problem_with_task() const;
  std::optional<Point2> room_near(const Point2& place, double radius) const;
  std::optional<Point2> way_off_the_wall() const;
  void look_for_a_path(Path known = {});
  Path way_back_to_the_path(const Route& route) const;
  PathImprover<ClearanceField>& improver();
  void plan(WallTime now, std::vector<Outgoing>& out);
  void take_result(PathFinder::Result result, std::unique_ptr<PathFinder> finder, WallTime now,
                   std::vector<Outgoing>& out);
  bool others_still_search(const Route& route, WallTime now) const;
  void follow(Route& route, const Path& path, std::vector<Outgoing>& out);
  void improve(Route& route, WallTime now, std::vector<Outgoing>& out);

  // control_step.cpp: the control step
  void control(double now, std::vector<Outgoing>& out);
  void pass_over(double now);
  void wake(double now);
  double listening_time() const;
  bool is_too_long(double seconds) const;
  void decide(double now, std::vector<Outgoing>& out);
  void watch_contact(double now);
  void doubt_orders(double now);
  void heed_halt(double now);  // halt.cpp
  void go_on(double now);      // halt.cpp
  void watch_joining(double now);
  void watch_isolation(double now);
  bool its_robot_is_behind(double now) const;
  void look_for_neighbours(double now);
  void take_up_plans(double now, std::vector<Outgoing>& out);
  void look_along_the_way(double now);
  Situation situation(double now);
  void carry_out(const Decision& decision, double now);
  void note_progress(const Decision& decision, double now);
  void leave_the_wall(double now);
  bool may_set_off();
  bool takes_part() const;
  Stage stage() const;
  FleetMember self() const;

  // reserving.cpp: reservations and rounds
  void reserve(double now, std::vector<Outgoing>& out);
  bool may_reserve(double now) const;
  bool leads_elsewhere() const;
  void take_reserved_path(std::vector<Outgoing>& out);
  void call_if_it_stalls(double now);
  Path way_ahead() const;
  double time_to_face(const Path& way) const;
  double around() const;
  bool all_free_around() const;

  // arrival.cpp: whether the robot comes on
  void watch_arrival(double now);
  bool is_at_its_goal() const;
  bool heads_as_wanted() const;
  bool its_robot_is_there(double now);
  Rest rest_of_its_robot() const;
  double yaw_arrives_within() const;
  void give_up(std::string reason);
  void retry_after_change();
  void watch_movement(double now, double lived);
  bool is_under_way() const;
  bool stands_still(double now) const;

  // state_message.cpp: what the robot says
  void speak(double now, bool heartbeat, std::vector<Outgoing>& out);
  void relay_states(double now, std::vector<Outgoing>& out);
  RobotState state(double now, std::vector<Echo> echoes) const;
  std::uint8_t copies() const;
  bool overloaded() const;
  int periods_to_next_control() const;
  bool records(double now) const;

  // wait_cause.cpp
  static double WaitTimes::*wait_kind(Cause cause);
  std::string wait_cause(double now) const;
  std::string what_is_wrong_with_the_odometry(WallTime now) const;
  std::string which_plan_it_waits_for() const;
  std::string whom_it_does_not_know() const;
  std::string why_it_is_cut_off() const;
  std::string what_is_in_the_way() const;
  double way_left() const;

  /// When the robot decides, and whether it comes to that in time.
  struct ControlTiming {
    bool first = true;         ///< no decision yet: the first one is due at once
    int periods_expected = 1;  ///< until the next decision
    double late = 0;           ///< share of the last decisions that came late
  };

  AgentProcess& process_;
  Fleet& fleet_;
  Mission mission_;                  ///< the one that is carried out
  std::shared_ptr<MapContext> map_;  ///< of the mission
  std::optional<Tracking> tracking_;
  Driver body_;
  Trail trail_;  ///< since the robot last saw its path
  TrackLog track_;
  double last_seen_ = -1;  ///< of the last point of the track, where a robot follows the body
  CoordinationRound round_;
  Reserver reserver_;
  double last_moved_ = 0;  ///< when the robot last moved by a joint plan, or along its path
  Connectivity connectivity_;
  double asks_for_news_until_ = 0;  ///< until then peers tell the robot which peers failed
  StateCounter counter_;
  ControlTiming timing_;
  ProgressWatch progress_;
  std::vector<Neighbour> near_;          ///< of the last decision
  std::vector<ReservationId> left_out_;  ///< of the last decision
  Decision decision_;
  std::uint32_t recoveries_ = 0;          ///< of peers, that the robot has reckoned with
  std::uint32_t recoveries_doubted_ = 0;  ///< of peers, after which it has doubted all orders

  // begin() sets these anew for each mission.
  AgentStatus status_;
  bool status_changed_ = true;
  WallTime begun_at_ = 0;  ///< wall clock
  double startup_since_ = 0;
  Point2 came_to_ = Point2::Zero();  ///< where the robot last came on
  int times_stranded_ = 0;
  std::unique_ptr<PathImprover<ClearanceField>> improver_;  ///< on the map, for `improver_radius_`
  double improver_radius_ = 0;
  Task task_ = Impossible{};  ///< last: finders look at the map and the improver
};

}  // namespace coppice
