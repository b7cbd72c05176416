#include "bench/experiments.h"

#include <exception>

#include <fmt/format.h>

namespace coppice {

bool succeeds(const ExperimentOptions& options, const std::string& map, int robots,
              const std::function<void()>& trial) {
  try {
    trial();
    return true;
  } catch (const std::exception& problem) {
    options.fail(fmt::format("{}, {} robots: {}", map, robots, problem.what()));
    return false;
  }
}

}  // namespace coppice
