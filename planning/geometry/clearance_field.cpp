#include "coppice/planning/clearance_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace coppice {
namespace {

// Touching is decided to within 1e-9 m. This is half of that; the other half is room for rounding.
constexpr double contact_slack = 5e-10;

// Upper bound of the relative rounding error of the interpolated squares.
constexpr double rounding = 1e-14;

// Cells. A piece of a segment that is at most this long is examined cell by cell instead of being cut
// further. If the bound fails in its middle, cutting rarely helps; if it holds there, cutting mostly helps.
constexpr double doubtful_piece = 16;
constexpr double short_piece = 4;

/// The least clearance, in cells, at which a disc counts as free.
double needed_clearance(double radius, double cells_per_metre) {
  return std::max(radius - contact_slack, contact_slack) * cells_per_metre;
}

/// Steps to the nearest blocked cell of the same column, 0 in blocked cells. The ring around the grid counts
/// as blocked.
std::vector<std::int32_t> vertical_steps(const OccupancyMap& map, std::size_t stride, std::size_t rows) {
  std::vector<std::int32_t> steps(stride * rows, 0);
  for (std::size_t j = 1; j + 1 < rows; ++j) {
    const std::uint8_t* blocked = map.blocked.data() + (j - 1) * (stride - 2);
    std::int32_t* row = steps.data() + j * stride + 1;
    const std::int32_t* before = row - stride;
    for (std::size_t i = 0; i + 2 < stride; ++i)
      // Without a branch that the processor could mispredict.
      row[i] = (before[i] + 1) * std::int32_t{blocked[i] == 0};
  }
  for (std::size_t j = rows - 2; j > 0; --j) {
    std::int32_t* row = steps.data() + j * stride + 1;
    const std::int32_t* after = row + stride;
    for (std::size_t i = 0; i + 2 < stride; ++i) row[i] = std::min(row[i], after[i] + 1);
  }
  return steps;
}

/// Turns steps along the columns into squared distances, one row at a time.
///
/// Lengths are in half cells: centres lie at even coordinates, edges between cells at odd ones. If the
/// nearest point of a blocked square is not straight above or below, it lies on one of the square's upright
/// edges. So the transform of squares is the transform of points on edges, joined with the column's own
/// value. Cells beyond a blocked cell of the row are never nearer than that cell, so each run of free cells
/// is transformed by itself.
class RowTransform {
 public:
  explicit RowTransform(std::size_t cells) : own_(cells), hull_(cells) {}

  /// The first and the last cell of the row must be blocked.
  void operator()(std::span<std::int32_t> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (row[i] == 0) continue;
      std::size_t end = i;
      while (row[end] != 0) ++end;
      transform_run(row.subspan(i, end - i));
      i = end;
    }
  }

 private:
  struct Parabola {
    double place;
    double value;
    double from;  // from where on it is the lowest
  };

  /// A run of free cells between two blocked ones. Coordinates count from the first of them.
  void transform_run(std::span<std::int32_t> run) {
    Parabola* top = hull_.data();
    *top = {-1, 0, -std::numeric_limits<double>::infinity()};
    double own = 0;
    for (std::size_t i = 0; i < run.size(); ++i) {
      const double before = own;
      const double distance = 2.0 * run[i] - 1;
      own_[i] = own = distance * distance;
      if (i > 0) top = join_hull(top, 2.0 * static_cast<double>(i) - 1, std::min(before, own));
    }
    const Parabola* last = join_hull(top, 2.0 * static_cast<double>(run.size()) - 1, 0);
    Parabola lowest = hull_.front();
    const Parabola* next = hull_.data() + 1;
    for (std::size_t i = 0; i < run.size(); ++i) {
      const double place = 2.0 * static_cast<double>(i);
      while (next <= last && next->from < place) lowest = *next++;
      const double offset = place - lowest.place;
      run[i] = static_cast<std::int32_t>(std::min(own_[i], lowest.value + offset * offset));
    }
  }

  /// Removes the parabolas that the new one hides from the top of the hull, and pushes the new one. Returns
  /// the new top.
  Parabola* join_hull(Parabola* top, double place, double value) {
    while (true) {
      const double from = ((value - top->value) / (place - top->place) + place + top->place) / 2;
      if (from > top->from) {
        *++top = {place, value, from};
        return top;
      }
      --top;
    }
  }

