// All timeouts and protocol constants of a robot agent, each with its unit, its reason, and the assumption
// about network, clocks or processes that it serves (docs/safety.md).
//
// Units. "scaled s": seconds that are multiplied by Fleet::second(). They pass by the wall's clock, or by
// fleet time where that is slower, because states are sent by fleet time. "fleet s": seconds of fleet time.
// "wall s": seconds of the wall's clock. "ticks": states, or control periods.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "coppice/motion/kinematics.h"
#include "messages/messages.h"

namespace coppice {

struct Timing {
  // ---- Control: one decision each control_period (20 Hz), in the whole fleet

  /// fleet s. An agent that slept longer, or whose clock was set, skips the periods in which its robot stood.
  /// Processes: a process may be stopped for any time.
  static constexpr double longest_sleep = 600;
  /// scaled s. An agent that slept for longer does not rely on what it knew of its peers, as if it had been
  /// restarted. Processes, network: after a shorter sleep, a loss of the network of the same length may
  /// follow before the others take this robot for failed (`longest_partition`).
  static constexpr double longest_nap = 30;
  /// scaled s. A robot whose agent slept for longer stands for so long before it moves on; so does a robot
  /// that was cut off. Processes, network: the others may have declared it failed, and have to hear of it
  /// first.
  static constexpr double own_silence = 1;
  /// fleet s for which a robot with no reason to move binds itself to stand. Others may pass it closely.
  static constexpr double idle_lease = 1;
  /// The same, fleet s, of a robot that waits and may soon drive on.
  static constexpr double waiting_lease = 0.3;
  /// fleet s: the longest lease of a robot that waits for another one to pass.
  static constexpr double longest_lease = 2;
  /// A lease grows by this multiple of the clock error. Network, clocks: a late state shortens what the
  /// others may use of the lease.
  static constexpr double lease_for_delay = 4;
  /// fleet s without progress after which a robot calls a round, even if it bound itself to stand meanwhile.
  /// Two robots that push each other back and forth let each other go first for ever.
  static constexpr double longest_stall = 30;
  /// scaled s after which a robot that gave up tries again if another robot has a new goal. Attempts stop the
  /// others, so they are rare.
  static constexpr double between_retries = 300;
  /// scaled s for which the track goes on after the run: those who report on the run must have heard the last
  /// of it.
  static constexpr double recorded_after_the_end = 60;

  // ---- Starting

  /// scaled s in which all agents of a run come. Later, a peer that never said anything is declared failed.
  /// Processes: a process starts within this time.
  static constexpr double longest_startup = 10;
  /// scaled s after `longest_startup` and `longest_partition` in which peers that never came still count as
  /// a piece of the network. Network: a network may be in pieces from the beginning.
  static constexpr double pieces_from_the_beginning = 30;
  /// fleet s for which a process that began in mid-run waits to hear where all peers are. Then it says that
  /// it is stuck.
  static constexpr double longest_ignorance = 120;
  /// The same, scaled s: the larger of both counts. Processes: two processes have to find each other first.
  static constexpr double least_ignorance = 30;

  // ---- Sending states

  /// ticks; 6.4 fleet s. The longest time between two states to a distant peer.
  static constexpr int longest_interval = 128;
  /// ticks between two states of a robot that goes on standing.
  static constexpr int heartbeat_interval = 4;
  /// fleet s until two robots might touch: within this time each sends every state to the other.
  static constexpr double close = 0.4;
  /// The largest share of the time until two robots might touch that may pass between two states.
  static constexpr double interval_share = 0.625;
  /// So many of the nearest peers receive every state. Network: they know the last decisions of a robot that
  /// fails, although samples are lost.
  static constexpr std::size_t witnesses = 6;
  /// A peer becomes a witness instead of another one if its distance is below this share of the other's.
  /// Peers take states that they do not receive, shortly after those of a witness, for lost.
  static constexpr double kept_witness = 0.7;
  /// Processes: so many witnesses listen at any moment, while the others may pause. Copies are counted for
  /// these.
  static constexpr std::size_t sure_witnesses = 3;
  /// ticks between two choices of the witnesses.
  static constexpr int ticks_per_choice = 8;
  /// How often the send interval to a peer is checked within one interval.
  static constexpr int checks_per_interval = 2;
  /// The most copies of one state. Network: enough where a single listener loses 42 % of the samples.
  static constexpr int most_copies = 16;

  /// scaled s for which a state is under way, at the most. Network (docs/safety.md, A6).
  static constexpr double longest_transit = 0.7;

  // ---- Comparing clocks

