// The knowledge of a robot about all others: their missions, their last states, their failures, and the
// offsets of their clocks.
//
// Fleet composes a table of peers (peer_table.h), a failure detector (failure_detector.h), and the
// dissemination of states (dissemination.h).
//
// Times are fleet time by this robot's clock, seconds, unless a type says wall clock; metres. The stamps of
// peers are translated here and nowhere else.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"
#include "motion/body/braking_line.h"
#include "motion/trajectory/segments.h"
#include "robot_agent/peers/age_count.h"
#include "robot_agent/peers/dissemination.h"
#include "robot_agent/peers/failure_detector.h"
#include "robot_agent/peers/own_robot.h"
#include "robot_agent/peers/peer_table.h"
#include "robot_agent/timing.h"

namespace coppice {

/// The knowledge of a robot about one robot of the fleet, itself or another.
struct FleetMember {
  RobotName robot;
  Point2 position = Point2::Zero();
  Point2 velocity = Point2::Zero();
  std::optional<Point2> goal{};  ///< its place if its mission is not known; none: it has given up
  double arrives_within = 0;     ///< metres from its goal at which it has arrived
  bool wants_to_stay = false;    ///< where it is: it neither plans nor drives
  double radius = 0;
  double max_speed = 0;
  double rests_until = 0;      ///< if it stands: it bound itself to that; else when it said where it is
  bool stands = false;         ///< and will, until something new is heard of it
  bool failed = false;         ///< suspected or failed
  bool takes_no_part = false;  ///< in rounds: it was stopped, or cannot know where all peers are
  RoundId round;
  Stage stage = Stage::free;
  std::uint32_t reservation = 0;
  double reservation_progress = 0;  ///< at the decision time of its promise
  RobotName waits_for;
  Promise promise{};
  Limits limits{};
  double clock_offset = 0;  ///< seconds, to be added to its times
  double clock_error = 0;   ///< seconds, until this robot stands, if it decides something now
};

/// Metres that a robot drives on from the decision time of its promise, whatever it decides.
inline double way_until_rest(const FleetMember& m) {
  const double speed = m.promise.next_velocity.norm();
  return (m.promise.expiry - m.promise.decision_time) * speed +
         braking_distance(speed, m.limits, control_period);
}

/// When a robot comes to rest by its promise, fleet time, if it decides nothing more. However long it has
/// bound itself to stand, it rests already.
inline double rests_at(const FleetMember& m) {
  if (m.promise.stands()) return m.promise.stamp;
  return m.promise.expiry +
         control_period * braking_periods(m.promise.next_velocity.norm(), m.limits, control_period);
}

/// The last state of a peer that fell silent, and when, at the latest, it was heard: fleet time.
struct Heard {
  RobotState state;
  double at = 0;
};

class Fleet {
 public:
  explicit Fleet(RobotName self) : own_{.name = std::move(self)} {}
  Fleet(const Fleet&) = delete;
  Fleet& operator=(const Fleet&) = delete;

  void hear(const Mission& mission, WallTime arrived);
  /// False if it is no news: older than what is known, or of this robot itself.
  bool hear(std::shared_ptr<const RobotState> state, WallTime arrived);

  /// A process that comes only now does not know where the others have gone, and which of them failed there.
  bool is_under_way(double now) const { return detector_.is_under_way(now); }
  /// The process was started in mid-run. Only the others know where peers are that have said nothing since.
  /// `silent`: of these it kept the last states.
  void begin_anew(std::span<const Heard> silent, double now);
  /// The process slept for longer than Timing::longest_nap. Peers that had not failed before are unknown
  /// until they are heard again, or others report them failed.
  void wake(double now);

  void learn_from(const JointPlanMessage& plan, double offset) { detector_.learn_from(plan, offset); }

  /// Asks memory for what is known of a robot whose state is about to be handed over.
  void expect(const RobotName& robot) const;

  const std::optional<Mission>& own_mission() const { return own_.mission; }
  /// Tells the run that the missions are of from others; none before the first mission.
  std::optional<FleetClock> run() const { return own_.run_clock; }

