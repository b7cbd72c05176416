// One robot: finds its path with what the broker's trees teach, drives, and keeps clear of the others.
//
// A state machine: messages and the time go in, messages come out; no clock, thread or I/O. The body
// (driver.h) exists from the first mission on, whatever the robot is doing.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"
#include "motion/driver.h"
#include "motion/path_follower.h"
#include "motion/trail.h"
#include "planning/path_improvement.h"
#include "robot_agent/age_count.h"
#include "robot_agent/fleet.h"
#include "robot_agent/map_context.h"
#include "robot_agent/coordination_round.h"
#include "robot_agent/saved_state.h"
#include "robot_agent/path_finder.h"
#include "robot_agent/tracking.h"

namespace coppice {

class RobotAgent {
 public:
  explicit RobotAgent(RobotName name, std::shared_ptr<MapContexts> grounds = std::make_shared<MapContexts>())
      : name_(std::move(name)), grounds_(std::move(grounds)), fleet_(name_), round_(name_) {
    status_.robot = name_;
  }

  /// What its predecessor kept (memory.h), if that was killed in mid-run. Before anything else. It is of use
  /// if the mission that comes is of the same run.
  void recall(std::optional<SavedState> memory) { memory_ = std::move(memory); }

  /// Its robot is elsewhere and follows its body: it takes more room, and the track is that of the robot.
  /// Before anything else.
  void lead(const TrackingSettings& settings) { tracking_.emplace(settings); }

  /// These will be handed over next. A hint for processes of many agents, which know more than the
  /// processor's caches hold: so all of it comes from memory at once, and not one after the other.
  void expect(std::span<const Arrival> arrivals) const;
  void on(Arrival arrival);
  /// The robot that follows was seen.
  void on(const OdometrySample& robot);
  /// One control step if it is due, and some planning if there is something to plan; returns what to publish.
  std::vector<Outgoing> step(WallTime now);
  /// What the process's bus has counted, for the status.
  void note(const BusCounts& counts, WallTime now);
  /// When `step` has something to do even if nothing arrives.
  WallTime next_wake() const { return next_wake_; }

  /// Its process is to end: it brakes and stands, and takes no mission any more.
  void retire();
  bool stands() const { return !body_ || body_->stands(); }
  /// What is left to say: the rest of the track, and the status.
  std::vector<Outgoing> last_words(WallTime now);

  /// Where it drives; none before its first mission.
  const std::optional<Driver>& body() const { return body_; }
  /// What it carries out; none before its first.
  const std::optional<Mission>& mission() const { return mission_; }
  /// Of a robot that follows.
  const std::optional<Tracking>& tracking() const { return tracking_; }
  /// How that is to drive now, metres a second of the wall's clock; in the map frame.
  Point2 command(WallTime now) const;

 private:
  void receive(const MapMessage& message, WallTime arrived);
  void receive(const Mission& mission, WallTime arrived);
  void receive(const InactiveTreeMessage& tree, WallTime arrived);

  Mission as_reference(Mission mission) const;
  void begin_run();
  std::shared_ptr<MapContext> ground_of(const Mission& mission) const;
  void begin_mission(WallTime now);
  void take_up(const Mission& mission, WallTime now);
  void place_body(const Mission& mission, double fleet_now);
  void go_on_from(const SavedState& memory, double fleet_now);
  void join_late(std::span<const Heard> silent, double fleet_now);
  void forget_trees(const std::function<bool(const InactiveTreeMessage&)>& which);
  const char* problem_with_task() const;
  void stop();
  void look_for_a_path(Path known = {});
  Path way_back_to_the_path() const;
  PathImprover<ClearanceField>& improver();
  void plan(WallTime now, std::vector<Outgoing>& out);
  void take_up(const PathFinder::Result& result, WallTime now, std::vector<Outgoing>& out);
  void follow(const Path& path, std::vector<Outgoing>& out);
  void improve(WallTime now, std::vector<Outgoing>& out);
  void control(double fleet_now, std::vector<Outgoing>& out);
  void relay_states(double fleet_now, std::vector<Outgoing>& out);
  void pass_over(double fleet_now);
  double grace() const;
  void listen_anew(double fleet_now);
  void decide(double fleet_now);
  bool stands_as_newcomer(double fleet_now);
  void watch_isolation(double fleet_now);
  void watch_coming_on(double fleet_now, double lived);
  bool is_under_way() const;
  bool does_not_come_on(double fleet_now) const;
  std::string wait_cause(double fleet_now);
  std::string why_it_has_no_mission(WallTime now) const;
  std::string why_it_is_cut_off() const;
  std::string what_is_in_the_way() const;
  double way_left() const;
  bool is_too_long(double seconds) const;
  bool waits_for_its_robot(double fleet_now);
  void drive_freely(double fleet_now, std::span<const Neighbour> neighbours);
  void execute_plan(double fleet_now, std::span<const Neighbour> neighbours);
  void stand_for(double fleet_now, double seconds);
  bool records(double fleet_now) const;
  bool takes_part() const;
  double stalled_for(double fleet_now) const;
  bool lets_go_first(const Point2& preferred) const;
  void watch_arrival(double fleet_now);
  void give_up(std::string reason);
  void retry_after_change();
  bool may_set_off(double fleet_now);
  bool all_free_around() const;
  void enter(Phase phase);
  std::span<const Neighbour> neighbours(double fleet_now);
  FleetMember self() const;
  int periods_to_next_control() const;
  std::uint8_t copies() const;
  void speak(double fleet_now, bool heartbeat, std::vector<Outgoing>& out);
  RobotState state(double fleet_now, std::vector<Echo> echoes) const;
  void say_track(std::vector<Outgoing>& out);
  void report(WallTime now, std::vector<Outgoing>& out);

