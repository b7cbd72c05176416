#include "motion/precedence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace coppice {

namespace {

constexpr double piece_radii = 0.15;  // length of the pieces that ways are cut into, in radii

/// A short piece of a robot's way.
struct Piece {
  std::size_t robot;
  Point2 middle;
  double begin;  ///< metres along the robot's way
  double end;
};

/// The pieces of a move, which begins `along` metres along its robot's way; `along` moves on to its end.
template <class Fn>
void for_each_piece(const Move& move, double radius, double& along, Fn&& fn) {
  for (std::size_t k = 1; k < move.path.size(); ++k) {
    const Point2 edge = move.path[k] - move.path[k - 1];
    const double length = edge.norm();
    const auto parts = std::max(1.0, std::ceil(length / (piece_radii * radius)));
    for (double part = 0; part < parts; ++part) {
      fn(Piece{move.robot, move.path[k - 1] + edge * ((part + 0.5) / parts), along + length * part / parts,
               along + length * (part + 1) / parts});
    }
    along += length;
  }
}

/// The pieces of others that come near one robot's way and may still make for a gate, by the square of the
/// plane that their middle lies in.
class PiecesAround {
 public:
  PiecesAround(const Box<2>& box, double near)
      : lower_(box.lower.array() - 1.5 * near),
        cell_(near),
        columns_(cells_over(box.upper.x() - box.lower.x())),
        near_(columns_ * cells_over(box.upper.y() - box.lower.y()), false),
        first_(near_.size(), none) {}

  /// The robot's own way comes along here.
  void mark_around(const Point2& p) {
    const std::size_t cell = cell_of(p);
    for (const std::size_t row : {cell - columns_, cell, cell + columns_}) {
      for (std::size_t k = row - 1; k <= row + 1; ++k) near_[k] = true;
    }
  }
  void add(const Piece& piece) {
    const Point2 at = (piece.middle - lower_) / cell_;
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < static_cast<double>(columns_))) return;
    const std::size_t cell = cell_of(piece.middle);
    if (cell >= near_.size() || !near_[cell]) return;
    pieces_.push_back({piece, first_[cell]});
    first_[cell] = static_cast<std::uint32_t>(pieces_.size() - 1);
  }
  /// `p`: on the own way. Those for which `settled(piece)` holds are let go: it must hold from then on.
  template <class Settled, class Fn>
  void for_each_within_a_cell(const Point2& p, Settled&& settled, Fn&& fn) {
    const std::size_t cell = cell_of(p);
    for (const std::size_t row : {cell - columns_, cell, cell + columns_}) {
      for (std::size_t k = row - 1; k <= row + 1; ++k) {
        for (std::uint32_t* at = &first_[k]; *at != none;) {
          Entry& entry = pieces_[*at];
          if (settled(entry.piece)) {
            *at = entry.next;
            continue;
          }
          fn(entry.piece);
          at = &entry.next;
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  struct Entry {
    Piece piece;
    std::uint32_t next;
  };

  /// With one to spare on each side, and half of one for rounding.
  std::size_t cells_over(double length) const { return static_cast<std::size_t>(length / cell_) + 4; }
  std::size_t cell_of(const Point2& p) const {
    return static_cast<std::size_t>((p.y() - lower_.y()) / cell_) * columns_ +
           static_cast<std::size_t>((p.x() - lower_.x()) / cell_);
  }

  Point2 lower_;
  double cell_;
  std::size_t columns_;
  std::vector<bool> near_;            ///< by cell
  std::vector<std::uint32_t> first_;  ///< the same: the piece that came last
  std::vector<Entry> pieces_;
};

Box<2> box_around(const Path& path) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box<2> box{Point2::Constant(infinity), Point2::Constant(-infinity)};
  for (const Point2& p : path) box = extended(box, p);
  return box;
}

Box<2> box_around_way(std::size_t robot, std::span<const Move> moves) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box<2> box{Point2::Constant(infinity), Point2::Constant(-infinity)};
  for (const Move& move : moves) {
    if (move.robot != robot) continue;
    const Box<2> part = box_around(move.path);
    box = {box.lower.cwiseMin(part.lower), box.upper.cwiseMax(part.upper)};
  }
  return box;
}

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
  const Box<2> box = box_around_way(robot, moves);
  if (!(box.lower.x() <= box.upper.x())) return {};  // it has no moves
  PiecesAround around(box, nearest);
  double along_own = 0;
  for (const Move& move : moves) {
    if (move.robot == robot)
      for_each_piece(move, radii[robot], along_own, [&](const Piece& p) { around.mark_around(p.middle); });
  }

  std::vector<Gate> gates;
  std::vector<double> along(radii.size(), 0.0);
  std::vector<double> needed(radii.size(), 0.0);  // of each robot, by the gates so far
  std::vector<std::size_t> rising;                // those of which the piece at hand needs more
  const auto settled = [&](const Piece& other) { return other.end <= needed[other.robot]; };
  const auto add_gates = [&](const Piece& piece) {
    const auto first_of_piece = static_cast<std::ptrdiff_t>(gates.size());
    rising.clear();
    around.for_each_within_a_cell(piece.middle, settled, [&](const Piece& other) {
      const double near = radii[robot] + radii[other.robot] + inflated;
      if ((other.middle - piece.middle).squaredNorm() >= near * near) return;
      if (std::ranges::find(rising, other.robot) == rising.end()) rising.push_back(other.robot);
      needed[other.robot] = other.end;
    });
    for (const std::size_t other : rising) gates.push_back({piece.begin, other, needed[other]});
    std::sort(gates.begin() + first_of_piece, gates.end(),
              [](const Gate& a, const Gate& b) { return a.robot < b.robot; });
  };
  // In the plan's order: each piece of the own way finds those of earlier moves.
  const auto own_last =
      std::find_if(moves.rbegin(), moves.rend(), [&](const Move& m) { return m.robot == robot; });
  for (const Move& move : moves.first(static_cast<std::size_t>(moves.rend() - own_last))) {
    const Box<2> part = box_around(move.path);
    const bool far = (part.lower.array() > box.upper.array() + nearest).any() ||
                     (part.upper.array() < box.lower.array() - nearest).any();
    if (far) {
      for (std::size_t k = 1; k < move.path.size(); ++k)
        along[move.robot] += (move.path[k] - move.path[k - 1]).norm();
      continue;
    }
    for_each_piece(move, radii[move.robot], along[move.robot], [&](const Piece& piece) {
      if (piece.robot == robot) {
        add_gates(piece);
      } else {
        around.add(piece);
      }
    });
  }
  return gates;
}

}  // namespace coppice
