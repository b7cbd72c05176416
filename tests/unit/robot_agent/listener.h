// A robot that hears its peers or not, and judges which of them have fallen silent.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "robot_agent/peers/fleet.h"
#include "tests/unit/robot_agent/states.h"

namespace coppice {

/// Robot "a", which may hear "b" and "c".
class Listener {
 public:
  explicit Listener(std::vector<RobotName> others = {"b", "c"}, const RobotName& self = "a")
      : field_(OccupancyMap{.width = 200, .height = 200, .blocked = std::vector<std::uint8_t>(40000, 0)}),
        fleet_(self) {
    others.push_back(self);
    for (const RobotName& robot : others) hear_mission(robot, {70, 70});
  }
  void hear_mission(const RobotName& robot, const Point2& start) {
    fleet_.hear(Mission{.robot = robot,
                        .start = start,
                        .goal = {30, 30},
                        .radius = 5,
                        .max_speed = 20,
                        .max_acceleration = 40,
                        .clock = {}},
                0);
  }
  void hear(const RobotName& robot, double stamp, std::vector<Echo> echoes = {},
            const Point2& velocity = Point2::Zero(), const Point2& position = {100, 100}) {
    RobotState state = state_of(robot, stamp, position, velocity);
    state.echoes = std::move(echoes);
    hear(state);
  }
  void hear(const RobotState& state) {
    fleet_.hear(std::make_shared<const RobotState>(state), state.promise.stamp + 0.001);
  }
  /// A peer relays a last state of `robot`. Returns false if it was not accepted.
  bool hear_passed_on(const RobotName& robot, double stamp, double now, const Point2& position) {
    RobotState state = state_of(robot, stamp, position);
    state.passed_on = true;
    return fleet_.hear(std::make_shared<const RobotState>(state), now);
  }
  /// By its leader's clock, which is known to go like that of "a".
  void hear(const JointPlanMessage& plan) { fleet_.learn_from(plan, 0); }
  void wake(double now) { fleet_.wake(now); }
  /// A robot that is neither heard nor failed; empty: none.
  RobotName unknown() const { return fleet_.unknown(); }
  double now() const { return now_; }
  std::size_t others() const { return fleet_.others().size(); }
  bool echoed(double now) const { return fleet_.echoed(now); }
  Point2 place(const RobotName& robot) const { return fleet_.find(robot)->position; }
  /// Runs until `end`. All robots except `heard` are silent.
  void go_on_until(double end, const std::vector<RobotName>& heard) {
    for (; now_ < end; now_ += period) {
      for (const RobotName& robot : heard) hear(robot, now_);
      judge(now_);
    }
  }
  void judge(double now) { fleet_.detect_failures(now, {80, 80}, {}, field_); }
  bool failed(const RobotName& robot) const { return fleet_.find(robot)->failed; }
  std::uint32_t recoveries() const { return fleet_.recoveries(); }
  bool is_suspected_near(const Point2& p) const { return fleet_.is_suspected_near(p, 0); }
  /// The distance around `robot` that is kept clear, in metres; 0 if none is.
  double kept_clear_around(const RobotName& robot, double now) {
    AgeCount ages;
    std::vector<Neighbour> near;
    fleet_.collect_neighbours({80, 80}, 100, 10, now, ages, near);
    double radius = 0;
    for (const Neighbour& n : near) {
      if ((n.promise.position - place(robot)).norm() < 1e-9) radius = std::max(radius, n.radius);
    }
    return radius;
  }
  std::vector<RobotName> peers_to_inform(double now) { return fleet_.news_for_those_back(now).hearers; }
  bool cut_off() const { return fleet_.cut_off(); }
  bool may_be_unknown() const { return fleet_.may_be_unknown(); }
  std::vector<Disc> failed_seen_from(const Point2& position, double now) const {
    return fleet_.zones_of_failed(position, now);
  }

 private:
  ClearanceField field_;
  Fleet fleet_;
  double now_ = 0;
};

}  // namespace coppice
