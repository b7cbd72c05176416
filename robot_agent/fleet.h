// What a robot knows of all the others: their missions, their last states, who counts as failed, and how far
// each clock is from its own.
//
// Times are fleet time by this robot's clock, seconds; metres. What the others' stamps say is translated here
// and nowhere else.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "messages/clock_offset.h"
#include "messages/messages.h"
#include "messages/name_index.h"
#include "motion/promise.h"
#include "motion/segments.h"
#include "planning/clearance_field.h"
#include "robot_agent/age_count.h"
#include "robot_agent/loss.h"
#include "robot_agent/send_interval.h"

namespace coppice {

/// Seconds of fleet time between two decisions: 20 Hz. The same for the whole fleet.
inline constexpr double control_period = 0.05;

/// An agent that slept longer than that, fleet seconds, or whose clock was set, does not live through each
/// period.
inline constexpr double longest_sleep = 600;

/// Who falls silent may have sent states that only some have heard: from so many seconds on they are passed
/// on.
inline constexpr double relay_from = 0.5;

/// What a robot knows of one robot of the fleet, itself or another.
struct FleetMember {
  RobotName robot;
  Point2 position = Point2::Zero();
  Point2 velocity = Point2::Zero();
  std::optional<Point2> goal{};  ///< its own place if its mission is not known; none: it has given up
  double arrives_within = 0;     ///< metres from its goal at which it has arrived
  bool wants_to_stay = false;    ///< where it is: it neither plans nor drives
  double radius = 0;
  double max_speed = 0;
  double rests_until = 0;      ///< fleet time; if it stands it has bound itself to that, else when it said so
  bool stands = false;         ///< and will until something new is heard of it
  bool failed = false;         ///< counts as failed
  bool takes_no_part = false;  ///< in rounds: it was stopped, or cannot know where all are
  RoundId round;
  Stage stage = Stage::free;
  double progress = 0;
};

/// The last state of one that fell silent, and when, at the latest, that was heard: fleet time.
struct Heard {
  RobotState state;
  double at = 0;
};

class Fleet {
 public:
  explicit Fleet(RobotName self) : self_(std::move(self)) {}

  void hear(const Mission& mission, WallTime arrived);
  /// False if it is no news: older than what is known, or of this robot itself.
  bool hear(std::shared_ptr<const RobotState> state, WallTime arrived);

  /// Whoever comes only now does not know where the others have gone, and which of them have died there.
  bool is_under_way(double now) const;
  /// Its process was started anew, or for the first time, in mid-run: where others are that have said nothing
  /// since, only others know, and these of whom it has kept the last states.
  void begin_anew(std::span<const Heard> silent, double now);

  /// Asks memory for what is known of a robot whose state is about to be handed over.
  void expect(const RobotName& robot) const;

  const std::optional<Mission>& own_mission() const { return own_mission_; }
  /// Tells the run that the missions are of from others; none before the first mission.
  std::optional<FleetClock> run() const { return has_clock_ ? std::optional(clock_) : std::nullopt; }

  /// Once in each control step, with where this robot is and what round it holds in (none: no epoch): who has
  /// been silent for too long counts as failed from now on.
  void detect_failures(double now, const Point2& position, const RoundId& waits_in,
                       const ClearanceField& field);
  /// What counts as a second of silence, in fleet time: one of the wall's clock, and never less than states
  /// take that come by fleet time.
  double second() const { return std::max(1.0, clock_.scale); }
  /// At the last judgement: one is silent that others still hear; or nobody hears this one; or several at
  /// once fell silent, and not for so long that they count as failed, or more than are left do.
  bool cut_off() const { return cut_off_; }
  /// Likewise: one that is silent, and that others still hear; none: nobody.
  std::optional<RobotName> heard_by_others_only() const;
  /// Likewise: with most of the others, so that it may have missed who died.
  bool out_of_touch() const { return out_of_touch_; }
  /// Somebody has said of late to have heard of this robot.
  bool echoed(double now) const;
  /// How often to say what this robot decides: more than once where few listen or much is lost, so that one
  /// of them hears the last of it.
  int copies() const { return copies_; }

