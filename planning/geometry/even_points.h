// Points that cover a box evenly in sequence. New trees start at them.
//
// An additive recurrence with the generalised golden ratio (Roberts, "The Unreasonable Effectiveness of
// Quasirandom Sequences", 2018), from a random first point. The sequence is dense in the box, so each region
// gets a point in the end. Even points for roadmaps: Branicky, LaValle, Olson, Yang, "Quasi-Randomized Path
// Planning", 2001.
#pragma once

#include <cmath>

#include "coppice/planning/geometry.h"
#include "coppice/planning/random.h"

namespace coppice {

template <int D>
class EvenPoints {
 public:
  EvenPoints(const Box<D>& box, Random& random) : box_(box) {
    // The root above 1 of x^(D+1) = x + 1, by fixed-point iteration.
    double ratio = 2;
    for (int i = 0; i < 32; ++i) ratio = std::pow(1 + ratio, 1.0 / (D + 1));
    for (int d = 0; d < D; ++d) {
      step_[d] = std::pow(ratio, -(d + 1));
      share_[d] = random.uniform();
    }
  }

  Point<D> next() {
    Point<D> p;
    for (int d = 0; d < D; ++d) {
      share_[d] += step_[d];
      if (share_[d] >= 1) share_[d] -= 1;
      p[d] = box_.lower[d] + share_[d] * (box_.upper[d] - box_.lower[d]);
    }
    return p;
  }

 private:
  Box<D> box_;
  Point<D> step_;
  Point<D> share_;  ///< in [0, 1)
};

}  // namespace coppice
