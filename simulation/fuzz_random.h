// Sources of randomness of a fuzz case: one for each part of the case. So a part that draws differently
// leaves the others of the same seed as they are.
#pragma once

#include <cmath>
#include <cstdint>

#include "coppice/planning/random.h"

namespace coppice {

/// The parts of a case.
enum class FuzzPart : std::uint8_t { tasks, bodies, network, clocks, agents, restarts, drive, halts, run };

inline Random source_of(FuzzPart part, std::uint32_t seed) {
  return Random(std::uint64_t{seed} << 8 | static_cast<std::uint8_t>(part));
}

inline bool chance(double share, Random& random) {
  return random.uniform() < share;
}

/// As often between 1 and 2 as between 10 and 20. `lower` above 0.
inline double log_uniform(double lower, double upper, Random& random) {
  return lower * std::pow(upper / lower, random.uniform());
}

/// From `least` to `most`.
inline int whole_number(int least, int most, Random& random) {
  return least + static_cast<int>(random.index(static_cast<std::size_t>(most - least + 1)));
}

}  // namespace coppice
