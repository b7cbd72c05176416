// Shuffles a range; all orders are equally likely (Knuth, "The Art of Computer Programming", vol. 2, 3.4.2,
// algorithm P). std::shuffle is not used because its choices differ between libraries, and a seed must give
// the same bytes everywhere.
#pragma once

#include <cstddef>
#include <ranges>
#include <utility>

#include "coppice/planning/random.h"

namespace coppice {

template <std::ranges::random_access_range Range>
void shuffle(Range& range, Random& random) {
  for (std::size_t k = std::ranges::size(range); k > 1; --k) std::swap(range[k - 1], range[random.index(k)]);
}

}  // namespace coppice
