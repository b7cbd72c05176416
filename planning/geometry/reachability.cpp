#include "planning/geometry/reachability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace coppice {

namespace {

/// Steps to lattice points other than the neighbours along the axes. The other steps are rotations of these.
constexpr std::array<std::pair<int, int>, 7> jumps{{{1, 1}, {1, 2}, {2, 1}, {1, 3}, {3, 1}, {2, 3}, {3, 2}}};
// Cells beyond the radius. Where the clearance exceeds that, all points to which a jump leads are connected
// through neighbours along the axes.
constexpr double least_room_without_jumps = 2.6;

bool is_centre(std::uint32_t point, std::uint32_t columns) {
  return point % columns % 2 == 1 && point / columns % 2 == 1;
}

}  // namespace

ReachablePart::ReachablePart(const ClearanceField& field, double radius) : field_(&field), radius_(radius) {
  reached_.assign(std::size_t{columns()} * rows(), false);
}

ReachablePart ReachablePart::around(const ClearanceField& field, double radius, const Point2& from) {
  ReachablePart part(field, radius);
  std::vector<std::uint32_t> seeds;
  part.for_each_joined(from, [&](std::uint32_t point) { seeds.push_back(point); });
  part.flood(std::move(seeds));
  part.list_places();
  return part;
}

ReachablePart ReachablePart::largest(const ClearanceField& field, double radius) {
  ReachablePart all(field, radius);
  std::size_t most = 0;
  std::size_t parts = 0;
  std::vector<std::uint32_t> seed;
  for (std::size_t k = 0; k < all.reached_.size(); ++k) {
    const auto point = static_cast<std::uint32_t>(k);
    if (all.reached_[k] || !all.fits(point)) continue;
    const std::size_t places = all.flood({point});
    if (places > most) seed = {point};
    most = std::max(most, places);
    ++parts;
  }
  if (parts == 1) {
    all.list_places();
    return all;
  }
  ReachablePart part(field, radius);
  part.flood(std::move(seed));
  part.list_places();
  return part;
}

Point2 ReachablePart::at(std::uint32_t point) const {
  const GridFrame& frame = field_->frame();
  const Point2 half_cells(point % columns(), point / columns());
  return frame.origin + frame.resolution * (half_cells / 2);
}

/// Calls fn(point) for the lattice points around p that the disc can reach from p in a straight line.
template <class Fn>
void ReachablePart::for_each_joined(const Point2& p, Fn&& fn) const {
  if (!field_->is_free(p, radius_)) return;
  const Point2 half_cells = 2 * (p - field_->frame().origin) / field_->frame().resolution;
  const auto first = [](double at) { return static_cast<std::uint32_t>(std::max(0.0, std::floor(at) - 1)); };
  for (std::uint32_t j = first(half_cells.y()); j <= half_cells.y() + 2 && j < rows(); ++j) {
    for (std::uint32_t i = first(half_cells.x()); i <= half_cells.x() + 2 && i < columns(); ++i) {
      const std::uint32_t point = j * columns() + i;
      if (field_->segment_free(p, at(point), radius_)) fn(point);
    }
  }
}

bool ReachablePart::contains(const Point2& p) const {
  bool joined = false;
  for_each_joined(p, [&](std::uint32_t point) { joined = joined || reached_[point]; });
  return joined;
}

/// Reaches all points that can be reached from these. Returns the number of new positions.
std::size_t ReachablePart::flood(std::vector<std::uint32_t> frontier) {
  std::size_t points = 0;
  std::size_t centres = 0;
  for (const std::uint32_t point : frontier) reached_[point] = true;
  std::vector<std::uint32_t> near_obstacles;
  while (!frontier.empty()) {
    while (!frontier.empty()) {
      points += frontier.size();
      centres += static_cast<std::size_t>(
          std::ranges::count_if(frontier, [&](std::uint32_t point) { return is_centre(point, columns()); }));
      spread(frontier, near_obstacles);
    }
    // Jumps come last, because most of the points to which they lead are reached without them.
    for (const std::uint32_t point : std::exchange(near_obstacles, {})) jump(point, frontier);
  }
  return centres > 0 ? centres : points;
}

/// Extends the frontier to its neighbours along the axes, which become the next frontier. The outermost
/// lattice points lie on the border of the map, where no disc fits, so no point of the frontier lacks a
/// neighbour.
void ReachablePart::spread(std::vector<std::uint32_t>& frontier, std::vector<std::uint32_t>& near_obstacles) {
  const double room = radius_ + least_room_without_jumps * field_->frame().resolution;
  std::vector<std::uint32_t> next;
  for (const std::uint32_t here : frontier) {
    if (field_->lower_bound(at(here)) < room) near_obstacles.push_back(here);
    for (const std::uint32_t there : {here - 1, here + 1, here - columns(), here + columns()}) {
      if (reached_[there] || !fits(there)) continue;
      reached_[there] = true;
      next.push_back(there);
    }
  }
  frontier = std::move(next);
}

void ReachablePart::jump(std::uint32_t from, std::vector<std::uint32_t>& frontier) {
  const auto i = static_cast<std::int64_t>(from % columns());
  const auto j = static_cast<std::int64_t>(from / columns());
  for (const auto& [right, up] : jumps) {
    for (const auto& [u, v] :
         {std::pair{i + right, j + up}, {i - right, j + up}, {i + right, j - up}, {i - right, j - up}}) {
      if (u < 0 || v < 0 || u >= columns() || v >= rows()) continue;
      const auto there = static_cast<std::uint32_t>(v * columns() + u);
      if (reached_[there] || !fits(there) || !field_->segment_free(at(from), at(there), radius_)) continue;
      reached_[there] = true;
      frontier.push_back(there);
    }
  }
}

void ReachablePart::list_places() {
  std::vector<std::uint32_t> others;
  for (std::size_t k = 0; k < reached_.size(); ++k) {
    if (!reached_[k]) continue;
    const auto point = static_cast<std::uint32_t>(k);
    if (is_centre(point, columns())) {
      places_.push_back(point);
    } else if (places_.empty()) {
      others.push_back(point);
    }
  }
  if (places_.empty()) places_ = std::move(others);
  if (places_.empty()) return;
  box_ = {at(places_[0]), at(places_[0])};
  for (const std::uint32_t point : places_) box_ = extended(box_, at(point));
}

}  // namespace coppice
