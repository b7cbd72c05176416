// A uniform grid over the nodes of all trees. It finds the nodes near a point, whatever their tree.
//
// Cells are at least `reach` wide, so that all nodes within `reach` of a point lie in the 3^D cells around
// it. A look-up costs the same for any number of trees, and merging trees moves nothing. A cell stores
// positions and nodes together in short blocks, so that a look-up reads a few consecutive cache lines.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "coppice/planning/geometry.h"

namespace coppice {

using NodeId = std::uint32_t;
inline constexpr NodeId no_node = std::numeric_limits<NodeId>::max();

template <int D>
class NeighbourGrid {
 public:
  /// `reach`, metres, above 0: the largest distance for collect_near and for_each_near.
  NeighbourGrid(const Box<D>& bounds, double reach) : lower_(bounds.lower), cell_(reach) {
    const Point<D> extent = (bounds.upper - bounds.lower).cwiseMax(0.0);
    // A map that is far larger than the reach must not exhaust the memory. Coarser cells only make look-ups
    // slower.
    while (cells_for(extent) > max_cells) cell_ *= 2;
    std::size_t total = 1;
    for (int d = 0; d < D; ++d) {
      size_[d] = static_cast<int>(extent[d] / cell_) + 1;
      total *= static_cast<std::size_t>(size_[d]);
    }
    head_.assign(total, no_block);
  }

  /// Nodes are numbered 0, 1, 2, ... in the order of their insertion.
  void insert(const Point<D>& p) {
    std::uint32_t& head = head_[offset(cell_of(p))];
    if (head == no_block || blocks_[head].size == block_size) {
      blocks_.push_back({.next = head});
      head = static_cast<std::uint32_t>(blocks_.size() - 1);
    }
    Block& block = blocks_[head];
    block.place[block.size] = p;
    block.node[block.size++] = count_++;
  }

  /// Frees spare memory of a grid that is kept for long.
  void shrink_to_fit() { blocks_.shrink_to_fit(); }

  /// Replaces the content of `out` by the nodes within `reach` of p, at most the grid's reach.
  void collect_near(const Point<D>& p, double reach, std::vector<NodeId>& out) const {
    // The nodes in the cells around are near or not as good as at random, so the loop avoids a branch on it.
    std::size_t count = 0;
    const auto [lo, hi] = around(cell_of(p), 1);
    for_each_cell(lo, hi, [&](const Cell& cell) {
      for (std::uint32_t b = head_[offset(cell)]; b != no_block; b = blocks_[b].next) {
        const Block& block = blocks_[b];
        if (out.size() < count + block_size) out.resize(2 * (count + block_size));
        for (std::uint32_t i = 0; i < block.size; ++i) {
          out[count] = block.node[i];
          count += (block.place[i] - p).squaredNorm() <= reach * reach;
        }
      }
    });
    out.resize(count);
  }

  /// Calls fn(node, position) for all nodes in the cells around p: all within the grid's reach of p, and some
  /// beyond.
  template <class Fn>
  void for_each_near(const Point<D>& p, Fn&& fn) const {
    const auto [lo, hi] = around(cell_of(p), 1);
    for_each_cell(lo, hi, [&](const Cell& cell) { visit(offset(cell), fn); });
  }

  /// The node nearest to p for which `wanted(node)` holds; no_node if there is none.
  template <class Wanted>
  NodeId nearest(const Point<D>& p, Wanted&& wanted) const {
    NodeId best = no_node;
    double best_squared = std::numeric_limits<double>::infinity();
    const Cell centre = cell_of(p);
    const int rings = *std::max_element(size_.begin(), size_.end());
    for (int ring = 0; ring < rings; ++ring) {
      // Nodes in this ring or beyond are at least ring - 1 cells away.
      const double nearest_possible = std::max(0, ring - 1) * cell_;
      if (nearest_possible * nearest_possible > best_squared) break;
      for_each_in_ring(centre, ring, [&](NodeId n, const Point<D>& place) {
        const double squared = (place - p).squaredNorm();
        if (squared >= best_squared || !wanted(n)) return;
        best_squared = squared;
        best = n;
      });
    }
    return best;
  }

 private:
  using Cell = std::array<int, D>;
  static constexpr std::uint32_t no_block = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t block_size = 6;
  struct Block {
    std::uint32_t next = no_block;
    std::uint32_t size = 0;
    std::array<NodeId, block_size> node{};
    std::array<Point<D>, block_size> place{};
  };
  static constexpr double max_cells = 1 << 22;  // 16 MiB of list heads

  double cells_for(const Point<D>& extent) const {
    double total = 1;
    for (int d = 0; d < D; ++d) total *= std::floor(extent[d] / cell_) + 1;
    return total;
  }

  Cell cell_of(const Point<D>& p) const {
    Cell cell;
    for (int d = 0; d < D; ++d) {
      cell[d] =
          static_cast<int>(std::clamp((p[d] - lower_[d]) / cell_, 0.0, static_cast<double>(size_[d] - 1)));
    }
    return cell;
  }

  std::size_t offset(const Cell& cell) const {
    std::size_t index = 0;
    for (int d = D - 1; d >= 0; --d) {
      index = index * static_cast<std::size_t>(size_[d]) + static_cast<std::size_t>(cell[d]);
    }
    return index;
  }

  template <class Fn>
  void visit(std::size_t cell, Fn&& fn) const {
    for (std::uint32_t b = head_[cell]; b != no_block; b = blocks_[b].next) {
      const Block& block = blocks_[b];
      for (std::uint32_t i = 0; i < block.size; ++i) fn(block.node[i], block.place[i]);
    }
  }

  template <class Fn>
  static void for_each_cell(const Cell& lo, const Cell& hi, Fn&& fn) {
    Cell cell = lo;
    while (true) {
      fn(cell);
      int d = 0;
      while (d < D && ++cell[d] > hi[d]) {
        cell[d] = lo[d];
        ++d;
      }
      if (d == D) return;
    }
  }

  template <class Fn>
  void for_each_in_ring(const Cell& centre, int ring, Fn&& fn) const {
    const auto [lo, hi] = around(centre, ring);
    for_each_cell(lo, hi, [&](const Cell& cell) {
      int distance = 0;
      for (int d = 0; d < D; ++d) distance = std::max(distance, std::abs(cell[d] - centre[d]));
      if (distance == ring) visit(offset(cell), fn);
    });
  }

  /// Corners of the block of cells within `reach` cells of the centre, clipped to the grid.
  std::pair<Cell, Cell> around(const Cell& centre, int reach) const {
    Cell lo;
    Cell hi;
    for (int d = 0; d < D; ++d) {
      lo[d] = std::max(centre[d] - reach, 0);
      hi[d] = std::min(centre[d] + reach, size_[d] - 1);
    }
    return {lo, hi};
  }

  Point<D> lower_;
  double cell_;
  Cell size_{};
  NodeId count_ = 0;
  std::vector<std::uint32_t> head_;  ///< by cell: its first block; only this one may have room
  std::vector<Block> blocks_;
};

}  // namespace coppice
