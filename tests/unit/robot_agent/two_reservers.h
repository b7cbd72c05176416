// Two robots that reserve trajectories and hear of each other what a test hands over. Metres, seconds.
#pragma once

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/agreement/reserver.h"
#include "robot_agent/timing.h"
#include "tests/unit/motion/plans.h"
#include "tests/unit/robot_agent/states.h"

namespace coppice {

class TwoReservers : public testing::Test {
 protected:
  static constexpr Limits limits{20, 40};
  static constexpr double open = std::numeric_limits<double>::infinity();
  static constexpr double present = 1;  ///< of a decision, where only ages count

  /// Robots a and b, of which each knows the other by what the test hands over. a has the longer way.
  struct Robot {
    Robot(RobotName name, Path way, MapRoadmaps& map)
        : path(std::move(way)), roadmaps(map), fleet(name), reserver(name, {}, others) {
      self = {.robot = name,
              .position = path.front(),
              .radius = 5,
              .stands = true,
              .round = {},
              .waits_for = {},
              .limits = limits};
      for (const char* robot : {"a", "b"})
        fleet.hear(Mission{.robot = robot,
                           .start = path.front(),
                           .goal = path.back(),
                           .radius = 5,
                           .max_speed = limits.max_speed,
                           .max_acceleration = limits.max_acceleration,
                           .clock = {}},
                   0);
    }
    void want(double now) { reserver.want(path, self, roadmaps.field(), now, said); }
    void plan(double now) { reserver.plan(path, now, self, limits, fleet, roadmaps, now, said); }
    void adopt(const JointPlanMessage& plan, double now) {
      self.round = plan.round;
      reserver.adopt(plan, self, fleet, now, said);
    }
    void drop(double now) { reserver.drop(self, fleet, now, said); }
    bool is_overridden() {
      reserver.held().look_at_others(fleet);
      return reserver.held().is_overridden();
    }
    void look() { reserver.held().look_at_gates(fleet, 0, open); }
    RobotState state(double now) {
      RobotState state = state_of(self.robot, now, self.position);
      state.phase = Phase::driving;
      state.reservation = reserver.number();
      state.knows = reserver.knows(std::vector<RobotName>{self.robot == "a" ? "b" : "a"});
      return state;
    }
    const ReservationMessage& last() const { return std::get<ReservationMessage>(said.back().message); }

    Path path;
    MapRoadmaps& roadmaps;
    Fleet fleet;
    Reservations others;
    Reserver reserver;
    FleetMember self;
    std::vector<Outgoing> said;
  };

  static void tell(Robot& to, const Robot& from) {
    to.others.hear(std::make_shared<const ReservationMessage>(from.last()));
  }
  static RobotState tell_state(Robot& to, Robot& from, double now) {
    RobotState state = from.state(now);
    state.echoes = {{to.self.robot, now - 0.001, now}};  // so that the clocks are known
    to.fleet.hear(std::make_shared<const RobotState>(state), now + 0.001);
    to.reserver.hear(state);
    return state;
  }
  /// Both hold reservations; b planned around a.
  void reserve_both() {
    for (Robot* robot : {&a, &b}) robot->want(0);
    tell(b, a);
    tell(a, b);
    tell_state(a, b, 0);
    tell_state(b, a, 0);
    a.plan(0.1);
    tell(b, a);
    b.plan(0.2);
    tell(a, b);
  }

  /// Each knows the other's reservation, and a knows that b does: returns that state of b.
  RobotState look_at_each_other() {
    tell(a, b);
    tell(b, a);
    a.look();
    b.look();
    tell_state(b, a, 0.6);
    return tell_state(a, b, 0.7);
  }

  /// The speed that a wants at the point (x, 100) of its way.
  double speed_of_a_at(double x) {
    Point2 v = Point2::Zero();
    for (double at = 20; at < x + 0.01; at += 0.02) {
      a.reserver.come_to(Driver({at, 100}, 0.6, 5, limits, control_period));
      HeldReservation& held = a.reserver.held();
      held.look_at_gates(a.fleet, 0.6, open);
      v = held.preferred_velocity({at, 100}, limits);
    }
    return v.norm();
  }

  ClearanceField field{test::open_map(200, 200)};
  MapRoadmaps roadmaps{field};
  Robot a{"a", {{20, 100}, {180, 100}}, roadmaps};
  Robot b{"b", {{100, 6}, {100, 190}}, roadmaps};  ///< b passes second
};

}  // namespace coppice
