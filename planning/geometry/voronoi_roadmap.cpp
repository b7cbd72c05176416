#include "planning/geometry/voronoi_roadmap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include <boost/polygon/point_data.hpp>
#include <boost/polygon/segment_data.hpp>
#include <boost/polygon/segment_traits.hpp>
#include <boost/polygon/voronoi.hpp>

#include "planning/geometry/free_way.h"

namespace coppice {

namespace {

using Voronoi = boost::polygon::voronoi_diagram<double>;
using Edge = Voronoi::edge_type;
using Cell = Voronoi::cell_type;
using Vertex = Voronoi::vertex_type;
using Corner = boost::polygon::point_data<int>;
using Wall = boost::polygon::segment_data<int>;

// Below, points are in cells from the map's origin.

/// Traces the walls, where obstacles meet free cells; the outside of the map is an obstacle. Walls are
/// straight pieces that meet only at their ends, as the diagram requires. So a piece also ends where two
/// obstacles touch at a corner.
class WallTracer {
 public:
  explicit WallTracer(const ClearanceField& field)
      : width_(field.frame().width), height_(field.frame().height), blocked_(field.frame().cells()) {
    const GridFrame& frame = field.frame();
    for (std::size_t k = 0; k < blocked_.size(); ++k) {
      const std::size_t row = k / static_cast<std::size_t>(width_);
      const std::size_t column = k % static_cast<std::size_t>(width_);
      const Point2 centre(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
      blocked_[k] = field.lower_bound(frame.origin + frame.resolution * centre) <= 0;
    }
  }

  std::vector<Wall> trace() const {
    std::vector<Wall> walls;
    for (int j = 0; j <= height_; ++j) {
      trace_line(
          width_, [&](int i) { return is_blocked(i, j - 1) != is_blocked(i, j); },
          [&](int i) { return is_pinched(i, j); },
          [&](int from, int to) { walls.emplace_back(Corner(from, j), Corner(to, j)); });
    }
    for (int i = 0; i <= width_; ++i) {
      trace_line(
          height_, [&](int j) { return is_blocked(i - 1, j) != is_blocked(i, j); },
          [&](int j) { return is_pinched(i, j); },
          [&](int from, int to) { walls.emplace_back(Corner(i, from), Corner(i, to)); });
    }
    return walls;
  }

 private:
  bool is_blocked(int i, int j) const {
    return i < 0 || j < 0 || i >= width_ || j >= height_ ||
           blocked_[static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) +
                    static_cast<std::size_t>(i)];
  }
  /// Whether obstacles touch only at the lower corner of the cell.
  bool is_pinched(int i, int j) const {
    const bool here = is_blocked(i, j);
    return is_blocked(i - 1, j - 1) == here && is_blocked(i - 1, j) != here && is_blocked(i, j - 1) != here;
  }

  template <class IsWall, class IsPinched, class Add>
  static void trace_line(int count, IsWall&& is_wall, IsPinched&& is_pinched, Add&& add) {
    for (int k = 0; k < count; ++k) {
      if (!is_wall(k)) continue;
      const int from = k;
      while (k + 1 < count && is_wall(k + 1) && !is_pinched(k + 1)) ++k;
      add(from, k + 1);
    }
  }

  int width_;
  int height_;
  std::vector<bool> blocked_;
};

Point2 point(const Corner& corner) {
  return {corner.x(), corner.y()};
}
Point2 point(const Vertex& vertex) {
  return {vertex.x(), vertex.y()};
}

/// The point where the line from a to b crosses the ray from the origin in direction u; the nearer end if it
/// does not.
Point2 crossing(const Point2& a, const Point2& b, const Point2& u) {
  const double at_a = cross(u, a);
  const double at_b = cross(u, b);
  const double share = at_a == at_b ? 0 : std::clamp(at_a / (at_a - at_b), 0.0, 1.0);
  return a + share * (b - a);
}

/// The straight line through a wall, seen from one side.
struct Line {
  Point2 origin;
  Point2 along;  ///< of length 1
  Point2 away;   ///< of length 1, towards that side

