// How a fleet of processes grows: `coppice run` with more and more robots at the same density.
#pragma once

#include <optional>
#include <string>

#include "bench/experiments.h"

namespace coppice {

struct ScaleSettings {
  std::optional<double>
      time_scale{};           ///< fleet seconds a wall second; none: as many robots as there are allow
  double fleet_seconds = 30;  ///< of each run, in which every robot that arrives gets a new goal
  std::string discovery{};    ///< as for DdsSettings
  std::string security{};     ///< the same
  std::string report{};       ///< JSON; empty: none
};

/// Writes scale.csv, scale.md and scale.svg, anew after each fleet. `program` is the coppice executable.
/// False: robots touched something, or not all agents found each other. Throws InputError for maps' files:
/// these have sizes of their own.
bool bench_scale(const ExperimentOptions& options, const ScaleSettings& settings, const std::string& program);

}  // namespace coppice