  /// Echoes to a peer whose clock is known, until the handshake is over. Network: the peer must have heard
  /// one although samples are lost.
  static constexpr int handshakes_needed = 3;
  /// The most peers to which a robot sends a state in a tick for a handshake, or because they ask: as many as
  /// a state has echoes for.
  static constexpr std::size_t answers_a_tick = 32;
  /// The same of a robot whose processor is too busy for its decisions. Processes: where all are busy, all
  /// seem silent to each other, all ask, and the answers would take what is left.
  static constexpr std::size_t answers_if_busy = 4;
  /// ticks: the longest interval between two states to a peer that was not heard yet.
  static constexpr int longest_handshake_interval = 32;
  /// Echoes of one kind in a state, at most.
  static constexpr std::size_t echoes_a_state = 8;
  /// ticks between two states that carry echoes of whatever is news.
  static constexpr int ticks_per_echo = 4;
  /// ticks. A peer with a longer send interval gets echoes of its own, for it hears few others.
  static constexpr int rare = 8;
  /// fleet s between two echoes to such a peer. Clocks: they do not drift far in this time.
  static constexpr double between_echoes = 1;
  /// fleet s; 6 cm at 20 m/s. Clocks: echoes are skipped while the clock of a peer is known so well.
  static constexpr double good_clock = 0.003;
  /// fleet s. A state that arrives later than the estimate by more may tell of a clock that was set.
  static constexpr double prompt_sample = 0.01;
  /// scaled s. Clocks: none is set by more while the fleet drives. Later stamps are from the future, and are
  /// not believed.
  static constexpr double set_clock = 60;
  /// fleet s: the largest clock error that counts. Clocks: a clock that seems further off is at fault.
  static constexpr double largest_clock_error = 5;

  // ---- Silence

  /// scaled s of silence from which on the last state of a peer is relayed: perhaps only some peers heard it.
  static constexpr double relay_from = 0.5;
  /// scaled s of silence until which it is relayed.
  static constexpr double relay_until = 4;
  /// A robot relays so many states to so many peers at each heartbeat, in turn. Each robot begins elsewhere,
  /// and those that were told relay, too: so all peers hear of all states within a few heartbeats. Processes,
  /// network: where all are late, all seem silent, and relays would take what is left.
  static constexpr std::size_t relayed_at_once = 16;
  /// Heartbeats between two relays of what is known of silent peers to a peer that is new or back.
  static constexpr std::uint32_t heartbeats_between_relays = 2;
  /// scaled s between two counts of the silent peers, at most.
  static constexpr double count_interval = 0.5;
  /// scaled s of silence after which a peer is missing. Network, processes: longer than samples are under way
  /// or a process pauses.
  static constexpr double absence = 1;
  /// scaled s of silence after which a robot that misses several peers is cut off.
  static constexpr double long_absence = 1.5;
  /// scaled s of silence of all peers at once after which the robot is alone. Shorter than `absence`: the
  /// robot's own link explains it, and no peer needs to have paused.
  static constexpr double loneliness = 0.6;
  /// States in a row that may be lost of a distant peer before that counts as silence. Network: samples are
  /// lost independently.
  static constexpr double lost_in_a_row = 10;
  /// States in a row that a peer loses before it counts as having been away.
  static constexpr double lost_before_it_is_away = 4;
  /// scaled s without an echo of this robot after which it asks for one. Shorter than `longest_unheard`.
  static constexpr double recent_echo = 0.8;
  /// scaled s without an echo of this robot after which nobody hears it, and it stands. Network: who asks for
  /// an echo is answered at once.
  static constexpr double longest_unheard = 1.8;
  /// scaled s between two answers to a peer that misses another one.
  static constexpr double between_answers = 0.5;

  // ---- Failures

  /// scaled s of silence after which a single peer is declared failed. Processes, network: far longer than a
  /// pause or a run of lost samples. A robot that drives on unheard may touch those who think it failed.
  static constexpr double failure_timeout = 2;
  /// scaled s. Network: a partition heals within this time. A suspected peer, and several silent peers, are
  /// declared failed after it.
  static constexpr double longest_partition = 60;
  /// scaled s after a robot has come to rest until each agent that is not cut off holds it for failed:
  /// distant ones miss ten of its states first, and then a partition may have to heal.
  static constexpr double all_know_of_failures_after = 2 * longest_partition + 10;
  /// scaled s. Network: the last state of a peer that is silent alone is older than those of all others by so
  /// much, for the last sample may have been lost or late.
  static constexpr double said_since = 0.5;
  /// scaled s for which a robot that is cut off drives on until it notices, if several are silent.
  static constexpr double driven_cut_off = 3;
  /// scaled s that a suspected peer may have driven unheard before `longest_unheard` began. Network: what it
  /// said last may have been lost.
  static constexpr double unheard_before = 1;
  /// scaled s for which a peer that is back is informed of the silent ones, and in which nobody is declared
  /// failed. Network: it may know more of the silent peers, and says so at every heartbeat.
  static constexpr double informs_for = 3;
  /// scaled s for which a robot that was out of touch asks for news.
  static constexpr double asks_for_news = 1.5;