  /// The line as seen from p.
  Line(const Wall& wall, const Point2& p)
      : origin(point(wall.low())), along((point(wall.high()) - origin).normalized()) {
    away = Point2(-along.y(), along.x());
    if (away.dot(p - origin) < 0) away = -away;
  }
  Point2 local(const Point2& p) const { return {along.dot(p - origin), away.dot(p - origin)}; }
  Point2 global(const Point2& p) const { return origin + p.x() * along + p.y() * away; }
};

/// The points that are as far from a corner, the focus, as from a wall.
struct Parabola {
  Line line;
  Point2 focus;  ///< in the line's coordinates

  Parabola(const Wall& wall, const Point2& corner) : line(wall, corner), focus(line.local(corner)) {}

  Point2 at(double x) const {
    const double dx = x - focus.x();
    return line.global({x, (dx * dx / focus.y() + focus.y()) / 2});
  }

  /// The point where the tangents at two points of the parabola meet.
  Point2 tangents_meet(double x0, double x1) const {
    const double product = (x0 - focus.x()) * (x1 - focus.x());
    return line.global({(x0 + x1) / 2, (product / focus.y() + focus.y()) / 2});
  }

  /// The point where the ray from the focus in direction u crosses the parabola between two points on it; one
  /// of these points if it does not.
  Point2 crossing(const Point2& from, const Point2& to, const Point2& u) const {
    const auto [least, most] = std::minmax({line.local(from).x(), line.local(to).x()});
    const double away = 1 - u.dot(line.away);
    const double x = away > 0 ? focus.x() + focus.y() / away * u.dot(line.along) : least;
    return at(std::clamp(x, least, most));
  }

  /// From one point of the parabola to another along tangents. Tangents come no nearer to the corner or the
  /// wall than the arc does; straight lines between points of the arc would.
  std::vector<Point2> arc(const Point2& from, const Point2& to) const {
    const double x0 = line.local(from).x();
    const double x1 = line.local(to).x();
    const double top = focus.x();  // the point nearest to both
    if ((x0 - top) * (x1 - top) >= 0) return {from, tangents_meet(x0, x1), to};
    return {from, tangents_meet(x0, top), tangents_meet(top, x1), to};
  }
};

/// The point where a disc that moves straight away from the nearest obstacle reaches the diagram.
struct Foot {
  const Edge* edge = nullptr;
  Point2 place = Point2::Zero();
};

/// Whether the edge separates two different obstacles, and not a wall and its own end.
bool is_passage(const Edge& edge) {
  return edge.is_primary() && edge.is_finite();
}

/// Calls fn(edge) for each passage at the border of a cell.
template <class Fn>
void for_each_passage(const Cell& cell, Fn&& fn) {
  const Edge* const first = cell.incident_edge();
  const Edge* edge = first;
  while (edge != nullptr) {
    if (is_passage(*edge)) fn(*edge);
    edge = edge->next();
    if (edge == first) break;
  }
}

}  // namespace

class VoronoiRoadmap::Diagram {
 public:
  explicit Diagram(const ClearanceField& field) : walls_(WallTracer(field).trace()) {
    boost::polygon::construct_voronoi(walls_.begin(), walls_.end(), &voronoi_);
  }

  const Voronoi::vertex_container_type& vertices() const { return voronoi_.vertices(); }
  std::size_t index(const Vertex* vertex) const {
    return static_cast<std::size_t>(vertex - voronoi_.vertices().data());
  }

  /// The way along an edge from one point on it to another.
  std::vector<Point2> along(const Edge& edge, const Point2& from, const Point2& to) const {
    return edge.is_linear() ? std::vector{from, to} : parabola_of(edge).arc(from, to);
  }

  /// No edge in the result: p is in no cell.
  Foot retract(const Point2& p) const {
    const Cell* const cell = cell_of(p);
    if (cell == nullptr) return {};
    return cell->contains_point() ? retract_from_corner(*cell, p) : retract_from_wall(*cell, p);
  }

