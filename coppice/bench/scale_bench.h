// How a fleet of processes scales: `coppice run` with a growing number of robots at the same density.
#pragma once

#include <optional>
#include <string>

#include "bench/experiments.h"

namespace coppice {

struct ScaleSettings {
  std::optional<double> time_scale{};  ///< fleet seconds per wall second; none: by the number of robots
  double fleet_seconds = 30;           ///< of each run; a robot that arrives gets a new goal
  std::string discovery{};             ///< as in DdsSettings
  std::string security{};              ///< as in DdsSettings
  std::string report{};                ///< JSON; empty: none
};

/// Writes scale.csv, scale.md and scale.svg again after each fleet. `program` is the coppice executable.
/// Returns false if robots collided or not all agents found each other. Throws InputError for map files,
/// because they have fixed sizes.
bool bench_scale(const ExperimentOptions& options, const ScaleSettings& settings, const std::string& program);

}  // namespace coppice
