// Tells to which peers a robot sends its state, how often, and with which echoes; and which states of silent
// peers it relays.
//
// Close peers and a few witnesses receive every state, others receive states at their send interval
// (send_interval.h). Echoes tell a peer which of its states came, so that both can compare their clocks.
//
// Times are fleet time by this robot's clock, seconds, unless a type says wall clock; metres.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "messages/messages.h"
#include "robot_agent/peers/failure_detector.h"
#include "robot_agent/peers/loss.h"
#include "robot_agent/peers/own_robot.h"
#include "robot_agent/peers/peer_table.h"
#include "robot_agent/peers/send_interval.h"

namespace coppice {

/// Goes through lists that may change, a few elements at a time.
class Turns {
 public:
  explicit Turns(std::size_t first) : next_(first) {}

  /// Leaves the next `most` elements in the list, or all if they are fewer.
  template <class T>
  void leave_next(std::vector<T>& list, std::size_t most) {
    if (list.size() <= most) return;
    const auto first = static_cast<std::ptrdiff_t>(next_ % list.size());
    std::rotate(list.begin(), list.begin() + first, list.end());
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(most), list.end());
    next_ += most;
  }

 private:
  std::size_t next_;
};

class Dissemination {
 public:
  /// All of these outlive it.
  Dissemination(const OwnRobot& own, PeerTable& peers, const FailureDetector& detector)
      : own_(own),
        peers_(peers),
        detector_(detector),
        relayed_(std::hash<RobotName>{}(own.name)),
        relayed_to_(std::hash<RobotName>{}(own.name)) {}

  /// The peers of another run were dropped.
  void forget_peers();
  /// A state of a peer came, first copy, not relayed: counts which of its states were lost.
  void count_loss(Peer& peer, std::uint32_t tick) {
    const Received::Count count = peer.received.hear(tick);
    if (own_.mission) loss_.add(count);
  }
  /// A newer state of the peer was taken up. Notes what the peer asks for.
  void hear(std::size_t number, double now);

  /// A state goes to this peer soon, with an echo.
  void answer(std::size_t number) { peers_[number].exchange.asks = somebody_asks_ = true; }

  const LossCount& loss() const { return loss_; }
  /// Chooses how often to send each state: several times where few listen or much is lost, so that one peer
  /// hears the last of it.
  void choose_copies(std::size_t alive) {
    copies_ = alive > 0 ? loss_.copies_for(std::min(alive, sure_witnesses)) : 1;
  }
  int copies() const { return copies_; }
  /// Some peers may not know this robot's clock.
  bool shakes_hands() const { return shakes_hands_; }

  struct Address {
    std::vector<RobotName> agents;  ///< recipients
    std::vector<Echo> echoes;
    std::vector<RobotName>
        misses;  ///< peers that are silent here; some of them in each tick if they are many
  };
  /// `tick`: the number of the state. `news`: of its round, for all within that. `waits_for`: the robot that
  /// this one waits for, if any.
  Address address(std::uint32_t tick, const RoundId* news, const RobotName& waits_for, bool busy, double now);
  /// The recipients that receive further copies of a state.
  std::vector<RobotName> who_hears_copies(std::span<const RobotName> agents) const;

  struct Relay {
    std::vector<RobotState> states;
    std::vector<RobotName> hearers;
  };
  /// What to relay at this heartbeat of peers that have just fallen silent. No states: nobody has.
  Relay last_words(double now);
  /// What to relay to peers that were started anew in mid-run, or were out of touch and are back: they may
  /// not know where all peers are, or may have been last. The last states of peers that are silent or failed.
  /// No hearers: nobody is back.
  Relay news_for_those_back(double now);

 private:
  bool is_synchronised(const Peer& peer) const;
  bool tells_about_round(const Peer& peer) const;
  int interval_to(const Peer& peer, double now) const;
  bool is_told(std::size_t number, std::uint32_t tick, double now);
  void choose_witnesses();
  void choose_in_turn(std::size_t most);
  bool hears(const Peer& peer, double now) const;
  bool answers(std::size_t asker, double now);
  std::vector<RobotName> next_missing();
  std::vector<RobotName> those_back(double now) const;
  RobotState last_state(const Peer& p) const;
  std::vector<Echo> next_echoes(std::span<Peer* const> addressed, std::uint32_t tick);

  const OwnRobot& own_;
  PeerTable& peers_;
  const FailureDetector& detector_;
  LossCount loss_;
  int copies_ = 1;
  std::size_t chosen_among_ = 0;  ///< so many peers were the witnesses
  bool shakes_hands_ = false;
  bool somebody_asks_ = false;
  std::size_t last_echo_ = 0;  ///< number of the peer whose echo was sent last
  std::size_t next_echo_ = 0;  ///< number of the peer whose echo is news next
  std::vector<std::size_t>
      missed_by_others_;  ///< numbers of peers that are heard here: echoed in the next state
  Turns relayed_, relayed_to_;
  std::size_t asked_for_ = 0;  ///< missing peers that all states have named so far
};

inline void Dissemination::hear(std::size_t number, double now) {
  Peer& p = peers_[number];
  if (answers(number, now) || p.state->wants_echo) answer(number);
  p.exchange.waits_for_this = p.state->waits_for == own_.name;
  p.exchange.interval_until = 0;
  peers_.told_from[number] = 0;
  shakes_hands_ = shakes_hands_ || !is_synchronised(p);
}

}  // namespace coppice
