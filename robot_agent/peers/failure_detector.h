// Tells which peers are silent, which ones failed, and whether this robot is cut off from the others.
//
// A peer is silent when states are overdue: peers far away send rarely. A peer that is silent alone for
// Timing::failure_timeout is declared failed. Several that are silent at once look like a network in pieces.
// They are declared failed only after Timing::longest_partition, and the smaller piece stands.
//
// Times are fleet time by this robot's clock, seconds, unless a type says wall clock; metres.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"
#include "robot_agent/peers/loss.h"
#include "robot_agent/peers/own_robot.h"
#include "robot_agent/peers/peer_table.h"
#include "robot_agent/peers/zones.h"
#include "robot_agent/timing.h"

namespace coppice {

class FailureDetector {
 public:
  /// Both outlive it.
  FailureDetector(const OwnRobot& own, PeerTable& peers) : own_(own), peers_(peers) {}

  // The detector learns from messages.

  /// The process was started in mid-run.
  void begin_anew(double now) {
    back_at_ = now;
    go_away(now);
  }
  /// A process that comes only now does not know where the others have gone, and which of them failed there.
  bool is_under_way(double now) const { return now > Timing::longest_startup * own_.second(); }
  /// The table has new peers, or others.
  void count_again() { settled_until_ = 0; }
  /// The peers of another run were dropped: their numbers mean nothing any more.
  void forget_peers();
  /// A peer is known from the time before the first mission.
  void keep(const Peer& peer);
  /// Some echoes tell which states of this robot were heard.
  void hear_own_echoes(const RobotState& state, Peer& teller, double now);
  /// Somebody whom all know said of late that it heard this robot.
  bool echoed(double now) const { return now - own_echo_ < Timing::recent_echo * own_.second(); }
  /// While somebody is missing: other echoes tell which peers the sender hears.
  void hear_of_missing(const RobotState& state, const Peer& teller, double now);
  /// The last state of a peer came once more, relayed by others that no longer hear the peer.
  void hear_relay(Peer& peer, WallTime arrived);
  /// A newer state of the peer is about to be taken up. Returns whether the peer counted as failed.
  bool hear(Peer& peer, const RobotState& state, double now);

  // The judgement, once in each control step.

  void judge(double now, const ClearanceField& field, const LossCount& loss);
  /// One peer is silent that others still hear; or nobody hears this robot; or several peers fell silent at
  /// once, and are not declared failed yet, or are more than are left.
  bool cut_off() const { return contact_.cut_off; }
  /// The robot lost contact with most of the others, so that it may have missed who failed.
  bool out_of_touch() const { return contact_.out_of_touch; }
  /// Somebody was silent or failed at the last count.
  bool somebody_missing() const { return count_.absent + count_.never_came + count_.failed > 0; }
  /// The number of a peer that is silent here and heard by others.
  std::optional<std::size_t> heard_by_others_only() const { return count_.elsewhere; }
  /// Peers that were heard and are not failed.
  std::size_t alive() const { return count_.alive; }
  /// Some peer that is alive may not have heard this robot since it was started or was out of touch.
  bool may_be_unknown() const { return may_be_unknown_; }
  /// Numbers of the peers that were silent at the last count: those that are not failed, and those that are.
  const std::vector<std::size_t>& missing() const { return count_.missing; }
  const std::vector<std::size_t>& silent_failed() const { return count_.silent_failed; }
  /// The largest error of the clock of an alive peer.
  double clock_error(double now) const { return count_.clock_error + clock_drift * (now - count_.at); }
  /// No peer can be silent now.
  bool all_settled(double now) const { return now < settled_until_; }
  /// How often a failed peer was heard again, or a suspected one was sure to have failed.
  std::uint32_t recoveries() const { return recoveries_; }

  /// For so long nothing came that should have come.
  double unheard(const Peer& peer, double now) const;
  /// A suspected peer may be closer than `reach` to p.
  bool is_suspected_near(const Point2& p, double reach) const;
  /// Metres between q and the nearest edge of a robot that is alive; this one is at `position`. Robots count
  /// where they were `since` then, or later; infinite if nothing so new is known.
  double room_at(const Point2& q, const Point2& position, double since, double now) const;
  /// A robot that is alive made this plan. Where it leads robots, none stands that failed long before: the
  /// leader may have heard more of the last decisions of a failed robot. `offset`: seconds, to be added to
  /// the plan's times, at least.
  void learn_from(const JointPlanMessage& plan, double offset);
  /// When somebody was heard last that had been out of touch; and that was started anew.
  double back_at() const { return back_at_; }
  double new_at() const { return new_at_; }