  /// What must have changed for a robot that stands to have news.
  struct Steady {
    bool stands = false;
    Phase phase = Phase::waiting;
    RoundId round{};
    Stage stage = Stage::free;
    RobotName waits_for{};
    bool operator==(const Steady&) const = default;
  };

  RobotName name_;
  std::shared_ptr<MapContexts> grounds_;
  std::shared_ptr<MapContext> map_;                             ///< the newest
  std::shared_ptr<MapContext> ground_;                          ///< of the mission's map
  std::unique_ptr<PathImprover<ClearanceField>> improver_;  ///< on the ground, for `improver_radius_`
  double improver_radius_ = 0;
  std::vector<InactiveTreeMessage> trees_;  ///< of this map
  std::set<TreeId> tree_ids_;               ///< of all these
  std::size_t tree_nodes_ = 0;              ///< of all of these
  std::uint32_t impossible_ = 0;            ///< messages that this map, or this time, contradicts
  std::uint32_t rejected_by_bus_ = 0;
  AgeCount ages_;
  std::vector<Neighbour> near_;  ///< those of the last decision
  int periods_expected_ = 1;     ///< until the next decision
  double late_ = 0;              ///< share of the last decisions that came late
  AgentLoad load_;
  Fleet fleet_;

  std::optional<SavedState> memory_;    ///< until its mission comes
  std::optional<Mission> mission_;  ///< the one that is being carried out
  std::unique_ptr<PathFinder> finder_;
  std::optional<PathFinder::Result> found_;  ///< in the last step
  std::optional<Driver> body_;
  std::optional<Tracking> tracking_;  ///< of a robot that is elsewhere
  std::optional<PathFollower> follower_;
  Trail trail_;  ///< since it last saw its path
  CoordinationRound round_;
  Point2 came_to_ = Point2::Zero();         ///< where it last came on
  double last_gain_ = 0;                    ///< metres along its path when it last came on
  double last_gain_time_ = 0;               ///< fleet time
  double last_bound_time_ = 0;              ///< fleet time at which it last was bound to stand
  double last_pace_time_ = 0;               ///< fleet time at which it last drove about as fast as it liked
  bool lets_others_finish_ = false;         ///< its mission came while a joint plan was being driven
  double last_drive_time_ = 0;              ///< fleet time at which it last moved under orders
  std::vector<TrackMessage::Point> track_;  ///< not yet sent
  double last_seen_ = -1;                   ///< fleet time of the last of these, where a robot follows
  AgentStatus status_;
  bool status_changed_ = true;
  bool retired_ = false;
  std::uint32_t sequence_ = 0;    ///< of the next state, by control periods
  std::uint32_t last_heartbeat_ = 0;   ///< in standing strides
  std::uint32_t since_change_ = 0;  ///< control steps
  std::uint32_t since_round_change_ = 0;  ///< control steps in which nothing about its part in a round has changed
  Steady last_said_;
  std::uint8_t copies_promised_ = 1;  ///< by its last state
  bool first_control_ = true;
  double gave_up_at_ = 0;             ///< fleet time at which it last gave up
  std::uint32_t new_goals_ = 0;       ///< that others had been given until then
  double asks_for_news_until_ = 0;      ///< fleet time: until then it asks who has died
  bool said_that_it_stands_ = false;  ///< since it was stopped
  double stopped_at_ = std::numeric_limits<double>::infinity();  ///< fleet time
  double heard_again_at_ = 0;  ///< fleet time: until then it stands, after a silence
  bool is_new_ = false;        ///< does not know yet where all others are, though it is mid-run
  bool is_isolated_ = false;   ///< gave up because others hear one that it does not
  double isolated_since_ = std::numeric_limits<double>::infinity();  ///< fleet time: they have done so
  bool has_left_round_ = false;  ///< others count on its part in a joint plan that it knows no more
  double startup_since_ = 0;  ///< fleet time
  int times_stranded_ = 0;
  bool gave_up_ = false;                    ///< as the others stood
  std::uint32_t recoveries_ = 0;  ///< of what is known of the failed, that it has reckoned with
  std::optional<WallTime> run_heard_at_;    ///< its first mission, whichever robot's
  WallTime mission_wall_ = 0;
  WallTime first_path_wall_ = 0;
  WallTime next_status_ = 0;
  WallTime next_wake_ = 0;
};

}  // namespace coppice