  /// Once in each control step, with where this robot is, and in which round it waits (none: no epoch). Peers
  /// that have been silent for too long are declared failed.
  void detect_failures(double now, const Point2& position, const RoundId& waits_in,
                       const ClearanceField& field);
  /// A scaled second (timing.h), in fleet time: one second of the wall's clock, or one of fleet time where
  /// that takes longer, because states are sent by fleet time.
  double second() const { return own_.second(); }
  /// At the last detection: one peer is silent that others still hear; or nobody hears this robot; or several
  /// peers fell silent at once, and are not declared failed yet, or are more than are left.
  bool cut_off() const { return detector_.cut_off(); }
  /// At the last detection: a peer that is silent here, and that others still hear; none: nobody.
  std::optional<RobotName> heard_by_others_only() const;
  /// At the last detection: the robot lost contact with most of the others. It may have missed who failed.
  bool out_of_touch() const { return detector_.out_of_touch(); }
  /// Somebody said of late that it heard this robot.
  bool echoed(double now) const { return detector_.echoed(now); }
  /// Some peer that is alive may not have heard this robot since it was started or was out of touch.
  bool may_be_unknown() const { return detector_.may_be_unknown(); }
  /// How often to send each state: several times where few listen or much is lost.
  int copies() const { return dissemination_.copies(); }

  /// The robots that could touch this robot, or that it must avoid, within `horizon` seconds. This robot is
  /// at `position` and stays within `reach` of it. They come into `near`. Counts in `ages` how old the states
  /// of those are that might be touched soon: others send rarely.
  /// A robot for which passes(state, age) holds is left out: the order of reservations keeps the two apart.
  void collect_neighbours(const Point2& position, double reach, double horizon, double now, AgeCount& ages,
                          std::vector<Neighbour>& near,
                          const std::function<bool(const RobotState&, double)>& passes = nullptr);

  /// How often a failed peer was heard again, or a suspected one was sure to have failed.
  std::uint32_t recoveries() const { return detector_.recoveries() + released_; }
  /// How often others got new goals: a robot that stood in the way may go.
  std::uint32_t new_goals() const { return new_goals_; }
  /// A suspected peer may be closer than `reach` to p.
  bool is_suspected_near(const Point2& p, double reach) const {
    return detector_.is_suspected_near(p, reach);
  }

