// Chained directed sampling: each direction follows from the last successful one.
//
// RRdT* (Lai, Ramos, Francis, "Balancing Global Exploration and Local-connectivity Exploitation with
// Rapidly-exploring Random disjointed-Trees", 2019) and its use in MA-RRdT*: the next direction is drawn from
// a von Mises-Fisher distribution around the last successful direction. A periodic kernel suppresses the
// density near failed directions until a direction succeeds. The first direction is uniform.
//
// Directions are unit vectors in R^D. The density is exp(kappa d.m) times the product of 1 - exp(-(1 - d.f) /
// width^2) over the failed directions f. Exact rejection sampling from the uniform direction works in every
// dimension; at kappa = 2 in the plane it accepts a third of the draws.
#pragma once

#include <cmath>
#include <cstddef>

#include "coppice/planning/geometry.h"
#include "coppice/planning/random.h"

namespace coppice {

/// A uniform direction on the unit sphere of R^D.
template <int D>
Point<D> random_direction(Random& random) {
  while (true) {
    Point<D> d;
    for (int i = 0; i < D; ++i) d[i] = random.uniform(-1, 1);
    const double squared = d.squaredNorm();
    if (squared <= 1 && squared > 1e-12) return d / std::sqrt(squared);
  }
}

/// A uniform point in a box.
template <int D>
Point<D> random_point(const Box<D>& box, Random& random) {
  Point<D> p;
  for (int d = 0; d < D; ++d) p[d] = random.uniform(box.lower[d], box.upper[d]);
  return p;
}

template <int D>
class DirectedSampler {
 public:
  static constexpr double kernel_width = 0.31415926535897931;  // pi / 10, of the suppression

  /// `kappa`: concentration of the von Mises-Fisher density; 0: uniform.
  Point<D> draw(Random& random, double kappa) const {
    // If every direction is suppressed, the last draw is used: it fails, and the weight of the tree falls.
    Point<D> d = random_direction<D>(random);
    for (int tries = 0; tries < max_tries && !accepted(d, random.uniform(), kappa); ++tries) {
      d = random_direction<D>(random);
    }
    return d;
  }

  void succeeded(const Point<D>& direction) {
    mean_ = direction;
    chained_ = true;
    failures_ = 0;
  }

  void failed(const Point<D>& direction) {
    failed_[failures_ % max_failures] = direction;  // replaces the oldest
    ++failures_;
  }

  /// Forgets the chain. The next direction is uniform again.
  void reset() {
    chained_ = false;
    failures_ = 0;
  }

 private:
  // Failed directions that are remembered: more than a tree's weight allows before it restarts.
  static constexpr std::size_t max_failures = 16;
  static constexpr int max_tries = 64;

  /// Whether a uniform number u in [0, 1) lies below the density at d. The loop ends at the first factor that
  /// brings the product below u. A kernel within 0.3 % of 1 counts as 1.
  bool accepted(const Point<D>& d, double u, double kappa) const {
    constexpr double far = 6;
    double a = chained_ ? std::exp(kappa * (d.dot(mean_) - 1)) : 1.0;
    const std::size_t n = failures_ < max_failures ? failures_ : max_failures;
    for (std::size_t i = 0; i < n && a > u; ++i) {
      const double x = (1 - d.dot(failed_[i])) / (kernel_width * kernel_width);
      if (x < far) a *= 1 - std::exp(-x);
    }
    return a > u;
  }

  Point<D> mean_ = Point<D>::Zero();
  bool chained_ = false;
  std::size_t failures_ = 0;
  Point<D> failed_[max_failures];
};

}  // namespace coppice
