// Points, boxes and polygonal paths.
//
// Units: metres in the map frame. Shapes: a point is a column vector of D doubles; the plane is D = 2.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace coppice {

template <int D>
using Point = Eigen::Matrix<double, D, 1>;

using Point2 = Point<2>;

/// A polygonal chain from its first to its last point. A path that leads somewhere has at least two points.
template <int D>
using PathOf = std::vector<Point<D>>;

using Path = PathOf<2>;

/// An axis-aligned box, both corners included.
template <int D>
struct Box {
  Point<D> lower;
  Point<D> upper;
};

/// The smallest box around a box and a point.
template <int D>
Box<D> extended(const Box<D>& box, const Point<D>& p) {
  return {box.lower.cwiseMin(p), box.upper.cwiseMax(p)};
}

/// The distance between the nearest points of two boxes, metres; 0 if they overlap.
template <int D>
double distance(const Box<D>& a, const Box<D>& b) {
  return (a.lower - b.upper).cwiseMax(b.lower - a.upper).cwiseMax(0.0).norm();
}

/// The z component of the cross product: positive if b lies to the left of a.
inline double cross(const Point2& a, const Point2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The sum of the lengths of the segments, metres; 0 for fewer than two points.
template <int D>
double length_of(const std::vector<Point<D>>& path) {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

}  // namespace coppice
