// Helpers of the tests of agent, broker and service: a small map, two robots, and messages by kind.
#pragma once

#include <utility>
#include <vector>

#include "messages/messages.h"
#include "planner_service/run/planner_service.h"

namespace coppice {

template <class M>
std::vector<M> of(const std::vector<Message>& messages) {
  std::vector<M> result;
  for (const Message& message : messages) {
    if (const M* m = std::get_if<M>(&message)) result.push_back(*m);
  }
  return result;
}

inline OccupancyMap wall_with_door() {
  OccupancyMap map{.width = 120, .height = 80, .blocked = std::vector<std::uint8_t>(9600, 0)};
  for (int j = 0; j < 80; ++j) {
    for (int i = 58; i < 62; ++i) map.blocked[static_cast<std::size_t>(j * 120 + i)] = j < 5 || j > 25;
  }
  return map;
}

inline MapMessage map_message() {
  return {"wall", wall_with_door(), {5}};
}

inline Scenario two_robots() {
  Scenario scenario;
  scenario.map_name = "wall";
  scenario.map = wall_with_door();
  scenario.robots = {{"a", {20, 60}, {100, 60}, 5, 20, 40, 1}, {"b", {20, 20}, {20, 40}, 5, 20, 40, 1}};
  return scenario;
}

inline std::vector<Message> messages(std::vector<Outgoing> outgoing) {
  std::vector<Message> all;
  for (Outgoing& one : outgoing) all.push_back(std::move(one.message));
  return all;
}

/// What a service sends when the trees of a broker cover the map at once.
inline std::vector<Message> map_and_missions(PlannerService& service) {
  std::vector<Message> all = service.step(0);
  service.on(arrival_of(BrokerStatus{.broker = 1, .covered_map = of<MapMessage>(all).at(0).map_id}, 0));
  for (const char* robot : {"a", "b"}) service.on(arrival_of(AgentStatus{.robot = robot}, 0));
  for (Message& message : service.step(0)) all.push_back(std::move(message));
  return all;
}

}  // namespace coppice
