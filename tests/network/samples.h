// Messages in which each field has a value of its own, and a helper that receives from a bus.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

#include "dds/dds_bus.h"
#include "messages/messages.h"

namespace coppice {

/// All messages that arrive until `enough` returns true or the time is over.
template <class Enough>
std::vector<Message> receive(DdsBus& bus, Enough&& enough, double seconds = 10) {
  std::vector<Message> all;
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (!enough(all) && Clock::now() < end) {
    bus.wait(0.1);
    for (const Arrival& arrival : bus.take()) all.push_back(*arrival.message);
  }
  return all;
}

inline RobotState some_state(std::uint32_t sequence) {
  return {.robot = "r1",
          .sequence = sequence,
          .promise = {.stamp = 0.05 * sequence,
                      .position = {1.5, 2.5},
                      .velocity = {1, -1},
                      .decision_time = 0.05 * sequence + 0.05,
                      .next_velocity = {2, 2},
                      .expiry = 0.05 * sequence + 0.1},
          .radius = 5,
          .max_speed = 20,
          .max_acceleration = 40,
          .phase = Phase::driving,
          .round = {3, "r7", {4, 5}, 60},
          .stage = Stage::executing,
          .reservation = 7,
          .reservation_progress = 12.5,
          .waits_for = "r2",
          .copies = 3,
          .copy = 2,
          .passed_on = true,
          .counts_as_failed = true,
          .is_new = true,
          .wants_echo = true,
          .may_be_unknown = true,
          .misses = {"r4", "r5"},
          .echoes = {{"r2", 4.5, 4.625}, {"r3", 4.75, 4.5}}};
}

inline MapMessage some_map(int side) {
  MapMessage m{"some-map", {}, {5, 2.5}};
  m.map.width = side;
  m.map.height = side - 3;
  m.map.resolution = 0.5;
  m.map.origin = {-3, 4};
  m.map.y_axis = YAxis::up;
  for (int k = 0; k < side * (side - 3); ++k)
    m.map.blocked.push_back(static_cast<std::uint8_t>((k * 7 + k / 13) % 5 == 0));
  return m;
}

inline InactiveTreesMessage some_tree(std::uint32_t number, int nodes) {
  InactiveTreesMessage m{.id = {77, number}, .map_id = "some-map", .radius = 5, .nodes = {}};
  for (int i = 0; i < nodes; ++i)
    m.nodes.push_back({{i * 1.5, number * 2.0}, i == 0 ? -1 : (i - 1) / 2, 5.5 + i});
  if (number > 0) m.links.push_back({0, {77, number - 1}, 0});
  return m;
}

inline Mission some_mission() {
  return {.robot = "r1",
          .number = 3,
          .fleet_size = 4,
          .map_id = "some-map",
          .start = {1, 2},
          .goal = {3, 4},
          .radius = 5,
          .max_speed = 20,
          .max_acceleration = 40,
          .goal_tolerance = 1,
          .seed = 1ull << 40,
          .planner = PlannerKind::rrdt_star,
          .plan_budget = 0.25,
          .cancelled = true,
          .clock = {1.7e9 + 0.25, 10},
          .coordination = Coordination::rvo};
}

inline bool holds(const std::vector<Message>& all, const Message& wanted) {
  return std::ranges::count(all, wanted) > 0;
}

}  // namespace coppice
