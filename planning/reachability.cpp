#include "planning/reachability.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace coppice {

namespace {

constexpr int patches_a_cell = 4;

/// The patches of a map, numbered row by row.
class Patches {
 public:
  Patches(const ClearanceField& field, double radius)
      : field_(field),
        radius_(radius),
        side_(field.frame().resolution / patches_a_cell),
        width_(field.frame().width * patches_a_cell),
        height_(field.frame().height * patches_a_cell) {}

  std::size_t count() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
  int width() const { return width_; }
  int height() const { return height_; }

  std::size_t at(const Point2& p) const {
    const Point2 cell = (p - field_.frame().origin) / side_;
    return index(std::clamp(static_cast<int>(cell.x()), 0, width_ - 1),
                 std::clamp(static_cast<int>(cell.y()), 0, height_ - 1));
  }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(i);
  }

  /// Clearance changes by at most the distance: if the disc fits anywhere in the patch, it nearly fits at its
  /// centre.
  bool might_fit(int i, int j) const {
    const Point2 centre = field_.frame().origin + side_ * Point2(i + 0.5, j + 0.5);
    const double least = radius_ - side_ * std::sqrt(0.5) - 1e-9;
    return least <= 0 || field_.is_free(centre, least);
  }

 private:
  const ClearanceField& field_;
  double radius_;
  double side_;
  int width_;
  int height_;
};

}  // namespace

bool provably_unreachable(const ClearanceField& field, const Point2& start, const Point2& goal,
                          double radius) {
  const Patches patches(field, radius);
  const std::size_t target = patches.at(goal);
  std::vector<std::uint8_t> seen(patches.count(), 0);
  std::vector<std::size_t> open{patches.at(start)};
  seen[open.front()] = 1;
  while (!open.empty()) {
    const std::size_t here = open.back();
    open.pop_back();
    if (here == target) return false;
    const int i = static_cast<int>(here % static_cast<std::size_t>(patches.width()));
    const int j = static_cast<int>(here / static_cast<std::size_t>(patches.width()));
    for (int v = std::max(j - 1, 0); v <= std::min(j + 1, patches.height() - 1); ++v) {
      for (int u = std::max(i - 1, 0); u <= std::min(i + 1, patches.width() - 1); ++u) {
        std::uint8_t& mark = seen[patches.index(u, v)];
        if (mark != 0) continue;
        mark = 1;
        if (patches.index(u, v) == target || patches.might_fit(u, v)) open.push_back(patches.index(u, v));
      }
    }
  }
  return true;
}

}  // namespace coppice
