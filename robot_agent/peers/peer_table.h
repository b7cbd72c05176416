// The knowledge of a robot about each peer, by number.
//
// A hundred agents of one process know ten thousand peers, far more than caches hold. So data that are used
// together lie in one cache line, and data that each control step reads of all peers lie in their own arrays.
//
// Times are fleet time by this robot's clock, seconds, unless a type says wall clock; metres.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/planning/geometry.h"
#include "messages/clock_offset.h"
#include "messages/messages.h"
#include "messages/name_index.h"
#include "robot_agent/peers/loss.h"
#include "robot_agent/peers/zones.h"

namespace coppice {

/// The data of a failed peer.
struct Failure {
  Zone zone{};
  bool in_larger_piece = false;  ///< the network is in pieces, and this robot is in a smaller one
};
/// The data of a suspected peer. It counts as failed, but may be alive and cut off. Then it drives on until
/// it notices that nobody hears it.
struct Suspicion {
  Failure failure{};
  double until = 0;   ///< from then on the peer is sure to stand
  double strays = 0;  ///< metres between the peer and its `place` at most, until then
};

namespace liveness {

/// The peer has a mission, and has not said anything.
struct Expected {};
struct Alive {
  bool reported_failed = false;  ///< by the relay that first told of it: the next step declares it failed
};
// The data of these two are seldom used. They lie elsewhere, so that the hot data of a peer fit into two
// lines.
struct Suspected {
  std::unique_ptr<Suspicion> suspicion = std::make_unique<Suspicion>();
};
struct Failed {
  std::unique_ptr<Failure> failure = std::make_unique<Failure>();
};

}  // namespace liveness

/// Suspected and failed peers both count as failed.
using Liveness = std::variant<liveness::Expected, liveness::Alive, liveness::Suspected, liveness::Failed>;

/// When the last state of a peer was relayed, again and again, by others that no longer hear the peer.
struct Relayed {
  WallTime first = 0;
  WallTime last = 0;
};
/// While a peer is missing: the newest of its states that others say they heard.
struct HeardElsewhere {
  double stamp = 0;
  double holds_until = 0;  ///< until then it shows the peer alive, though no newer one comes
};

/// The data of class Dissemination about a peer: the messages between the two robots.
struct StateExchange {
  std::uint32_t interval_until = 0;  ///< tick at which to compute the send interval again
  std::uint8_t phase = 0;            ///< of the ticks at which the peer is sent a state (send_interval.h)
  std::uint8_t interval = 1;         ///< ticks between these
  std::uint8_t handshakes = 0;      ///< echoes sent since its clock is known; up to Timing::handshakes_needed
  bool is_in_turn : 1 = false;      ///< for a handshake or an answer, in this tick
  bool is_witness : 1 = false;      ///< the peer is a witness of this robot
  bool waits_for_this : 1 = false;  ///< the peer waits for this robot
  bool misses_somebody : 1 = false;  ///< the peer misses this robot, or one that is heard here
  bool asks : 1 = false;             ///< the peer asks for an echo, of itself or of a robot that it misses
};

/// Another robot of which there was a state or a mission, or both.
struct alignas(64) Peer {
  // First cache line: where the peer is, and whether it is silent.
  std::shared_ptr<const RobotState> state{};  ///< the last one; null: none yet
  Point2 place = Point2::Zero();              ///< of that state; or where its mission begins; or of its zone
  WallTime heard_at = 0;                      ///< when the state came, or else the first mission
  double radius = 0;                          ///< of its state, or else its mission
  double max_speed = 0;                       ///< of its state, or else its mission
  double settled_until = 0;                   ///< the peer cannot be silent before

  // Second cache line: what is used when the peer says something, or is told something.
  ClockOffset clock{};  ///< between its fleet time and that of this robot
  Received received{};
  Liveness liveness{};
  std::unique_ptr<Relayed> relayed{};  ///< null: no relay came since the last state
  StateExchange exchange{};

  // Seldom used.
  RobotName robot{};
  std::unique_ptr<const Mission> mission{};  ///< null: none yet
  std::optional<double> back_at{};           ///< when it was heard again after it was out of touch
  double echo_sent = 0;                      ///< the newest of its stamps that was echoed
  double has_heard = 0;                      ///< the newest stamp of this robot that it says to have heard
  HeardElsewhere elsewhere{};

  /// Suspected or failed.
  bool failed() const { return !alive() && !expected(); }
  bool expected() const { return std::holds_alternative<liveness::Expected>(liveness); }
  bool alive() const { return std::holds_alternative<liveness::Alive>(liveness); }
  /// Null: the peer is neither suspected nor failed.
  const Failure* failure() const;
  Failure* failure() { return const_cast<Failure*>(std::as_const(*this).failure()); }  // NOLINT
  /// Null: the peer is not suspected.
  const Suspicion* suspicion() const {
    const auto* const suspected = std::get_if<liveness::Suspected>(&liveness);
    return suspected == nullptr ? nullptr : suspected->suspicion.get();
  }
};
static_assert(offsetof(Peer, robot) == 128 && (sizeof(RobotName) != 32 || sizeof(Peer) == 256));

inline const Failure* Peer::failure() const {
  if (const Suspicion* const suspected = suspicion()) return &suspected->failure;
  const auto* const failed = std::get_if<liveness::Failed>(&liveness);
  return failed == nullptr ? nullptr : failed->failure.get();
}

/// All peers, by number: the order in which they were first heard of.
class PeerTable {
 public:
  std::size_t size() const { return peers_.size(); }
  bool has_room_for(const RobotName& robot) const;
  std::optional<std::size_t> find(const RobotName& robot) const { return index_.find(robot); }
  std::size_t number_of(const Peer& peer) const { return static_cast<std::size_t>(&peer - peers_.data()); }
  /// The number of the robot, and whether it is new.
  std::pair<std::size_t, bool> find_or_add(const RobotName& robot);
  /// Empties the table.
  std::vector<Peer> take_all();

  Peer& operator[](std::size_t number) { return peers_[number]; }
  const Peer& operator[](std::size_t number) const { return peers_[number]; }
  auto begin() { return peers_.begin(); }
  auto end() { return peers_.end(); }
  auto begin() const { return peers_.begin(); }
  auto end() const { return peers_.end(); }

  // Each control step reads these of all peers, by number.
  std::vector<double> away_until{};        ///< fleet time: the peer cannot come near before
  std::vector<std::uint32_t> told_from{};  ///< tick: the peer is sent nothing before, except about rounds
  std::vector<double> answered_until{};    ///< fleet time: no echo of a robot that the peer misses before

 private:
  std::vector<Peer> peers_;
  NameIndex index_;
};

}  // namespace coppice