  std::vector<double> own_;
  std::vector<Parabola> hull_;
};

/// The distance from x to the interval [lower, lower + 1].
double outside_unit(double x, double lower) {
  return std::max({lower - x, x - lower - 1, 0.0});
}

double square_distance_squared(const Point2& p, const Point2& corner) {
  const double dx = outside_unit(p.x(), corner.x());
  const double dy = outside_unit(p.y(), corner.y());
  return dx * dx + dy * dy;
}

/// The part [from, to] of [0, 1] where start + t * step lies in [lower, upper]; from > to if there is none.
struct Interval {
  double from = 0;
  double to = 1;
  void cut(double start, double step, double lower, double upper) {
    if (step == 0) {
      if (start < lower || start > upper) to = -1;
      return;
    }
    const double t0 = (lower - start) / step;
    const double t1 = (upper - start) / step;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
};

/// The squared distance between the segment ab and the closed unit square whose lower corner is `corner`.
double square_distance_squared(const Point2& a, const Point2& b, const Point2& corner) {
  const Point2 d = b - a;
  double least = square_distance_squared(a, corner);
  if (d.isZero(0)) return least;
  Interval inside;
  inside.cut(a.x(), d.x(), corner.x(), corner.x() + 1);
  inside.cut(a.y(), d.y(), corner.y(), corner.y() + 1);
  if (inside.from <= inside.to) return 0;
  // Two disjoint convex polygons are nearest at a vertex of one of them.
  least = std::min(least, square_distance_squared(b, corner));
  const double squared = d.squaredNorm();
  for (int k = 0; k < 4; ++k) {
    const Point2 c = corner + Point2(k & 1, k >> 1) - a;
    const double t = std::clamp(c.dot(d) / squared, 0.0, 1.0);
    least = std::min(least, (c - t * d).squaredNorm());
  }
  return least;
}

}  // namespace

/// A part of a segment, with lower bounds on the squared clearance at its ends.
struct ClearanceField::Piece {
  Point2 a;
  double at_a;
  Point2 b;
  double at_b;

  /// By concavity, the squared clearance at a + t (b - a) is at least (1 - t) at_a + t at_b - t (1 - t) |b -
  /// a|^2, a parabola in t. Returns whether its least value on [0, 1] is at least `needed`.
  bool certified(double needed) const {
    if (!(at_a >= needed && at_b >= needed)) return false;
    const double length_squared = (b - a).squaredNorm();
    const double slope = length_squared + at_a - at_b;
    if (slope <= 0 || slope >= 2 * length_squared) return true;  // least at an end
    return slope * slope <= 4 * length_squared * (at_a - needed);
  }
};

ClearanceField::ClearanceField(const OccupancyMap& map, double inflation)
    : frame_(map.frame()),
      extent_(frame_.width, frame_.height),
      cells_per_metre_(1 / frame_.resolution),
      inflation_(inflation),
      stride_(frame_.width + 2) {
  assert(frame_.width >= 1 && frame_.height >= 1 && frame_.resolution > 0);
  assert(map.blocked.size() == frame_.cells());
  const auto stride = static_cast<std::size_t>(stride_);
  const auto rows = static_cast<std::size_t>(frame_.height) + 2;
  centre_squared_ = vertical_steps(map, stride, rows);
  RowTransform transform(stride);
  for (std::size_t j = 0; j < rows; ++j) transform({centre_squared_.data() + j * stride, stride});
  mark_edges(map);
}

