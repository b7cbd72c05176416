// Measures the gain from sharing over DDS: fleets of processes with trees that the broker grows ahead, with
// trees that grow together with the root trees, and with each robot alone.
#pragma once

#include <string>

#include "bench/experiments.h"

namespace coppice {

/// Writes sharing.csv, sharing.md and sharing.svg. `program` is the coppice executable.
void bench_sharing(const ExperimentOptions& options, const std::string& program);

}  // namespace coppice
