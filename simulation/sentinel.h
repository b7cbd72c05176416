// Sees all agents of a simulated fleet, and checks at each decision what the lemmas of docs/safety.md say. A
// broken lemma shows long before bodies touch, and also where they happen not to.
//
// L1   A robot goes on as its last state promises, until the promise expires.
// L3   The offset between two clocks lies within the bound that an agent has.
// L6   The line of a decision keeps clear of obstacles and of the lines of all others. If nobody decided
//      anything more, each body would stay on its line: so by the theorem no two of these lines meet.
// L14  A robot is where it says that it is on its way. Whoever leaves another robot out of its decisions,
//      because of the order of reservations, finds it in its strip until the end of its own line.
//
// The first lemma that is broken is kept.
//
// Metres in the map frame; seconds of true time, counted from the beginning of the simulation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/planning/clearance_field.h"
#include "messages/clock_offset.h"
#include "messages/messages.h"
#include "messages/name_index.h"
#include "motion/body/driver.h"
#include "simulation/committed_line.h"
#include "simulation/fault_schedule.h"
#include "simulation/reserved_strip.h"

namespace coppice {

/// An agent just after one of its steps.
struct SeenAgent {
  const Driver& body;
  AgentClock clock;  ///< of the body's times
  RunId run;
  /// The reservations because of which the last decision left their robots out.
  std::span<const ReservationId> left_out;
  const ClearanceField& field;
};

class Sentinel {
 public:
  /// The robots stand at their starts.
  explicit Sentinel(const Scenario& scenario);

  /// An agent has said this, in the step after which look() is called.
  void hear(const Message& message, double now);
  /// Checks what an agent has decided. False: nothing since the last call. `robot`: its place in the
  /// scenario.
  bool look(std::size_t robot, const SeenAgent& agent, double now);
  /// Checks what an agent believes of the clock of another one, after look().
  void check_clock(std::size_t robot, std::size_t peer, const ClockOffset& believed, double now);

  /// The first broken lemma, with its number, the robots and the time; none: all hold.
  const std::optional<std::string>& broken() const { return broken_; }
  std::size_t decisions() const { return decisions_; }

 private:
  struct Reliance {
    std::size_t on = 0;        ///< the other robot
    std::uint32_t number = 0;  ///< of its reservation
    double until = 0;
  };
  struct Robot {
    std::string name;
    double radius = 0;
    double max_speed = 0;
    std::optional<Driver> body{};  ///< as of its last decision; none: it has not decided anything yet
    AgentClock clock{};
    RunId run;
    CommittedLine line{};
    std::uint64_t lines = 0;              ///< that it has decided on so far
    std::optional<Promise> promise{};     ///< of its last state
    std::uint32_t reservation = 0;        ///< of its last state
    std::vector<ReservedStrip> strips{};  ///< the last one is the newest
    std::vector<Reliance> relies{};       ///< of its line, and until its turn of the line before

    void begin(const RunId& next);
    ReservedStrip* strip(std::uint32_t number);  ///< null: there is none
  };
  /// The smallest box in which a body stays, with its disc: left, bottom, right, top.
  using Room = std::array<double, 4>;

  void hear_state(const RobotState& state, double now);
  void hear_reservation(const ReservationMessage& reservation, double now);
  void check_promise(const Robot& robot, const RobotState& state, double now);
  void check_progress(const Robot& robot, const ReservedStrip& strip, const RobotState& state, double now);
  void check_obstacles(const Robot& robot, const ClearanceField& field, double now);
  void check_others(std::size_t number, double now);
  void check_strips(std::size_t number, double now);
  void rely(Robot& robot, std::span<const ReservationId> left_out, double now);
  static bool keeps_to(const Robot& robot, ReservedStrip& strip, double now);
  static bool could_meet(const Robot& robot, const Robot& other, double until, double now);
  void breaks(std::string what);

  std::vector<Robot> robots_{};
  std::vector<Room> rooms_{};  ///< by robot: each decision looks at all of them
  NameIndex names_;
  std::size_t decisions_ = 0;
  std::optional<std::string> broken_{};
};

}  // namespace coppice
