#include "planning/step_length.h"

#include <algorithm>
#include <cmath>

namespace coppice {

namespace {

// Best of 12, 20, 30, 40 and 60 m on six maps (mazes, rooms, dense obstacles; bench/): about four times the
// mean clearance of the places where the robot fits.
constexpr double mean_clearances = 4;
constexpr int samples_a_side = 20;  // of the map; enough for a mean to some per cent

}  // namespace

double suggested_epsilon(const ClearanceField& field, double radius) {
  const Box<2> box = field.bounds();
  const Point2 extent = box.upper - box.lower;
  double sum = 0;
  int count = 0;
  for (int j = 0; j < samples_a_side; ++j) {
    for (int i = 0; i < samples_a_side; ++i) {
      const Point2 share((i + 0.5) / samples_a_side, (j + 0.5) / samples_a_side);
      const double clearance = field.lower_bound(box.lower + extent.cwiseProduct(share));
      if (clearance < radius) continue;
      sum += clearance;
      ++count;
    }
  }
  // Where no sample fits, free space is sparse and narrow: a step of the robot's own size.
  const double mean = count > 0 ? sum / count : radius / 2;
  return std::clamp(mean_clearances * mean, field.map().resolution, extent.norm());
}

}  // namespace coppice
