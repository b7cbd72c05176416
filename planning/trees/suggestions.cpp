#include "planning/trees/suggestions.h"

#include <algorithm>

namespace coppice {

namespace {

// The values were tried on mazes, rooms and dense obstacles with 10 and 50 robots (docs/performance.md).
// Epsilon is about four times the mean clearance of the positions where the robot fits. There are four trees
// for each square of side epsilon.
constexpr double mean_clearances = 4.4;
constexpr double trees_a_square = 4;
// On large maps with few robots, more trees would grow where no robot drives.
constexpr double least_trees = 16;
constexpr double most_trees = 800;
constexpr int samples_a_side = 20;  // of the map; enough for the mean to within some per cent

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
  // If the robot fits at no sample, free space is sparse and narrow. Then the step is in proportion to the
  // robot's own size.
  const double mean = count > 0 ? sum / count : radius / 2;
  return std::clamp(mean_clearances * mean, field.frame().resolution, extent.norm());
}

TreeParameters completed(TreeParameters parameters, const ClearanceField& field, double radius) {
  if (parameters.epsilon == 0) parameters.epsilon = suggested_epsilon(field, radius);
  if (parameters.disjointed_trees == 0) {
    const Box<2> box = field.bounds();
    const double squares = (box.upper - box.lower).prod() / (parameters.epsilon * parameters.epsilon);
    parameters.disjointed_trees =
        static_cast<std::uint32_t>(std::clamp(trees_a_square * squares, least_trees, most_trees));
  }
  return parameters;
}

}  // namespace coppice
