#include "simulation/reserved_strip.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "motion/trajectory/segments.h"
#include "motion/trajectory/space_time.h"

namespace coppice {

namespace {

constexpr double beside_by_rounding = 1e-5;  // metres; agents allow for 1e-6, and positions add up over a run

/// Looks first at the edge beside which the point before was, `edge`.
bool is_beside(const Polyline& way, const Point2& p, double stray, std::size_t& edge) {
  const std::size_t edges = way.points.size() - 1;
  if (edges == 0) return (way.points.front() - p).norm() <= stray;
  for (std::size_t k = 0; k < edges; ++k) {
    const std::size_t at = (edge + k) % edges;
    if (point_segment_distance(p, way.points[at], way.points[at + 1]) > stray) continue;
    edge = at;
    return true;
  }
  return false;
}

}  // namespace

ReservedStrip::ReservedStrip(const ReservationMessage& reservation)
    : number(reservation.number),
      way(path_of(reservation.trajectory)),
      stray(reserved_stray_radii * reservation.radius + beside_by_rounding),
      replaced_at(std::numeric_limits<double>::infinity()) {}

bool stays_in(const ReservedStrip& strip, const CommittedLine& line, double from) {
  std::size_t edge = 0;
  double time = from;
  do {
    if (!is_beside(strip.way, line.at(time), strip.stray, edge)) return false;
    time = line.next_point_after(time);
  } while (time < std::numeric_limits<double>::infinity());
  return true;
}

}  // namespace coppice
