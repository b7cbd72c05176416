#include "motion/space_time.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace coppice {

namespace {

constexpr double cell_radii = 4;  // radii to a side of a cell
constexpr double rounding = 1e-9;

double cross(const Point2& a, const Point2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The x for which |a + x b| < near, within `bounds`.
std::optional<Interval> within(const Point2& a, const Point2& b, double near, const Interval& bounds) {
  if (bounds.end < bounds.begin) return std::nullopt;
  const double bb = b.squaredNorm();
  const double rest = a.squaredNorm() - near * near;
  if (bb == 0) return rest < 0 ? std::optional(bounds) : std::nullopt;
  const double ab = a.dot(b);
  const double root = ab * ab - bb * rest;
  if (root <= 0) return std::nullopt;
  const double half = std::sqrt(root) / bb;
  const Interval both{std::max(bounds.begin, -ab / bb - half), std::min(bounds.end, -ab / bb + half)};
  return both.begin < both.end ? std::optional(both) : std::nullopt;
}

/// The smallest interval around all that are given.
class Hull {
 public:
  void include(double t) {
    begin_ = std::min(begin_, t);
    end_ = std::max(end_, t);
  }
  std::optional<Interval> get() const {
    return begin_ < end_ ? std::optional(Interval{begin_, end_}) : std::nullopt;
  }

 private:
  double begin_ = std::numeric_limits<double>::infinity();
  double end_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

void unite(std::vector<Interval>& intervals) {
  std::ranges::sort(intervals, {}, &Interval::begin);
  std::size_t count = 0;
  for (const Interval& i : intervals) {
    if (count > 0 && i.begin <= intervals[count - 1].end) {
      intervals[count - 1].end = std::max(intervals[count - 1].end, i.end);
    } else {
      intervals[count++] = i;
    }
  }
  intervals.resize(count);
}

SpaceTime::SpaceTime(const Box<2>& bounds, double radius)
    : radius_(radius), cell_(cell_radii * radius), lower_(bounds.lower) {
  const Point2 extent = bounds.upper - bounds.lower;
  constexpr double most_cells = 1 << 20;
  cell_ = std::max(cell_, std::sqrt(extent.prod() / most_cells));
  columns_ = static_cast<std::size_t>(extent.x() / cell_) + 1;
  rows_ = static_cast<std::size_t>(extent.y() / cell_) + 1;
  cells_.resize(columns_ * rows_);
}

std::size_t SpaceTime::column(double x) const {
  return static_cast<std::size_t>(
      std::clamp((x - lower_.x()) / cell_, 0.0, static_cast<double>(columns_ - 1)));
}
std::size_t SpaceTime::row(double y) const {
  return static_cast<std::size_t>(std::clamp((y - lower_.y()) / cell_, 0.0, static_cast<double>(rows_ - 1)));
}

void SpaceTime::add_standing(const Point2& p, double radius, double until) {
  add({{-forever, p}}, kept_apart(radius_, radius), until);
}

void SpaceTime::add_obstacle(const Disc& disc) {
  add({{-forever, disc.centre}}, radius_ + disc.radius + standing_gap, forever);
}

void SpaceTime::add(const Trajectory& trajectory, double near, double until) {
  for (std::size_t k = 1; k < trajectory.size(); ++k) {
    const Point2 way = trajectory[k].position - trajectory[k - 1].position;
    const double duration = trajectory[k].time - trajectory[k - 1].time;
    const double parts = std::max(1.0, std::ceil(way.norm() / cell_));
    const Point2 velocity = duration > 0 ? Point2(way / duration) : Point2::Zero();
    for (double part = 0; part < parts; ++part) {
      add_piece({trajectory[k - 1].position + way * (part / parts), velocity,
                 trajectory[k - 1].time + duration * part / parts,
                 trajectory[k - 1].time + duration * (part + 1) / parts, near});
    }
  }
  if (trajectory.front().time > -forever)
    add_piece({trajectory.front().position, Point2::Zero(), -forever, trajectory.front().time, near});
  add_piece({trajectory.back().position, Point2::Zero(), trajectory.back().time, until, near});
}

void SpaceTime::add_piece(const Piece& piece) {
  const auto number = static_cast<std::uint32_t>(pieces_.size());
  pieces_.push_back(piece);
  const Point2 to = std::isfinite(piece.end) && std::isfinite(piece.begin)
                        ? Point2(piece.from + (piece.end - piece.begin) * piece.velocity)
                        : piece.from;
  const Point2 low = piece.from.cwiseMin(to).array() - piece.near;
  const Point2 high = piece.from.cwiseMax(to).array() + piece.near;
  for (std::size_t j = row(low.y()); j <= row(high.y()); ++j) {
    for (std::size_t i = column(low.x()); i <= column(high.x()); ++i)
      cells_[j * columns_ + i].push_back(number);
  }
}

void SpaceTime::start_at(const Point2& p, double time) {
  for (Piece& piece : pieces_) {
    if (time < piece.begin - room_in_time || time > piece.end + room_in_time) continue;
    const double at = std::clamp(time, piece.begin, piece.end);
    const Point2 there =
        piece.velocity.isZero(0) ? piece.from : Point2(piece.from + (at - piece.begin) * piece.velocity);
    const double distance = (there - p).norm();
    if (distance < piece.near) piece.near = std::max(0.0, distance - rounding);
  }
}

template <class Fn>
void SpaceTime::for_each_piece_near(const Point2& a, const Point2& b, Fn&& fn) {
  ++looks_;
  const std::size_t last_row = row(std::max(a.y(), b.y()));
  const std::size_t last_column = column(std::max(a.x(), b.x()));
  for (std::size_t j = row(std::min(a.y(), b.y())); j <= last_row; ++j) {
    for (std::size_t i = column(std::min(a.x(), b.x())); i <= last_column; ++i) {
      for (const std::uint32_t number : cells_[j * columns_ + i]) {
        Piece& piece = pieces_[number];
        if (piece.looked_at == looks_) continue;
        piece.looked_at = looks_;
        fn(piece);
      }
    }
  }
}

void SpaceTime::blocked_at(const Point2& p, std::vector<Interval>& out) {
  for_each_piece_near(p, p, [&](const Piece& piece) {
    if (piece.velocity.isZero(0)) {
      if ((p - piece.from).squaredNorm() < piece.near * piece.near)
        out.push_back({piece.begin - room_in_time, piece.end + room_in_time});
      return;
    }
    const auto close = within(piece.from - p, piece.velocity, piece.near, {0, piece.end - piece.begin});
    if (close)
      out.push_back({piece.begin + close->begin - room_in_time, piece.begin + close->end + room_in_time});
  });
}

void SpaceTime::blocked_departures(const Point2& a, const Point2& b, double duration, const Interval& window,
                                   std::vector<Interval>& out) {
  const Point2 w = (b - a) / duration;
  for_each_piece_near(a, b, [&](const Piece& piece) {
    if (piece.end + room_in_time < window.begin || piece.begin - room_in_time > window.end + duration) return;
    // With t the departure and y the time since then, both discs are at a + y w and from + (t + y - begin) v.
    // The pairs (t, y) at which they are too close are a convex set. Its first and last t lie on one of the
    // four sides of 0 <= y <= duration, begin <= t + y <= end, or where the set's border is level in t.
    const Point2& v = piece.velocity;
    const Point2 gap = a - piece.from;
    Hull hull;
    const Interval on_way{0, duration};
    if (v.isZero(0)) {
      const auto y = within(gap, w, piece.near, on_way);
      if (!y) return;
      out.push_back({piece.begin - y->end - room_in_time, piece.end - y->begin + room_in_time});
      return;
    }
    const double lasts = piece.end - piece.begin;
    // Below, t counts from the begin of the piece.
    if (const auto t = within(gap, -v, piece.near, {0, lasts})) {  // y = 0
      hull.include(t->begin);
      hull.include(t->end);
    }
    if (const auto x = within(gap + duration * w, -v, piece.near, {0, lasts})) {  // y = duration, x = t + y
      hull.include(x->begin - duration);
      hull.include(x->end - duration);
    }
    if (const auto y = within(gap, w, piece.near, on_way)) {  // t + y = 0
      hull.include(-y->begin);
      hull.include(-y->end);
    }
    if (const auto y = within(gap - lasts * v, w, piece.near, on_way)) {  // t + y = lasts
      hull.include(lasts - y->begin);
      hull.include(lasts - y->end);
    }
    const Point2 change = w - v;
    const double turn = cross(v, change);
    if (const double squared = change.squaredNorm(); squared > 0 && std::abs(turn) > rounding) {
      const Point2 normal = Point2(-change.y(), change.x()) / std::sqrt(squared);
      for (const double side : {-piece.near, piece.near}) {
        const double t = (gap.dot(normal) - side) / v.dot(normal);
        const double y = (t * v - gap).dot(change) / squared;
        if (y >= 0 && y <= duration && t + y >= 0 && t + y <= lasts) hull.include(t);
      }
    }
    if (const auto blocked = hull.get())
      out.push_back({piece.begin + blocked->begin - room_in_time, piece.begin + blocked->end + room_in_time});
  });
}

}  // namespace coppice
