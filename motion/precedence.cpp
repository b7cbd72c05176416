#include "motion/precedence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <unordered_map>

namespace coppice {

namespace {

constexpr double piece_radii = 0.15;  // length of the pieces that ways are cut into, in radii

/// A short piece of a robot's way.
struct Piece {
  std::size_t robot;
  std::size_t move;  ///< its place in the plan
  Point2 middle;
  double begin;  ///< metres along the robot's way
  double end;
};

Box<2> box_around_way(std::size_t robot, std::span<const Move> moves) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box<2> box{Point2::Constant(infinity), Point2::Constant(-infinity)};
  for (const Move& move : moves) {
    if (move.robot != robot) continue;
    for (const Point2& p : move.path) box = {box.lower.cwiseMin(p), box.upper.cwiseMax(p)};
  }
  return box;
}

/// Every robot's way in pieces, in the plan's order, but for what lies further than `near` from the box.
std::vector<Piece> pieces_of(std::span<const Move> moves, std::span<const double> radii, const Box<2>& box,
                             double near) {
  std::vector<Piece> pieces;
  std::vector<double> along(radii.size(), 0.0);
  for (std::size_t m = 0; m < moves.size(); ++m) {
    const auto& [robot, path] = moves[m];
    for (std::size_t k = 1; k < path.size(); ++k) {
      const double length = (path[k] - path[k - 1]).norm();
      if ((path[k].cwiseMax(path[k - 1]).array() < box.lower.array() - near).any() ||
          (path[k].cwiseMin(path[k - 1]).array() > box.upper.array() + near).any()) {
        along[robot] += length;
        continue;
      }
      const auto parts = std::max(1.0, std::ceil(length / (piece_radii * radii[robot])));
      for (double part = 0; part < parts; ++part) {
        const Point2 middle = path[k - 1] + (path[k] - path[k - 1]) * ((part + 0.5) / parts);
        pieces.push_back({robot, m, middle, along[robot] + length * part / parts,
                          along[robot] + length * (part + 1) / parts});
      }
      along[robot] += length;
    }
  }
  return pieces;
}

/// Pieces by the square of the plane that their middle lies in.
class PieceGrid {
 public:
  explicit PieceGrid(double cell) : cell_(cell) {}
  void add(const Piece& piece) {
    cells_[key(index(piece.middle.x()), index(piece.middle.y()))].push_back(&piece);
  }
  template <class Fn>
  void for_each_within_a_cell(const Point2& p, Fn&& fn) const {
    for (std::int64_t j = index(p.y()) - 1; j <= index(p.y()) + 1; ++j) {
      for (std::int64_t i = index(p.x()) - 1; i <= index(p.x()) + 1; ++i) {
        const auto found = cells_.find(key(i, j));
        if (found == cells_.end()) continue;
        for (const Piece* piece : found->second) fn(*piece);
      }
    }
  }

 private:
  std::int64_t index(double x) const { return static_cast<std::int64_t>(std::floor(x / cell_)); }
  static std::int64_t key(std::int64_t i, std::int64_t j) { return i * 0x100000001 + j; }
  double cell_;
  std::unordered_map<std::int64_t, std::vector<const Piece*>> cells_;
};

}  // namespace

std::vector<Path> legs_of(std::size_t robot, std::span<const Move> moves) {
  std::vector<Path> legs;
  for (const Move& move : moves) {
    if (move.robot != robot) continue;
    for (std::size_t k = 1; k < move.path.size(); ++k) {
      const Point2 out = move.path[k] - move.path[k - 1];
      const bool goes_on = !legs.empty() && out.dot(legs.back().back() - *(legs.back().end() - 2)) > 0;
      if (!goes_on) legs.push_back({move.path[k - 1]});
      legs.back().push_back(move.path[k]);
    }
  }
  return legs;
}

std::vector<Gate> gates_of(std::size_t robot, std::span<const Move> moves, std::span<const double> radii) {
  const double largest = *std::ranges::max_element(radii);
  // Half of each piece's length is what a middle may be away from the piece's points.
  const double inflated = (2 * stray_radii + piece_radii) * largest;
  const double nearest = radii[robot] + largest + inflated;
  const std::vector<Piece> pieces = pieces_of(moves, radii, box_around_way(robot, moves), nearest);
  PieceGrid grid(nearest);

  std::vector<Gate> gates;
  std::map<std::size_t, double> needed;  // of each robot, by the gates so far
  for (const Piece& piece : pieces) {
    if (piece.robot != robot) {
      grid.add(piece);
      continue;
    }
    // The grid holds the pieces of earlier moves, for the plan's order is the order of the pieces.
    std::map<std::size_t, double> here;
    grid.for_each_within_a_cell(piece.middle, [&](const Piece& other) {
      const double near = radii[robot] + radii[other.robot] + inflated;
      if ((other.middle - piece.middle).squaredNorm() >= near * near) return;
      double& most = here[other.robot];
      most = std::max(most, other.end);
    });
    for (const auto& [other, metres] : here) {
      if (metres <= needed[other]) continue;
      needed[other] = metres;
      gates.push_back({piece.begin, other, metres});
    }
  }
  return gates;
}

}  // namespace coppice
