#include <algorithm>
#include <string>

#include <boost/geometry/algorithms/correct.hpp>
#include <boost/geometry/algorithms/is_valid.hpp>
#include <boost/geometry/algorithms/within.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "coppice/files/scenario.h"
#include "planning/quantities.h"

namespace coppice {

namespace geometry = boost::geometry;

double radius_of_footprint(const std::vector<Point2>& footprint, const std::string& field) {
  const auto fail = [&](const std::string& problem) {
    throw InputError(fmt::format("{}: {}", field, problem));
  };
  if (footprint.size() < 3 || footprint.size() > most_corners)
    fail(fmt::format("has {} corners, expected 3 to {}", footprint.size(), most_corners));
  using Corner = geometry::model::d2::point_xy<double>;
  geometry::model::polygon<Corner> polygon;
  double radius = 0;
  for (const Point2& corner : footprint) {
    if (!is_sane(corner.x()) || !is_sane(corner.y())) fail("a corner is out of range, expected metres");
    geometry::append(polygon, Corner(corner.x(), corner.y()));
    radius = std::max(radius, corner.norm());
  }
  geometry::correct(polygon);
  std::string reason;
  if (!geometry::is_valid(polygon, reason))
    fail("is no polygon, expected one that does not cross or touch itself");
  if (!geometry::within(Corner(0, 0), polygon))
    fail("does not hold (0, 0), the point about which the robot turns");
  return radius;
}

}  // namespace coppice
