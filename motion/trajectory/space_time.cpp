#include "motion/trajectory/space_time.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace coppice {

namespace {

constexpr double cell_radii = 4;  // radii to a side of a cell
constexpr double rounding = 1e-9;

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

SpaceTime::SpaceTime(const Box<2>& bounds, double radius, std::function<double(double, double)> apart)
    : radius_(radius), apart_(std::move(apart)), cell_(cell_radii * radius), lower_(bounds.lower) {
  const Point2 extent = bounds.upper - bounds.lower;
  constexpr double most_cells = 1 << 20;
  cell_ = std::max(cell_, std::sqrt(extent.prod() / most_cells));
  columns_ = static_cast<std::size_t>(extent.x() / cell_) + 1;
  rows_ = static_cast<std::size_t>(extent.y() / cell_) + 1;
  squares_.resize(columns_ * rows_);
  cells_.emplace_back();
}

std::size_t SpaceTime::column(double x) const {
  return static_cast<std::size_t>(
      std::clamp((x - lower_.x()) / cell_, 0.0, static_cast<double>(columns_ - 1)));
}
std::size_t SpaceTime::row(double y) const {
  return static_cast<std::size_t>(std::clamp((y - lower_.y()) / cell_, 0.0, static_cast<double>(rows_ - 1)));
}

void SpaceTime::add_standing(const Point2& p, double radius, double until) {
  add({{-forever, p}}, apart_(radius_, radius), until, nobody);
}

void SpaceTime::add_obstacle(const Disc& disc) {
  add({{-forever, disc.centre}}, radius_ + disc.radius + standing_gap, forever, nobody);
}

void SpaceTime::add(const Trajectory& trajectory, double near, double until, Number robot) {
  const TimedPoint& first = trajectory.front();
  if (first.time > -forever)
    add_piece({.from = first.position,
               .velocity = Point2::Zero(),
               .begin = -forever,
               .end = trajectory.size() > 1 ? first.time : until,
               .near = near,
               .robot = robot});
  if (trajectory.size() > 1 || first.time == -forever) add_parts(trajectory, near, until, robot);
}

void SpaceTime::go_on(Number robot, const Trajectory& rest, double radius) {
  const TimedPoint& first = rest.front();
  const double near = apart_(radius_, radius);
  for_each_cell_near(first.position, first.position, near, [&](Cell& cell) {
    for (Piece& piece : cell.standing) {
      if (piece.robot == robot && piece.end == forever) piece.end = first.time;
    }
  });
  add_parts(rest, near, forever, robot);
}

void SpaceTime::add_parts(const Trajectory& trajectory, double near, double until, Number robot) {
  for (std::size_t k = 1; k < trajectory.size(); ++k) {
    const Point2 way = trajectory[k].position - trajectory[k - 1].position;
    const double duration = trajectory[k].time - trajectory[k - 1].time;
    const double parts = std::max(1.0, std::ceil(way.norm() / cell_));
    const Point2 velocity = duration > 0 ? Point2(way / duration) : Point2::Zero();
    for (double part = 0; part < parts; ++part) {
      add_piece({.from = trajectory[k - 1].position + way * (part / parts),
                 .velocity = velocity,
                 .begin = trajectory[k - 1].time + duration * part / parts,
                 .end = trajectory[k - 1].time + duration * (part + 1) / parts,
                 .near = near,
                 .reach = near + room_in_time * velocity.norm(),
                 .robot = robot});
    }
  }
  const TimedPoint& last = trajectory.back();
  add_piece({.from = last.position,
             .velocity = Point2::Zero(),
             .begin = last.time,
             .end = until,
             .near = near,
             .robot = robot});
}

/// The first and last departure at which a disc and a piece of a trajectory come too close. The disc is at
/// a + y w, y seconds after it departs.
std::optional<Interval> SpaceTime::blocked_departures(const Piece& piece, const Point2& a, const Point2& w,
                                                      const Interval& on_way) {
  // With t the departure and y the time since then, both discs are at a + y w and from + (t + y - begin) v.
  // The pairs (t, y) at which they are too close are a convex set. Its first and last t lie on one of the
  // four sides of on_way, begin <= t + y <= end, or where the set's border is level in t.
  const Point2& v = piece.velocity;
  const Point2 gap = a - piece.from;
  if (v.isZero(0)) {
    const auto y = within(gap, w, piece.near, on_way);
    return y ? std::optional(Interval{piece.begin - y->end, piece.end - y->begin}) : std::nullopt;
  }
  const double lasts = piece.end - piece.begin;
  // Below, t counts from the begin of the piece.
  Hull hull;
  for (const double y : {on_way.begin, on_way.end}) {  // x = t + y
    if (const auto x = within(gap + y * w, -v, piece.near, {0, lasts})) {
      hull.include(x->begin - y);
      hull.include(x->end - y);
    }
  }
  for (const double x : {0.0, lasts}) {
    if (const auto y = within(gap - x * v, w, piece.near, on_way)) {
      hull.include(x - y->begin);
      hull.include(x - y->end);
    }
  }
  const Point2 change = w - v;
  const double turn = cross(v, change);
  if (const double squared = change.squaredNorm(); squared > 0 && std::abs(turn) > rounding) {
    const Point2 normal = Point2(-change.y(), change.x()) / std::sqrt(squared);
    for (const double side : {-piece.near, piece.near}) {
      const double t = (gap.dot(normal) - side) / v.dot(normal);
      const double y = (t * v - gap).dot(change) / squared;
      if (y >= on_way.begin && y <= on_way.end && t + y >= 0 && t + y <= lasts) hull.include(t);
    }
  }
  auto blocked = hull.get();
  if (blocked) *blocked = {piece.begin + blocked->begin, piece.begin + blocked->end};
  return blocked;
}

void SpaceTime::add_piece(const Piece& piece) {
  const bool moves = !piece.velocity.isZero(0);
  const Point2 to = moves ? Point2(piece.from + (piece.end - piece.begin) * piece.velocity) : piece.from;
  if (moves) longest_ = std::max(longest_, piece.end - piece.begin);
  for_each_cell_near(piece.from, to, piece.near, [&](Cell& cell) {
    (moves ? cell.moving : cell.standing).push_back(piece);
    cell.is_sorted = cell.is_sorted && !moves;
  });
}

void SpaceTime::start_at(const Point2& p, double time) {
  const auto let_leave = [&](Piece& piece) {
    if (time < piece.begin - room_in_time || time > piece.end + room_in_time) return;
    const double at = std::clamp(time, piece.begin, piece.end);
    const Point2 there =
        piece.velocity.isZero(0) ? piece.from : Point2(piece.from + (at - piece.begin) * piece.velocity);
    const double distance = (there - p).norm();
    if (distance < piece.near) piece.near = std::max(0.0, distance - rounding);
  };
  for (Cell& cell : cells_) {
    std::ranges::for_each(cell.standing, let_leave);
    std::ranges::for_each(cell.moving, let_leave);
  }
}

/// Calls fn(cell) for the cells that the box around both points, so many metres wider, touches.
template <class Fn>
void SpaceTime::for_each_cell_near(const Point2& a, const Point2& b, double distance, Fn&& fn) {
  const Point2 low = a.cwiseMin(b).array() - distance;
  const Point2 high = a.cwiseMax(b).array() + distance;
  for (std::size_t j = row(low.y()); j <= row(high.y()); ++j) {
    for (std::size_t i = column(low.x()); i <= column(high.x()); ++i) {
      std::uint32_t& number = square(i, j);
      if (number == 0) {
        number = static_cast<std::uint32_t>(cells_.size());
        cells_.emplace_back();
      }
      fn(cells_[number]);
    }
  }
}

/// Calls fn(cell, part) for the cells that the line from a to b passes. `part` tells which share of the line
/// lies in the cell, from 0 to 1.
template <class Fn>
void SpaceTime::for_each_cell_along(const Point2& a, const Point2& b, Fn&& fn) {
  const Point2 way = b - a;
  // The share of the line at which it leaves column (axis 0) or row (axis 1) `from` for the one that leads to
  // `to`. Infinite: it stays there.
  const auto border = [&](int axis, std::size_t from, std::size_t to) {
    if (from == to) return SpaceTime::forever;
    const double line = lower_[axis] + cell_ * static_cast<double>(way[axis] > 0 ? from + 1 : from);
    return (line - a[axis]) / way[axis];
  };
  std::size_t i = column(a.x());
  std::size_t j = row(a.y());
  const std::size_t last_i = column(b.x());
  const std::size_t last_j = row(b.y());
  double begin = 0;
  for (;;) {
    const double x = border(0, i, last_i);
    const double y = border(1, j, last_j);
    const double end = std::clamp(std::min(x, y), begin, 1.0);
    fn(cells_[square(i, j)], Interval{begin, end});
    if (i == last_i && j == last_j) return;
    begin = end;
    if (x <= y) {
      i = way.x() > 0 ? i + 1 : i - 1;
    } else {
      j = way.y() > 0 ? j + 1 : j - 1;
    }
  }
}

void SpaceTime::blocked_at(const Point2& p, std::vector<Interval>& out, Number own) const {
  const Cell& cell = cells_[squares_[row(p.y()) * columns_ + column(p.x())]];
  for (const Piece& piece : cell.standing) {
    if (is_own(piece, own)) continue;
    if ((p - piece.from).squaredNorm() < piece.near * piece.near)
      out.push_back({piece.begin - room_in_time, piece.end + room_in_time});
  }
  for (const Piece& piece : cell.moving) {
    if (is_own(piece, own)) continue;
    const auto close = within(piece.from - p, piece.velocity, piece.near, {0, piece.end - piece.begin});
    if (close)
      out.push_back({piece.begin + close->begin - room_in_time, piece.begin + close->end + room_in_time});
  }
}

std::vector<Interval> SpaceTime::safe_at(const Point2& p) const {
  std::vector<Interval> times;
  times.reserve(8);
  blocked_at(p, times);
  unite(times);
  // Each blocked time becomes the safe time before it.
  double begin = -forever;
  for (Interval& i : times) i = {std::exchange(begin, i.end), i.begin};
  times.push_back({begin, forever});
  std::erase_if(times, [](const Interval& i) { return i.begin >= i.end; });
  return times;
}

double SpaceTime::first_departure(const Point2& a, const Point2& b, double ready, double from,
                                  const Limits& limits) {
  const double duration = (b - a).norm() / limits.max_speed;
  const double departure = first_departure(a, b, duration, from);
  const double waited = departure - ready;
  return waited > 0 ? first_departure(a, b, duration, departure + std::min(speeding_up(limits), waited))
                    : departure;
}

double SpaceTime::first_departure(const Point2& a, const Point2& b, double duration, double from,
                                  Number own) {
  const Point2 velocity = (b - a) / duration;
  double departure = from;
  for (bool is_free = false; !is_free && departure < forever;) {
    const double tried = departure;
    for_each_cell_along(a, b, [&](Cell& cell, const Interval& part) {
      if (!std::exchange(cell.is_sorted, true)) std::ranges::sort(cell.moving, {}, &Piece::begin);
      const Interval on_way{duration * part.begin, duration * part.end};
      if (departure < forever) departure = end_of_block(cell, a, velocity, on_way, departure, own);
    });
    is_free = departure == tried;
  }
  return departure;
}

/// Whether a disc that departs at a time may come too close to a piece. The test is quick and cautious: it
/// counts room in time on all sides.
bool SpaceTime::may_block(const Piece& piece, const Point2& a, const Point2& w, const Interval& on_way,
                          double departure) {
  const double first = std::max(on_way.begin, piece.begin - room_in_time - departure);
  const double last = std::min(on_way.end, piece.end + room_in_time - departure);
  if (first > last) return false;
  if (piece.velocity.isZero(0)) return true;
  const Point2 change = w - piece.velocity;
  const Point2 gap = a - piece.from - (departure - piece.begin) * piece.velocity;
  const double squared = change.squaredNorm();
  const double nearest = squared > 0 ? std::clamp(-gap.dot(change) / squared, first, last) : first;
  return (gap + nearest * change).squaredNorm() < piece.reach * piece.reach;
}

/// The end of the blocked times in a cell around a departure; the departure if it is not blocked. The disc is
/// at a + y velocity, y seconds after it departs.
double SpaceTime::end_of_block(const Cell& cell, const Point2& a, const Point2& velocity,
                               const Interval& on_way, double departure, Number own) const {
  const auto look_at = [&](const Piece& piece) {
    if (is_own(piece, own) || !may_block(piece, a, velocity, on_way, departure)) return;
    const auto blocked = blocked_departures(piece, a, velocity, on_way);
    if (blocked && blocked->begin - room_in_time <= departure && departure < blocked->end + room_in_time)
      departure = blocked->end + room_in_time;
  };
  std::ranges::for_each(cell.standing, look_at);
  const double first = departure + on_way.begin - room_in_time - longest_;
  for (auto piece = std::ranges::lower_bound(cell.moving, first, {}, &Piece::begin);
       piece != cell.moving.end() && piece->begin <= departure + on_way.end + room_in_time; ++piece)
    look_at(*piece);
  return departure;
}

bool keep_room(const Trajectory& own, double radius, const Trajectory& other, double other_radius) {
  constexpr double rounding_of_time = 1e-6;
  Box<2> box{own.front().position, own.front().position};
  for (const TimedPoint& p : own) box = extended(box, p.position);
  SpaceTime taken(box, radius);
  taken.add(other, other_radius);
  const auto may_stand = [&](const Point2& p, double from, double until) {
    std::vector<Interval> blocked;
    taken.blocked_at(p, blocked);
    return std::ranges::none_of(blocked, [&](const Interval& i) { return i.begin < until && i.end > from; });
  };
  for (std::size_t k = 1; k < own.size(); ++k) {
    const TimedPoint& a = own[k - 1];
    const TimedPoint& b = own[k];
    const bool clear = a.position == b.position
                           ? may_stand(a.position, a.time, b.time)
                           : taken.first_departure(a.position, b.position, b.time - a.time, a.time) <=
                                 a.time + rounding_of_time;
    if (!clear) return false;
  }
  return may_stand(own.back().position, own.back().time, SpaceTime::forever);
}

}  // namespace coppice
