// Scenario files: JSON (idl/scenario.proto), and Moving AI `.scen`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "files/map_file.h"
#include "files/scenario.h"

namespace coppice {

/// What the command line says, over what the file says.
struct ScenarioOptions {
  std::optional<int> robots{};  ///< only the first so many
  std::optional<double> radius{};
  std::optional<double> max_speed{};
  std::optional<std::uint32_t> seed{};
  std::string map{};  ///< the map's file, relative to the working folder; empty: the one that the file names
  MapWarnings warnings = MapWarnings::logged;
};

/// Reads a scenario and its map, fills in defaults and checks everything that a run relies on. The robots of
/// a `.scen` stand at the centres of their cells and are called r1, r2, ... Throws InputError, which names
/// the file and the line or field, and what was expected.
Scenario read_scenario(const std::filesystem::path& path, const ScenarioOptions& options);

/// Writes a scenario as JSON; `map_name` is the map's path relative to the file.
void write_scenario(const std::filesystem::path& path, const Scenario& scenario);

}  // namespace coppice