/// Marks the edge cells, 64 cells at a time. A cell is at an edge if it is blocked and one of its four
/// neighbours is not. The outside counts as blocked.
void ClearanceField::mark_edges(const OccupancyMap& map) {
  const auto width = static_cast<std::size_t>(map.width);
  const auto height = static_cast<std::size_t>(map.height);
  constexpr std::uint64_t all = ~std::uint64_t{0};
  words_per_row_ = (width + 63) / 64;
  std::vector<std::uint64_t> blocked((height + 2) * words_per_row_, all);
  for (std::size_t j = 0; j < height; ++j) {
    const std::uint8_t* cells = map.blocked.data() + j * width;
    std::uint64_t* row = blocked.data() + (j + 1) * words_per_row_;
    for (std::size_t w = 0; w < words_per_row_; ++w) {
      const std::size_t most = std::min<std::size_t>(64, width - 64 * w);
      std::uint64_t free = 0;
      for (std::size_t i = 0; i < most; ++i) free |= std::uint64_t{cells[64 * w + i] == 0} << i;
      row[w] = ~free;
    }
  }
  edges_.assign(words_per_row_ * height, 0);
  for (std::size_t j = 0; j < height; ++j) {
    const std::uint64_t* row = blocked.data() + (j + 1) * words_per_row_;
    for (std::size_t w = 0; w < words_per_row_; ++w) {
      const std::uint64_t left = row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : 1);
      const std::uint64_t right = row[w] >> 1 | (w + 1 < words_per_row_ ? row[w + 1] : all) << 63;
      const std::uint64_t above = *(row + w - words_per_row_);
      const std::uint64_t below = *(row + w + words_per_row_);
      edges_[j * words_per_row_ + w] = row[w] & ~(left & right & above & below);
    }
    if (width % 64 != 0) edges_[(j + 1) * words_per_row_ - 1] &= ~(all << (width % 64));
  }
  tiles_.assign((height + tile - 1) / tile * words_per_row_, 0);
  for (std::size_t j = 0; j < height; ++j) {
    for (std::size_t w = 0; w < words_per_row_; ++w)
      tiles_[j / tile * words_per_row_ + w] |= edges_[j * words_per_row_ + w] != 0;
  }
}

/// Whether no tile that touches the segment's bounding box, widened by `margin` on all sides, contains an
/// edge cell. Then all cells there are free if one of them is. This answers quickly in open space; false
/// means that nothing is known.
bool ClearanceField::without_edges(const Point2& a, const Point2& b, double margin) const {
  const Point2 lower = a.cwiseMin(b).array() - margin;
  const Point2 upper = a.cwiseMax(b).array() + margin;
  if (lower.minCoeff() < 0 || (extent_ - upper).minCoeff() <= 0) return false;
  const auto index = [](double cells) { return static_cast<std::size_t>(cells) / tile; };
  for (std::size_t j = index(lower.y()); j <= index(upper.y()); ++j) {
    for (std::size_t i = index(lower.x()); i <= index(upper.x()); ++i) {
      if (tiles_[j * words_per_row_ + i] != 0) return false;
    }
  }
  return true;
}

inline double ClearanceField::lower_squared(const Point2& q) const {
  // Padded cell k has its centre at q = k - 0.5. q lies between four centres, at (x, y) from the first.
  const double u = q.x() + 0.5;
  const double v = q.y() + 0.5;
  const auto i = static_cast<int>(u);
  const auto j = static_cast<int>(v);
  const double x = u - static_cast<double>(i);
  const double y = v - static_cast<double>(j);
  const std::int32_t* low = centre_squared_.data() + j * stride_ + i;
  const std::int32_t* high = low + stride_;
  const double along_low = low[0] + x * (low[1] - low[0]);
  const double along_high = high[0] + x * (high[1] - high[0]);
  const double mean = 0.25 * (along_low + y * (along_high - along_low));
  return mean - x * (1 - x) - y * (1 - y) - rounding * (1 + mean);
}

double ClearanceField::upper_squared(const Point2& q) const {
  // The centre c of q's cell is a mean of q and of the two neighbouring centres on the far side of c.
  const std::ptrdiff_t i = std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(q.x()), frame_.width - 1);
  const std::ptrdiff_t j = std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(q.y()), frame_.height - 1);
  const double dx = q.x() - static_cast<double>(i) - 0.5;
  const double dy = q.y() - static_cast<double>(j) - 0.5;
  const double x = std::abs(dx);
  const double y = std::abs(dy);
  const double here = 0.25 * at(i, j);
  const double gain_x = here - 0.25 * at(dx < 0 ? i + 1 : i - 1, j);
  const double gain_y = here - 0.25 * at(i, dy < 0 ? j + 1 : j - 1);
  const double upper = here + x * (gain_x + 1) + y * (gain_y + 1) + x * x + y * y;
  return upper + rounding * (1 + here);
}