  /// With `now`, its clock's error from that time on.
  std::optional<FleetMember> find(const RobotName& robot, double now = 0) const;
  /// Null: nothing is known of the robot.
  const ClockOffset* clock_of(const RobotName& robot) const {
    const auto number = peers_.find(robot);
    return number ? &peers_[*number].clock : nullptr;
  }
  std::vector<FleetMember> others() const;
  /// The robots within so many sums of radii of a robot at p.
  std::vector<FleetMember> beside(const Point2& p, double radius, double sums, double now = 0) const;
  /// Where failed robots may stand. This robot is at `position`.
  std::vector<Disc> zones_of_failed(const Point2& position, double now) const;
  /// All robots that are not failed, and that are within the round's reach, are known to wait in it, and to
  /// stand; except those that a later round called away.
  bool all_wait(const RoundId& round) const;
  /// No robot within `reach` of p waits in a round, or has moves of a joint plan left; failed ones aside.
  bool all_free(const Point2& p, double reach) const;
  /// Whether a robot within reach stands and waits until this one has passed.
  bool is_awaited(const Point2& p, double reach) const;
  /// Whether no robot within reach waits for a joint plan.
  bool nobody_waits(const Point2& p, double reach) const;
  /// How far from p the cluster extends of a robot that stands at p and is to drive along `way`. Each robot
  /// of a cluster is closer than `near` to another one, or stands in this robot's way and has no reservation.
  /// Failed ones aside.
  double cluster_reach(const Point2& p, const Path& way, double near) const;
  /// Metres from p to the nearest other robot; infinite: there is none.
  double nearest(const Point2& p) const;
  /// The largest error of the clock of a robot that is alive. About the time that a sample takes to come.
  double clock_error(double now) const { return detector_.clock_error(now); }
  /// Somebody still looks for its first path.
  bool somebody_plans() const;
  /// All missions that are known are cancelled, the own one as well.
  bool run_is_over() const;
  /// The robots with missions that are not cancelled, this one as well.
  std::vector<RobotName> robots_of_the_run() const;
  /// How many robots there are to be; 0 before the first mission.
  std::size_t size_of_the_run() const { return size_of_the_run_; }
  /// Robots of which something was heard, and this one.
  std::size_t known() const { return peers_.size() + 1; }
  /// The longest time that a robot of the run takes to brake, seconds.
  double longest_braking() const { return longest_braking_; }
  /// The longest time that a peer needs to stop now, seconds. Peers count that could come close to this robot
  /// if it set off meanwhile.
  double longest_stop() const;
  /// A robot that must be heard before this one may set off; empty: none.
  RobotName unknown() const;
  /// A state of the robot was heard, or it counts as failed.
  bool is_placed(const RobotName& robot) const;
  /// Peers that are silent now, and are not failed.
  std::vector<RobotName> missing() const;
  /// As many robots are known as the run has, and each of them was heard and its clock is known, or it is
  /// failed, or has no more to do.
  bool complete();
  /// About how many seconds it takes from the missions on until all clocks are known.
  double handshakes_take() const {
    constexpr double states_each_way = 2;
    return states_each_way * control_period * static_cast<double>(peers_.size()) / Timing::answers_a_tick;
  }
  /// As many robots are known as the run has.
  bool has_missions() const { return known() >= size_of_the_run_; }

  /// Some peers may not know this robot's clock.
  bool shakes_hands() const { return dissemination_.shakes_hands(); }

  /// The next state goes to a peer, too.
  void answer(const RobotName& robot) {
    if (const auto number = peers_.find(robot)) dissemination_.answer(*number);
  }

  using Address = Dissemination::Address;
  /// The recipients of a state, the echoes and the missing peers that it names.
  Address address(std::uint32_t tick, const RoundId* news, const RobotName& waits_for, bool busy,
                  double now) {
    return dissemination_.address(tick, news, waits_for, busy, now);
  }
  /// The recipients that receive further copies of a state.
  std::vector<RobotName> who_hears_copies(std::span<const RobotName> agents) const {
    return dissemination_.who_hears_copies(agents);
  }
  /// What to relay at this heartbeat: of peers that have just fallen silent, and to those that are back.
  Dissemination::Relay last_words(double now) { return dissemination_.last_words(now); }
  Dissemination::Relay news_for_those_back(double now) { return dissemination_.news_for_those_back(now); }

 private:
  Peer& peer(const RobotName& robot);
  void forget_other_runs();
  bool is_overslept(const RobotState& state, const Peer& peer) const;
  bool is_untrustworthy(const RobotState& relayed, const Peer& peer, double now) const;
  void compare_clocks(const RobotState& state, Peer& peer, double now);
  void take_up(std::shared_ptr<const RobotState>&& state, std::size_t number, double now);
  bool is_known(const Peer& peer) const;
  bool may_be_touched_soon(const Peer& peer) const;
  double error_in_window(const Peer& peer, double now) const;
  void add_neighbours(const Peer& peer, const Point2& position, double now,
                      std::vector<Neighbour>& near) const;
  FleetMember member(const Peer& peer, double now = 0) const;

  OwnRobot own_;
  PeerTable peers_;
  FailureDetector detector_{own_, peers_};
  Dissemination dissemination_{own_, peers_, detector_};
  std::uint32_t new_goals_ = 0;
  std::uint32_t released_ = 0;  ///< peers that were halted and go on
  double longest_braking_ = 0;
  std::size_t size_of_the_run_ = 0;
  bool all_known_ = false;  ///< nobody came since is_known() held for all peers
};

}  // namespace coppice
