// Scenarios that try a fleet's coordination: what blocks robots that only avoid each other.
//
// The same name, number of robots and seed give the same scenario. Discs of 5 m at 20 m/s unless the kind
// says otherwise; metres.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "files/scenario.h"

namespace coppice {

/// What make_scenario knows.
struct ScenarioKind {
  std::string name;
  int robots;  ///< that it is meant for first
  int most;    ///< robots that there is room for
  std::string what;
  std::string former_name{};  ///< that it is known by, too; empty: none
};
const std::vector<ScenarioKind>& scenario_kinds();
/// By its name or its former name; nothing for an unknown one.
std::optional<ScenarioKind> scenario_kind(const std::string& name);

/// Throws InputError for an unknown name or where there is no room for so many robots.
Scenario make_scenario(const std::string& name, int robots, std::uint32_t seed);

}  // namespace coppice