  // ---- Coordination rounds

  /// fleet s after a round in which the next one of the same robot reaches further.
  static constexpr double round_again = 60;
  /// scaled s. Network: a joint plan reaches all members within this time.
  static constexpr double plan_delivery = 5;
  /// fleet s without a joint plan after which a member, or the leader, calls a new round. Network: the leader
  /// may have lost sight of somebody.
  static constexpr double longest_wait_for_plan = 60;
  /// The same, scaled s: the larger of both counts.
  static constexpr double least_wait_for_plan = 20;
  /// fleet s without progress, although nobody goes first, after which a member calls a new round.
  static constexpr double plan_patience = 5;
  /// The same, if the robot has found no trajectory.
  static constexpr double patience_without_trajectory = 1.5;
  /// fleet s between the moves of a joint plan and its first departure: the leader finds times for the moves
  /// meanwhile. Only order counts in the end.
  static constexpr double plan_to_departure = 1;

  // ---- Reservations

  /// fleet s. Older states do not show that a robot keeps its strip. A robot that leaves a strip stands for
  /// so long, and until the others could have braked, unless they say that they have heard of it.
  static constexpr double recent_state = 2;
  /// scaled s for which a robot waits for the one whose turn it is. Network: a message reaches all within
  /// this time.
  static constexpr double longest_turn = 5;
  /// fleet s for which a reservation keeps clear of a robot that stands and has none: it is to set off soon,
  /// if it is next in turn.
  static constexpr double sets_off_within = 5;
  /// fleet s between two attempts to reserve, if another robot has a new reservation.
  static constexpr double reserve_again = 0.5;
  /// The same, if nobody has.
  static constexpr double reserve_again_without_news = 2;
  /// fleet s of a trajectory in which a robot goes before one that is held up beside it.
  static constexpr double turn_of_passing = 5;
  /// fleet s for which a robot waits at a gate although the robot at the end of the queue does not come on.
  static constexpr double longest_wait_at_gate = 30;

  // ---- The assignment of a robot

  /// wall s between two claims.
  static constexpr WallTime claim_period = 0.5;
  /// wall s between two claims of an agent that has its robot. Network: several of them may be lost within a
  /// lease.
  static constexpr WallTime claim_renewal = claim_lease / 10;
  /// wall s. An answer that comes later leaves too little of the lease to be heard as the robot.
  static constexpr WallTime answer_counts = claim_lease / 2;
  /// wall s of its own silence after which an agent gives up its robot. Network: shorter than the lease that
  /// the service counts, by any delay that is expected.
  static constexpr WallTime own_claim_lease = 0.8 * claim_lease;
  /// wall s. Nobody else may have spoken as the robot within this time.
  static constexpr WallTime quiet_robot = 1;

  // ---- Planning

  /// wall s between two steps of a search. Network: about the time in which a tree comes from the broker.
  static constexpr WallTime search_pause = 0.0005;
  /// Steps without a tree after which the search does not pause. Processes: there is no broker, or it has
  /// nothing for this robot.
  static constexpr int steps_without_a_tree = 40;
  /// wall s after its first path in which a robot leaves the processor to those that still look for theirs,
  /// at the beginning of a run. Processes: ten on two cores take about as long.
  static constexpr WallTime others_search = 0.01;

  static_assert(loneliness < absence && absence < long_absence && long_absence < longest_unheard);
  static_assert(longest_unheard < failure_timeout && recent_echo < longest_unheard);
  static_assert(2 * longest_nap <= longest_partition);
  static_assert(absence <= informs_for && failure_timeout < longest_partition);
};

/// Fleet seconds for which a robot stands after a silence: others may have driven on where it was not heard.
/// They hear of it, and the line on which they brake then is over before it moves (docs/safety.md, A10).
/// `braking`: the longest braking time of the run. `second`: a scaled second.
inline double listening_time(double braking, double second) {
  const double others_stand = braking + 2 * control_period + Timing::longest_transit * second;
  return std::max(Timing::own_silence * second, others_stand);
}

// Short names of those that are used everywhere.
inline constexpr double longest_sleep = Timing::longest_sleep;
inline constexpr int longest_interval = Timing::longest_interval;
inline constexpr int heartbeat_interval = Timing::heartbeat_interval;
inline constexpr std::size_t witnesses = Timing::witnesses;
inline constexpr std::size_t sure_witnesses = Timing::sure_witnesses;

}  // namespace coppice
