// A random order, each equally likely (Knuth, "The Art of Computer Programming", vol. 2, 3.4.2, algorithm P).
// Not std::shuffle, whose choices differ between libraries: a seed must give the same bytes everywhere.
#pragma once

#include <cstddef>
#include <ranges>
#include <utility>

#include "planning/random.h"

namespace coppice {

template <std::ranges::random_access_range Range>
void shuffle(Range& range, Random& random) {
  for (std::size_t k = std::ranges::size(range); k > 1; --k) std::swap(range[k - 1], range[random.index(k)]);
}

}  // namespace coppice