 private:
  const Wall& wall_of(const Cell& cell) const { return walls_[cell.source_index()]; }
  /// The corner of a cell around a wall's end.
  Point2 corner_of(const Cell& cell) const {
    const bool is_low = cell.source_category() == boost::polygon::SOURCE_CATEGORY_SEGMENT_START_POINT;
    return point(is_low ? wall_of(cell).low() : wall_of(cell).high());
  }
  /// The parabola of an edge between a corner and a wall.
  Parabola parabola_of(const Edge& edge) const {
    const Cell& cell = *edge.cell();
    const Cell& other = *edge.twin()->cell();
    return cell.contains_point() ? Parabola(wall_of(other), corner_of(cell))
                                 : Parabola(wall_of(cell), corner_of(other));
  }
  const Cell* cell_of(const Point2& p) const;
  Foot retract_from_wall(const Cell& cell, const Point2& p) const;
  Foot retract_from_corner(const Cell& cell, const Point2& p) const;

  std::vector<Wall> walls_;
  Voronoi voronoi_;
};

/// A cell whose wall or corner is nearest to p; a wall is preferred to its end.
const Cell* VoronoiRoadmap::Diagram::cell_of(const Point2& p) const {
  const Cell* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Cell& cell : voronoi_.cells()) {
    double squared = 0;
    if (cell.contains_point()) {
      squared = (p - corner_of(cell)).squaredNorm();
    } else {
      const Line line(wall_of(cell), p);
      const Point2 q = line.local(p);
      if (q.x() < 0 || q.x() > line.local(point(wall_of(cell).high())).x()) continue;
      squared = q.y() * q.y();
    }
    if (squared > least || (squared == least && cell.contains_point())) continue;
    least = squared;
    nearest = &cell;
  }
  return nearest;
}

/// The edge on p's side of the wall that is straight above p.
Foot VoronoiRoadmap::Diagram::retract_from_wall(const Cell& cell, const Point2& p) const {
  const Line line(wall_of(cell), p);
  const double x = line.local(p).x();
  Foot foot;
  double least = std::numeric_limits<double>::infinity();
  for_each_passage(cell, [&](const Edge& edge) {
    const Point2 a = line.local(point(*edge.vertex0()));
    const Point2 b = line.local(point(*edge.vertex1()));
    const double aside = std::max(std::min(a.x(), b.x()) - x, x - std::max(a.x(), b.x()));
    if (a.y() + b.y() <= 0 || aside >= least) return;
    least = std::max(aside, 0.0);  // any edge above x will do
    const double share = a.x() == b.x() ? 0 : std::clamp((x - a.x()) / (b.x() - a.x()), 0.0, 1.0);
    const Point2 straight = a + share * (b - a);
    foot = {&edge, edge.is_linear() ? line.global(straight) : parabola_of(edge).at(straight.x())};
  });
  return foot;
}

/// The edge around the corner that lies in the direction of p.
Foot VoronoiRoadmap::Diagram::retract_from_corner(const Cell& cell, const Point2& p) const {
  const Point2 corner = corner_of(cell);
  const Point2 u = (p - corner).normalized();
  Foot foot;
  double least = std::numeric_limits<double>::infinity();
  for_each_passage(cell, [&](const Edge& edge) {
    const Point2 a = point(*edge.vertex0()) - corner;  // the cell is to the left of the edge
    const Point2 b = point(*edge.vertex1()) - corner;
    const double aside = std::max(-cross(a.normalized(), u), -cross(u, b.normalized()));
    if (a.dot(u) + b.dot(u) <= 0 || aside >= least) return;
    least = std::max(aside, 0.0);
    foot = {&edge, edge.is_linear() ? Point2(corner + crossing(a, b, u))
                                    : parabola_of(edge).crossing(corner + a, corner + b, u)};
  });
  return foot;
}

/// Dijkstra's search along the edges of the diagram on which the disc is free.
class VoronoiRoadmap::Search {
 public:
  Search(const ClearanceField& field, const Diagram& diagram, double radius)
      : field_(field), diagram_(diagram), radius_(radius), known_(diagram.vertices().size()) {}