  /// Who could touch this robot, or must be avoided by it, within `horizon` seconds: this robot is at
  /// `position` and stays within `reach` of it. Leaves them in `near`. Counts how old what is known of those
  /// is that might be touched soon: others say something seldom.
  void collect_neighbours(const Point2& position, double reach, double horizon, double now, AgeCount& ages,
                          std::vector<Neighbour>& near);

  /// How often one was heard of that counted as failed, or came to do so beyond suspect.
  std::uint32_t recoveries() const { return recoveries_; }
  /// How often others were wanted elsewhere: who stood in another's way may go.
  std::uint32_t new_goals() const { return new_goals_; }
  /// One that counts as failed may only be cut off, and so be closer than `reach` to p; or be anywhere.
  bool is_suspected_near(const Point2& p, double reach) const;

  std::optional<FleetMember> find(const RobotName& robot) const;
  std::vector<FleetMember> others() const;
  /// Those within so many sums of radii of a robot at p.
  std::vector<FleetMember> beside(const Point2& p, double radius, double sums) const;
  /// Where the failed may stand; this robot is at `position`.
  std::vector<Disc> zones_of_failed(const Point2& position, double now) const;
  /// Everybody alive within the round's reach is known to hold in it, and to stand; but for those whom a
  /// later round has called away.
  bool all_wait(const RoundId& round) const;
  /// Nobody alive within `reach` of p holds, or has moves of a joint plan left to make.
  bool all_free(const Point2& p, double reach) const;
  /// How far from p the cluster_reach extends that p is part of: everybody alive who is near one of it.
  double cluster_reach(const Point2& p, double near) const;
  /// At most what an alive robot's clock was off from what was known of it at the last count of who is
  /// silent, and may be since; about what a sample takes to come from it.
  double clock_error(double now) const;
  /// Somebody looks for its first path still.
  bool somebody_plans() const;
  /// All missions that are known, one's own as well, are cancelled.
  bool run_is_over() const;
  /// Those that have missions which are not cancelled, this one as well.
  std::vector<RobotName> robots_of_the_run() const;
  /// How many there are to be; 0 before the first mission.
  std::size_t size_of_the_run() const { return size_of_the_run_; }
  /// One of which it must hear before it may set off; empty: none.
  RobotName unknown() const;
  /// Those that are silent now, and do not count as failed.
  std::vector<RobotName> missing() const;
  /// So many robots have missions, and each was heard of and has its clock compared, or counts as failed, or
  /// has no more to do.
  bool complete(std::size_t robots);

  /// Whom a state is for (interest.h), and some of the stamps that were heard, all in tick: so that these can
  /// compare clocks, and know whom others hear. `tick`: the number of the state. `news`: of its round, for
  /// all within it. `waits_for`: the robot that this one waits for, if any.
  struct Address {
    std::vector<RobotName> agents;
    std::vector<Echo> echoes;
    std::vector<RobotName> misses;  ///< those of whom this robot hears nothing; where these are many, in tick
  };
  Address address(std::uint32_t tick, const RoundId* news, const RobotName& waits_for, double now);
  /// For those of these a state is said more than once, if it is.
  std::vector<RobotName> who_hears_copies(std::span<const RobotName> agents) const;
  /// The last states of those who have just fallen silent.
  std::vector<RobotState> last_words(double now) const;
  /// Who was started anew in mid-run, or out of touch and is back: they may not know where all are, or have
  /// been last. And what to tell them of those who are silent or count as failed.
  std::vector<RobotName> peers_to_inform(double now) const;
  std::vector<RobotState> states_of_silent_peers(double now) const;

 private:
  /// Another robot of which there was a state or a mission: at least one of these is there. A hundred agents
  /// of one process know ten thousand of these, far more than caches hold: so each line of one (64 bytes) has
  /// what is asked for together.
  struct alignas(64) Peer {
    // Where it is, and whether it is silent.
    std::shared_ptr<const RobotState> state{};  ///< the last one; null: none yet
    Point2 place = Point2::Zero();              ///< by that, or where its mission begins, or where it died
    WallTime heard_at = 0;                      ///< of the state, or else of the first mission
    double radius = 0;                          ///< by its state, or else its mission; and so
    double max_speed = 0;
    double settled_until = 0;  ///< it cannot count as silent before

