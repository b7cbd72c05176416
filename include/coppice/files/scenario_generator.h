// Generates scenarios that test coordination: in them, robots that only avoid each other block each other.
//
// The same name, number of robots and seed give the same scenario. Robots have a radius of 5 m and a speed of
// 20 m/s unless the kind says otherwise. Metres.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"

namespace coppice {

/// A kind of scenario that make_scenario knows.
struct ScenarioKind {
  std::string name;
  int robots;  ///< default number of robots
  int most;    ///< largest number of robots
  std::string what;
  std::string former_name{};  ///< an older name that is still accepted; empty: none
};
const std::vector<ScenarioKind>& scenario_kinds();
/// Finds a kind by its name or its former name. Nothing for an unknown name.
std::optional<ScenarioKind> scenario_kind(const std::string& name);

/// Throws InputError for an unknown name, or if the scenario has no room for so many robots.
Scenario make_scenario(const std::string& name, int robots, std::uint32_t seed);

}  // namespace coppice