 private:
  /// The last count over all peers.
  struct Absences {
    double at = 0;
    std::size_t alive = 0;  ///< heard at some time, and not failed
    std::size_t unheard = 0;
    std::size_t absent = 0;
    std::size_t long_absent = 0;
    std::size_t never_came = 0;
    std::size_t failed = 0;
    double clock_error = 0;                    ///< the largest of those alive
    std::optional<std::size_t> elsewhere{};    ///< one that is silent here, but not everywhere
    std::vector<std::size_t> missing{};        ///< silent, and not failed
    std::vector<std::size_t> silent_failed{};  ///< silent, and failed
    std::size_t left() const { return 1 + alive - absent; }
  };
  struct Contact {
    bool cut_off = false;
    bool out_of_touch = false;
  };

  double explained_silence(const Peer& peer) const;
  double silence(const Peer& peer, double now) const;
  bool is_missing(const Peer& peer, double seconds, double now) const;
  bool was_away(const Peer& peer, double now) const;
  bool heard_elsewhere(const Peer& peer, double now) const;
  bool silent_alone(const Peer& lost, double now) const;
  double age_of_last_sign(const Peer& peer, double now) const;

  void count(double now);
  void count(Peer& peer, double now);
  Contact contact(double now) const;
  bool is_alone() const;
  bool is_unheard(double newest_echo, double now) const;
  bool is_away(double now) const;
  void go_away(double now);
  void note_whether_all_know(double now);

  void adopt_reported_failures(const ClearanceField& field, const LossCount& loss);
  void declare_silent_failed(double now, const ClearanceField& field, const LossCount& loss);
  std::vector<Peer*> lost_peers(double now);
  std::vector<Peer*> with_those_who_never_came(std::vector<Peer*> lost, double now);
  bool is_minority(std::span<Peer* const> lost) const;
  void stand_as_minority(double now);
  int unheard_states_of(const Peer& peer, const LossCount& loss) const;
  void declare_failed(Peer& peer, int unheard, const ClearanceField& field);
  void suspect(Peer& lost, double now);
  void end_suspicions(double now);
  void prune_zones(double now);

  static constexpr double long_ago = -1e9;

  const OwnRobot& own_;
  PeerTable& peers_;
  Absences count_;             ///< the last one
  double settled_until_ = 0;   ///< no peer can be silent before
  Contact contact_;            ///< at the last judgement
  double minority_until_ = 0;  ///< more peers fell silent at once than are left: this robot stands
  double own_echo_ = 0;        ///< the newest stamp of this robot that somebody whom all know has heard
  double any_echo_ = 0;        ///< the newest stamp of this robot that anybody says to have heard
  double away_at_ = 0;         ///< when this robot was out of touch, or started; others may have given it up
  bool may_be_unknown_ = true;
  double back_at_ = long_ago;
  double new_at_ = long_ago;
  double next_pruning_ = 0;
  bool some_reported_ = false;   ///< a peer may have been reported failed since the last judgement
  bool some_suspected_ = false;  ///< a peer may be suspected
  std::uint32_t recoveries_ = 0;
};

// Each state that is heard goes through these: a hundred agents of one process hear 200,000 a second.

/// The peer lost more than some samples, though it may not have been silent for long enough to count as such;
/// or it comes when the others are under way.
inline bool FailureDetector::was_away(const Peer& p, double now) const {
  if (!p.state) return is_under_way(now);
  const double unheard_for = own_.since(p.heard_at, now) - Timing::long_absence * own_.second();
  return unheard_for > 0 &&
         unheard_for > Timing::lost_before_it_is_away * control_period * own_.interval_from(p);
}

inline bool FailureDetector::hear(Peer& p, const RobotState& state, double now) {
  const bool had_failed = p.failed();
  if (had_failed && p.failure()->in_larger_piece) minority_until_ = 0;
  if (own_.mission && !state.passed_on && was_away(p, now)) p.back_at = back_at_ = now;
  if (state.is_new && own_.run_clock) new_at_ = now;
  if (!p.state || had_failed) settled_until_ = 0;
  const bool reported_failed = !p.state && state.counts_as_failed;
  some_reported_ = some_reported_ || reported_failed;
  p.liveness = liveness::Alive{reported_failed};
  p.relayed.reset();
  recoveries_ += had_failed;
  return had_failed;
}

}  // namespace coppice