    // What it says to this robot, and is told by it.
    ClockOffset clock{};  ///< of fleet times
    Received received{};
    double echo_sent = 0;              ///< the newest stamp that was echoed
    int handshakes = 0;                ///< echoes that it was sent since its clock is known
    std::uint32_t phase = 0;           ///< of the ticks at which it is told something
    int interval = 1;                  ///< between these
    std::uint32_t interval_until = 0;  ///< tick at which to look at that again
    bool is_witness = false;           ///< of this robot
    bool waits_for_this = false;       ///< robot
    bool is_ignorant = false;          ///< it misses this robot, or one that is heard here
    bool asks = false;                 ///< for an echo, its own or one's that it misses: it stands meanwhile
    bool failed = false;               ///< counts as failed
    bool reported_failed = false;      ///< by the first who told of it
    bool said_again = false;           ///< what it said last, by somebody who hears no more of it
    bool across = false;               ///< the larger piece of a network in pieces

    RobotName robot{};
    std::unique_ptr<const Mission> mission{};
    std::vector<Point2> rests{};  ///< where it may stand, if it counts as failed; else empty

    double suspected_until = 0;    ///< fleet time until which it may be alive, and only cut off
    double strays = 0;             ///< metres that it may be from `place` until then
    double back_at = 0;            ///< fleet time: it was out of touch, and was heard of again
    WallTime said_again_from = 0;  ///< its last state was said again and again: first and last
    WallTime said_again_at = 0;
    double echoed = 0;  ///< the newest of its stamps that others say to have heard, while somebody is missing
    double echo_holds_until = 0;  ///< fleet time until which that shows it alive, though no newer one comes
  };
  static_assert(sizeof(RobotName) != 32 || sizeof(Peer) == 256);

  struct Absences {
    std::size_t alive = 0;  ///< and heard of at some time
    std::size_t unheard = 0;
    std::size_t absent = 0;
    std::size_t long_absent = 0;
    std::size_t never_came = 0;
    std::size_t failed = 0;
    std::optional<std::size_t> elsewhere{};  ///< one that is silent here, but not everywhere
  };

  std::size_t number_of(const RobotName& robot);
  void forget_other_runs();
  bool has_room_for(const RobotName& robot) const;
  bool is_untrustworthy(const RobotState& passed_on, const Peer& peer, WallTime arrived) const;
  bool is_from_the_future(double stamp, const Peer& peer, double now) const;
  double since(WallTime at, double now) const { return now - clock_.fleet_time(at); }
  double gap(const Peer& p) const { return (p.place - position_).norm() - own_mission_->radius - p.radius; }
  double closing_speed(const Peer& p) const { return own_mission_->max_speed + p.max_speed; }
  int interval_to(const Peer& peer, double now) const;
  bool may_be_touched_soon(const Peer& p) const;
  bool is_known(const Peer& p) const;
  bool is_told(std::size_t number, std::uint32_t tick, double now);
  /// At most; it may think that it is closer.
  int interval_from(const Peer& p) const {
    return waits_in_.epoch > 0 && hears_about_round_from(p) ? 1 : send_interval(gap(p), closing_speed(p));
  }
  bool is_synchronised(const Peer& peer) const;
  int handshake_interval() const;
  bool tells_about_round(const Peer& peer) const;
  bool hears_about_round_from(const Peer& peer) const;
  bool tells_at_every_heartbeat(const Peer& peer) const;
  bool was_away(const Peer& peer, double now) const;
  double explained_silence(const Peer& peer) const;
  double unheard(const Peer& peer, double now) const;
  double silence(const Peer& peer, double now) const;
  void choose_witnesses();
  bool hears(const Peer& peer, double now) const;
  bool answers(const RobotState& state, std::size_t asker, double now);
  std::vector<RobotName> next_missing();
  std::vector<Echo> next_echoes(std::span<Peer* const> addressed, std::uint32_t tick);
  void hear_again(Peer& peer, WallTime arrived);
  void hear_own_echo(const RobotState& state, ClockOffset& clock, double now);
  void hear_of_the_missing(const RobotState& state, const Peer& teller, double now);
  bool missing(const Peer& peer, double seconds, double now) const;
  bool heard_elsewhere(const Peer& peer, double now) const;
  const Absences& absences(double now);
  void count_absences(double now);
  void count_absence(Peer& peer, double now);
  bool is_alone(const Absences& count) const;
  bool unheard_by_all(const Absences& count, double now) const;
  bool silent_alone(const Peer& lost, double now) const;
  double age_of_last_sign(const Peer& peer, double now) const;
  std::vector<Peer*> with_those_who_never_came(std::vector<Peer*> lost, double now);
  void stand_as_minority(bool several_fell_silent, double now);
  void declare_silent_failed(const Absences& count, double now, const ClearanceField& field);
  bool is_minority(std::span<Peer* const> lost, std::size_t left) const;
  void shrink_zones(double now);
  double room_at(const Point2& q, const Point2& position, double now) const;
  void adopt_reported_failures(const Absences& count, double now, const ClearanceField& field);
  int unheard_states_of(const Peer& peer, const Absences& count) const;
  void declare_failed(Peer& peer, int unheard, const ClearanceField& field, double now);
  void suspect(Peer& lost, double now);
  void end_suspicions(double now);
  void add_neighbours(const Peer& peer, const Point2& position, double now,
                      std::vector<Neighbour>& near) const;
  double covers_rests(const Peer& peer) const;
  FleetMember member(const Peer& peer) const;

