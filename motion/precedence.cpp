#include "motion/precedence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace coppice {

namespace {

constexpr double piece_radii = 0.15;  // radii, length of the pieces into which ways are cut

// Limits of the work for the gates of one robot, 16 and 50 times the largest that were measured (a maze with
// 50 robots, a circle of 250 robots). Without them, ways that run to and fro beside each other, just too far
// away to touch, would be compared piece by piece.
constexpr std::size_t most_kept = 1 << 20;  // pieces: 32 MiB
constexpr std::size_t most_looks = 30'000'000;
constexpr double most_cells_a_side = 2048;  // if there would be more, cells are larger

/// A short piece of a robot's way.
struct Piece {
  std::size_t robot;
  Point2 middle;
  double begin;  ///< metres along the robot's way
  double end;
};

double parts_of(double length, double radius) {
  return std::max(1.0, std::ceil(length / (piece_radii * radius)));
}

/// Calls fn for the pieces of a move that begins `along` metres along its robot's way. `along` advances to
/// its end.
template <class Fn>
void for_each_piece(const Move& move, double radius, double& along, Fn&& fn) {
  for (std::size_t k = 1; k < move.path.size(); ++k) {
    const Point2 edge = move.path[k] - move.path[k - 1];
    const double length = edge.norm();
    const double parts = parts_of(length, radius);
    for (double part = 0; part < parts; ++part) {
      fn(Piece{move.robot, move.path[k - 1] + edge * ((part + 0.5) / parts), along + length * part / parts,
               along + length * (part + 1) / parts});
    }
    along += length;
  }
}

/// The pieces of other robots that come near one robot's way and may still cause a gate, by grid cell of
/// their middle.
class PiecesAround {
 public:
  struct Entry {
    Point2 middle;
    double end;
    std::uint32_t robot;
    std::uint32_t next;
  };

  PiecesAround(const Box<2>& box, double near)
      : cell_(std::max(near, (box.upper - box.lower).maxCoeff() / most_cells_a_side)),
        lower_(box.lower.array() - 1.5 * cell_),
        columns_(cells_over(box.upper.x() - box.lower.x())),
        near_(columns_ * cells_over(box.upper.y() - box.lower.y()), false),
        first_(near_.size(), none) {}

  /// Marks the cells around a point of the robot's own way.
  void mark_around(const Point2& p) {
    const std::size_t cell = cell_of(p);
    for (const std::size_t row : {cell - columns_, cell, cell + columns_}) {
      for (std::size_t k = row - 1; k <= row + 1; ++k) near_[k] = true;
    }
  }
  /// Once this holds, no further piece is kept.
  bool exhausted() const { return pieces_.size() >= most_kept || looks_ >= most_looks; }
  void add(const Piece& piece) {
    if (exhausted()) return;
    const Point2 at = (piece.middle - lower_) / cell_;
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < static_cast<double>(columns_))) return;
    const std::size_t cell = cell_of(piece.middle);
    if (cell >= near_.size() || !near_[cell]) return;
    pieces_.push_back({piece.middle, piece.end, static_cast<std::uint32_t>(piece.robot), first_[cell]});
    first_[cell] = static_cast<std::uint32_t>(pieces_.size() - 1);
  }
  /// `p`: a point of the own way. Pieces for which `settled(piece)` holds are removed; it must keep holding.
  template <class Settled, class Fn>
  void for_each_within_a_cell(const Point2& p, Settled&& settled, Fn&& fn) {
    const std::size_t cell = cell_of(p);
    for (const std::size_t row : {cell - columns_, cell, cell + columns_}) {
      for (std::size_t k = row - 1; k <= row + 1; ++k) {
        for (std::uint32_t* at = &first_[k]; *at != none;) {
          Entry& entry = pieces_[*at];
          ++looks_;
          if (settled(entry)) {
            *at = entry.next;
            continue;
          }
          fn(entry);
          at = &entry.next;
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  /// Includes one spare cell on each side, and half a cell for rounding.
  std::size_t cells_over(double length) const { return static_cast<std::size_t>(length / cell_) + 4; }
  std::size_t cell_of(const Point2& p) const {
    return static_cast<std::size_t>((p.y() - lower_.y()) / cell_) * columns_ +
           static_cast<std::size_t>((p.x() - lower_.x()) / cell_);
  }

  double cell_;
  Point2 lower_;
  std::size_t columns_;
  std::vector<bool> near_;            ///< by cell
  std::vector<std::uint32_t> first_;  ///< by cell: the piece that was added last
  std::vector<Entry> pieces_;
  std::size_t looks_ = 0;
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

double pieces_of(std::span<const Move> moves, std::span<const double> radii) {
  double pieces = 0;
  for (const Move& move : moves) {
    for (std::size_t k = 1; k < move.path.size(); ++k)
      pieces += parts_of((move.path[k] - move.path[k - 1]).norm(), radii[move.robot]);
  }
  return pieces;
}

std::vector<Gate> gates_of(std::size_t robot, std::span<const Move> moves, std::span<const double> radii) {
  const double largest = *std::ranges::max_element(radii);
  // A piece's middle is up to half of its length away from the piece's points.
  const double inflated = (2 * stray_radii + piece_radii) * largest;
  const double nearest = radii[robot] + largest + inflated;
  const Box<2> box = box_around_way(robot, moves);
  if (!(box.lower.x() <= box.upper.x())) return {};  // the robot has no moves
  PiecesAround around(box, nearest);
  double along_own = 0;
  for (const Move& move : moves) {
    if (move.robot == robot)
      for_each_piece(move, radii[robot], along_own, [&](const Piece& p) { around.mark_around(p.middle); });
  }

  std::vector<Gate> gates;
  std::vector<double> along(radii.size(), 0.0);
  std::vector<double> needed(radii.size(), 0.0);  // by robot: metres that the gates so far require
  std::vector<std::size_t> rising;                // robots of which the current piece requires more
  const auto settled = [&](const auto& other) { return other.end <= needed[other.robot]; };
  const auto add_gates = [&](const Piece& piece) {
    rising.clear();
    around.for_each_within_a_cell(piece.middle, settled, [&](const auto& other) {
      const double near = radii[robot] + radii[other.robot] + inflated;
      if ((other.middle - piece.middle).squaredNorm() >= near * near) return;
      rising.push_back(other.robot);
      needed[other.robot] = other.end;
    });
    std::ranges::sort(rising);
    rising.erase(std::unique(rising.begin(), rising.end()), rising.end());
    for (const std::size_t other : rising) gates.push_back({piece.begin, other, needed[other]});
  };
  const auto wait_for_all = [&](const Piece& piece) {
    for (std::size_t other = 0; other < radii.size(); ++other) {
      if (other == robot || along[other] <= needed[other]) continue;
      needed[other] = along[other];
      gates.push_back({piece.begin, other, along[other]});
    }
  };
  // In the plan's order, each piece of the own way finds the pieces of earlier moves.
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
    bool waits_for_all = false;
    for_each_piece(move, radii[move.robot], along[move.robot], [&](const Piece& piece) {
      if (piece.robot != robot) {
        around.add(piece);
      } else if (!around.exhausted()) {
        add_gates(piece);
      } else if (!std::exchange(waits_for_all, true)) {
        wait_for_all(piece);
      }
    });
  }
  return gates;
}

}  // namespace coppice