/// The least squared distance between the segment ab and the blocked cells, or `limit_squared` if that is
/// less.
double ClearanceField::least_squared(const Point2& a, const Point2& b, double limit_squared) const {
  if (in_blocked_cell(a) || in_blocked_cell(b)) return 0;
  const double border = std::min(border_distance(a), border_distance(b));
  double least = std::min(limit_squared, border * border);
  const Point2 d = b - a;
  const double top = std::max(a.y(), b.y());
  double reach = std::sqrt(least);
  const double first_row = std::max(std::min(a.y(), b.y()) - reach, 0.0);
  for (auto j = static_cast<std::size_t>(first_row);
       static_cast<double>(j) < std::min(top + reach, extent_.y()); ++j) {
    // Only the part of the segment within reach of the row matters.
    const auto row = static_cast<double>(j);
    Interval near;
    near.cut(a.y(), d.y(), row - reach, row + 1 + reach);
    if (near.from > near.to) continue;
    const double x0 = a.x() + near.from * d.x();
    const double x1 = a.x() + near.to * d.x();
    const double first = std::max(std::min(x0, x1) - reach, 0.0);
    const double last = std::min(std::max(x0, x1) + reach, extent_.x() - 1);
    for_each_edge(j, static_cast<std::size_t>(first), static_cast<std::size_t>(last), [&](std::size_t i) {
      least = std::min(least, square_distance_squared(a, b, Point2(static_cast<double>(i), row)));
    });
    reach = std::sqrt(least);
  }
  return least;
}

double ClearanceField::lower_bound(const Point2& p) const {
  const Point2 q = to_cells(p);
  if (!contains(q)) return 0;
  return std::max(0.0, std::sqrt(std::max(lower_squared(q), 0.0)) * frame_.resolution - inflation_);
}

double ClearanceField::clearance(const Point2& p) const {
  return segment_clearance(p, p);
}

bool ClearanceField::is_free(const Point2& p, double radius) const {
  const Point2 q = to_cells(p);
  if (!contains(q) || !std::isfinite(radius)) return false;
  const double needed = needed_clearance(radius + inflation_, cells_per_metre_);
  const double needed_squared = needed * needed;
  if (lower_squared(q) >= needed_squared) return true;
  if (upper_squared(q) < needed_squared) return false;
  return least_squared(q, q, needed_squared) >= needed_squared;
}

bool ClearanceField::segment_free(const Point2& a, const Point2& b, double radius) const {
  const Piece whole{to_cells(a), 0, to_cells(b), 0};
  if (!contains(whole.a) || !contains(whole.b) || !std::isfinite(radius)) return false;
  const double needed = needed_clearance(radius + inflation_, cells_per_metre_);
  if (without_edges(whole.a, whole.b, needed)) return !in_blocked_cell(whole.a);
  const double needed_squared = needed * needed;
  const Piece bounded{whole.a, lower_squared(whole.a), whole.b, lower_squared(whole.b)};
  if (bounded.at_a < needed_squared && upper_squared(bounded.a) < needed_squared) return false;
  if (bounded.at_b < needed_squared && upper_squared(bounded.b) < needed_squared) return false;
  return piece_free(bounded, needed_squared);
}

bool ClearanceField::piece_free(const Piece& piece, double needed_squared) const {
  if (piece.certified(needed_squared)) return true;
  const double length_squared = (piece.b - piece.a).squaredNorm();
  const Point2 middle = 0.5 * (piece.a + piece.b);
  const double at_middle = lower_squared(middle);
  const bool doubtful = at_middle < needed_squared;
  if (doubtful && upper_squared(middle) < needed_squared) return false;
  const double indivisible = doubtful ? doubtful_piece : short_piece;
  if (length_squared <= indivisible * indivisible) {
    return least_squared(piece.a, piece.b, needed_squared) >= needed_squared;
  }
  return piece_free({piece.a, piece.at_a, middle, at_middle}, needed_squared) &&
         piece_free({middle, at_middle, piece.b, piece.at_b}, needed_squared);
}

double ClearanceField::segment_clearance(const Point2& a, const Point2& b) const {
  const Point2 from = to_cells(a);
  const Point2 to = to_cells(b);
  if (!contains(from) || !contains(to)) return 0;
  const double limit = std::min({upper_squared(from), upper_squared(to), upper_squared(0.5 * (from + to))});
  return std::max(0.0,
                  std::sqrt(least_squared(from, to, std::max(limit, 0.0))) * frame_.resolution - inflation_);
}

}  // namespace coppice