  RobotName self_;
  Point2 position_ = Point2::Zero();
  RoundId waits_in_;
  bool leads_ = false;                 ///< that round
  std::optional<std::size_t> leader_;  ///< of it, if that is another; index in `peers_`
  FleetClock clock_;
  bool has_clock_ = false;
  std::optional<Mission> own_mission_;
  std::vector<Peer> peers_;
  NameIndex index_;  ///< of `peers_`
  // What each step asks of all of these, by number.
  std::vector<double> away_until_;        ///< fleet time: it cannot come near before
  std::vector<std::uint32_t> told_from_;  ///< tick: it is told nothing before, but of rounds
  std::vector<double> answered_until_;    ///< fleet time: whom it misses it is told no sooner again
  std::size_t next_echo_ = 0;
  std::size_t chosen_among_ = 0;  ///< so many peers were the witnesses
  LossCount loss_;
  int copies_ = 1;
  double own_echo_ = 0;  ///< the newest stamp of this robot that somebody says to have heard
  std::vector<std::size_t> missed_by_others_;  ///< and heard here
  std::vector<std::size_t> missing_;           ///< at the last count, and not failed
  std::vector<std::size_t> silent_failed_;     ///< likewise, those that count as failed
  std::size_t asked_for_ = 0;                  ///< of these, by all states so far
  Absences absences_;
  double counted_at_ = 0;         ///< fleet time of the last count of absences
  double clock_error_ = 0;        ///< the largest of those alive then
  double all_settled_until_ = 0;  ///< fleet time: nobody can count as silent before
  std::uint32_t recoveries_ = 0;
  std::uint32_t new_goals_ = 0;
  bool some_suspected_ = false;  ///< anybody
  static constexpr double long_ago = -1e9;
  double somebody_back_at_ = long_ago;  ///< fleet time
  double somebody_new_at_ = long_ago;   ///< fleet time at which somebody was heard of who was started anew
  std::size_t size_of_the_run_ = 0;
  bool all_known_ = false;  ///< nobody has come since everybody's clock was known, or needed not to be
  bool begun_anew_ = false;
  bool somebody_missing_ = false;
  bool failure_reported_ = false;
  double next_zone_check_ = 0;
  bool cut_off_ = false;
  bool out_of_touch_ = false;
  /// Fleet time: those who fell silent at once were more than those who are left.
  double minority_until_ = 0;
};

}  // namespace coppice
