// Whether a robot is in contact with its fleet. Only a connected robot drives: the others may have declared a
// robot failed that they do not hear, and may have driven where the robot does not know.
//
// Times are fleet time, seconds.
#pragma once

#include <optional>
#include <variant>

namespace coppice {

class Connectivity {
 public:
  struct Connected {};
  /// The robot was out of contact. It stands until `until`, and hears meanwhile what it missed.
  struct Settling {
    double until;
  };
  /// The robot misses peers, or no peer hears the robot.
  struct CutOff {
    double until;                                ///< Settling lasts until then, once contact is back
    std::optional<double> peer_unheard_since{};  ///< others hear a peer that this robot does not hear
  };
  /// The robot gave up because it never heard a peer that others hear.
  struct Isolated {
    double until;
    double peer_unheard_since;
  };
  /// The process began in mid-run. It does not know yet where all peers are.
  struct Joining {
    double until;
  };

  /// The robot stands until `until`, at least.
  void stand_until(double until);
  void join(double until) { state_ = Joining{until}; }
  /// Once in each control step. `until`: when a robot that is cut off now may drive at the earliest.
  void observe(bool cut_off, double now, double until);

  bool joining() const { return std::holds_alternative<Joining>(state_); }
  /// Ends joining when its time is over. Returns whether the robot still joins.
  bool still_joining(double now);

  bool isolated() const { return std::holds_alternative<Isolated>(state_); }
  /// A peer is heard by others only. Returns since when, fleet time.
  double peer_is_unheard(double now);
  /// There is no such peer any more. Returns whether the robot was isolated.
  bool peers_are_heard();
  void isolate();

  /// The robot has to stand and listen.
  bool listens(double now) const;

 private:
  std::variant<Connected, Settling, CutOff, Isolated, Joining> state_;
};

}  // namespace coppice