  std::optional<Path> way(const Point2& start, const Point2& goal) {
    const Foot from = diagram_.retract(cells(start));
    const Foot to = diagram_.retract(cells(goal));
    if (from.edge == nullptr || to.edge == nullptr) return std::nullopt;
    const Path first{start, metres(from.place)};
    const Path last{metres(to.place), goal};
    if (!way_free(field_, start, first.back(), radius_) || !is_free(last)) return std::nullopt;
    for (const Vertex* vertex : {from.edge->vertex0(), from.edge->vertex1()})
      reach(vertex, 0, nullptr, leg(*from.edge, from.place, point(*vertex)));
    explore();
    Path best;
    double least = std::numeric_limits<double>::infinity();
    for (const Vertex* vertex : {to.edge->vertex0(), to.edge->vertex1()}) {
      const Path end = leg(*to.edge, point(*vertex), to.place);
      const double length = known_[diagram_.index(vertex)].length + length_of(end);
      if (end.empty() || length >= least) continue;
      least = length;
      best = joined(first, vertex, end);
    }
    if (best.empty()) return std::nullopt;
    best.push_back(goal);
    return best;
  }

 private:
  struct Known {
    double length = std::numeric_limits<double>::infinity();  ///< metres from the start's foot
    const Vertex* before = nullptr;
    Path leg;  ///< from `before`, or from the start's foot
  };

  Point2 cells(const Point2& p) const { return (p - field_.frame().origin) / field_.frame().resolution; }
  Point2 metres(const Point2& q) const { return field_.frame().origin + field_.frame().resolution * q; }

  bool is_free(const Path& path) const {
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (!field_.segment_free(path[i - 1], path[i], radius_)) return false;
    }
    return true;
  }
  /// The way along an edge, metres; empty if the disc is not free there.
  Path leg(const Edge& edge, const Point2& from, const Point2& to) const {
    Path path = diagram_.along(edge, from, to);
    for (Point2& p : path) p = metres(p);
    if (!is_free(path)) path.clear();
    return path;
  }

  void reach(const Vertex* vertex, double length_before, const Vertex* before, Path leg) {
    if (leg.empty()) return;
    const double length = length_before + length_of(leg);
    Known& known = known_[diagram_.index(vertex)];
    if (length >= known.length) return;
    known = {length, before, std::move(leg)};
    open_.emplace(length, vertex);
  }

  void explore() {
    while (!open_.empty()) {
      const auto [length, vertex] = open_.top();
      open_.pop();
      if (length > known_[diagram_.index(vertex)].length) continue;
      const Edge* edge = vertex->incident_edge();
      do {
        if (is_passage(*edge) && length < known_[diagram_.index(edge->vertex1())].length)
          reach(edge->vertex1(), length, vertex, leg(*edge, point(*vertex), point(*edge->vertex1())));
        edge = edge->rot_next();
      } while (edge != vertex->incident_edge());
    }
  }

  /// The way from the start to a vertex, and on along `end`.
  Path joined(const Path& first, const Vertex* vertex, const Path& end) const {
    std::vector<const Path*> legs{&end};
    for (; vertex != nullptr; vertex = known_[diagram_.index(vertex)].before)
      legs.push_back(&known_[diagram_.index(vertex)].leg);
    Path path = first;
    std::ranges::reverse(legs);  // clang 14 cannot compile the views of GCC's library
    for (const Path* leg : legs) path.insert(path.end(), leg->begin() + 1, leg->end());
    return path;
  }

  const ClearanceField& field_;
  const Diagram& diagram_;
  double radius_;
  std::vector<Known> known_;  ///< by vertex
  std::priority_queue<std::pair<double, const Vertex*>, std::vector<std::pair<double, const Vertex*>>,
                      std::greater<>>
      open_;
};

VoronoiRoadmap::VoronoiRoadmap(const ClearanceField& field)
    : field_(field), diagram_(std::make_unique<const Diagram>(field)) {}

VoronoiRoadmap::~VoronoiRoadmap() = default;

std::optional<Path> VoronoiRoadmap::way(const Point2& start, const Point2& goal, double radius) const {
  return Search(field_, *diagram_, radius).way(start, goal);
}

}  // namespace coppice
