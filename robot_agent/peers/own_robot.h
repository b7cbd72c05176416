// The knowledge of a Fleet about its own robot: its position, its mission, the clock of its run, and the
// round that it waits in. Silences, distances and send intervals of peers are measured from it.
//
// Times are fleet time by this robot's clock, seconds, unless a type says wall clock; metres.
#pragma once

#include <algorithm>
#include <optional>
#include <variant>

#include "messages/fleet_clock.h"
#include "messages/messages.h"
#include "robot_agent/peers/peer_table.h"
#include "robot_agent/peers/send_interval.h"

namespace coppice {

struct OwnRobot {
  struct WaitsInNoRound {};
  /// The robot waits in a round that it leads.
  struct Leads {
    RoundId round;
  };
  /// The robot waits in a round that a peer leads.
  struct Follows {
    RoundId round;
    std::optional<std::size_t> leader;  ///< number of the peer; none: nothing was heard of it yet
  };

  RobotName name;
  std::optional<FleetClock> run_clock{};  ///< none before the first mission
  std::optional<Mission> mission{};
  Point2 position = Point2::Zero();
  std::variant<WaitsInNoRound, Leads, Follows> wait{};
  bool began_in_mid_run = false;  ///< the process: it knows nothing of what was before
  /// From the last long sleep: the process knows little of what was before.
  std::optional<double> woke_at{};

  /// `round`: without an epoch if the robot waits in none.
  void wait_in(const RoundId& round, const PeerTable& peers);
  bool waits() const { return !std::holds_alternative<WaitsInNoRound>(wait); }
  /// The round that the robot waits in; null: none.
  const RoundId* awaited_round() const;

  const FleetClock& clock() const { return run_clock ? *run_clock : no_clock; }
  /// A scaled second (timing.h), in fleet time.
  double second() const { return std::max(1.0, clock().scale); }
  /// Seconds of fleet time.
  double since(WallTime at, double now) const { return now - clock().fleet_time(at); }

  /// Metres between the edges of the two robots.
  double gap(const Peer& p) const { return (p.place - position).norm() - mission->radius - p.radius; }
  /// The most at which the gap shrinks.
  double closing_speed(const Peer& p) const { return mission->max_speed + p.max_speed; }
  /// The most ticks between two states that the peer sends to this robot. The peer may think that this robot
  /// is closer, and send more often.
  int interval_from(const Peer& p) const {
    return waits() && hears_about_round_from(p) ? 1 : send_interval(gap(p), closing_speed(p));
  }
  /// The peer waits in the same round, and one of the two leads it.
  bool hears_about_round_from(const Peer& p) const;
  /// The stamp is later than the peer's clock can be, even if that was set by Timing::set_clock.
  bool is_from_the_future(double stamp, const Peer& p, double now) const;

 private:
  static constexpr FleetClock no_clock{};
};

}  // namespace coppice
