// The fixture of all tests of an agent: the robot "a", whose agent is stepped whenever it asks to be.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/control/saved_state.h"
#include "robot_agent/process/robot_agent.h"
#include "tests/unit/planner_service/roles.h"
#include "tests/unit/robot_agent/states.h"

namespace coppice {

/// From the left of the map's wall to the right.
inline Mission mission_of_a(double epoch, const Point2& goal = {100, 60}) {
  return {.robot = "a",
          .number = 1,
          .map_id = "wall",
          .start = {20, 60},
          .goal = goal,
          .radius = 5,
          .max_speed = 20,
          .max_acceleration = 40,
          .goal_tolerance = 1,
          .plan_budget = 0.1,
          .clock = {epoch, 1}};
}

inline double next_step(const RobotAgent& agent, double now) {
  return std::max(now + 0.001, agent.next_wake());
}

/// Each step comes `late` seconds late. Returns what the agent sends.
inline std::vector<Message> run(RobotAgent& agent, double from, double until, double late = 0) {
  std::vector<Message> all;
  for (double now = from; now < until; now = next_step(agent, now) + late) {
    for (Message& message : messages(agent.step(now))) all.push_back(std::move(message));
  }
  return all;
}

/// A single agent with its journal.
struct AgentRun {
  AgentRun() = default;
  AgentRun(const AgentRun&) = delete;
  void restore(const std::vector<Message>& kept) {
    agent.restore(saved_state_of(kept));
    StateKeeper chooser("a");
    chooser.restore(kept);
    store.messages = kept;
    keeper = Keeper(std::move(chooser), &store);
  }
  void hear(const Message& message, double now) {
    keeper.heard(message);
    agent.on(arrival_of(message, now));
  }
  /// Runs the agent. A second robot that stands at its start is heard until `b_dies`.
  void run(double from, double until, double b_dies = 0) {
    for (double now = from; now < until; now = next_step(agent, now)) {
      if (now < b_dies) hear(standing_b(now), now);
      for (Outgoing& one : agent.step(now)) {
        keeper.said(one.message);
        said.push_back(std::move(one.message));
      }
    }
  }
  RobotState standing_b(double now) const {
    RobotState state = state_of("b", now, {20, 20});
    state.sequence = static_cast<std::uint32_t>(now / 0.05);
    if (!said.empty()) state.echoes.push_back({"a", now, now});
    return state;
  }
  RobotAgent agent{"a"};
  KeptInMemory store{};
  Keeper<StateKeeper, KeptInMemory> keeper{StateKeeper("a"), &store};
  std::vector<Message> said{};
};

/// Runs the agent of a driving robot and stops at `time`.
inline void run_until_killed_at(double time, AgentRun& before) {
  before.hear(map_message(), 0);
  before.hear(mission_of_a(0), 0);
  before.run(0, time);
}

/// The whole track. Its batches have to follow each other.
inline std::vector<TrackMessage::Point> track_in(const std::vector<Message>& said) {
  std::vector<TrackMessage::Point> track;
  for (const TrackMessage& batch : of<TrackMessage>(said)) {
    EXPECT_EQ(batch.first_index, track.size());
    track.insert(track.end(), batch.points.begin(), batch.points.end());
  }
  return track;
}

}  // namespace coppice
