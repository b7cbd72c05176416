// Jump point search: A* on a grid that skips symmetric ways (Harabor, Grastien, "Online Graph Pruning for
// Pathfinding on Grid Maps", 2011), without steps that cut corners (Harabor, Grastien, "Improving Jump Point
// Search", 2014).
//
// The grid is that of grid_a_star.h, and the paths are as long as those of A*. Metres.
#pragma once

#include <vector>

#include "coppice/planning/clearance_field.h"

namespace coppice {

class JumpPointSearch {
 public:
  /// `field` must outlive it.
  explicit JumpPointSearch(const ClearanceField& field) : field_(field) {}

  /// The path over cell centres at which it turns, with start and goal; empty if there is none.
  Path path(const Point2& start, const Point2& goal, double radius);
  std::size_t expanded() const { return expanded_; }  ///< jump points expanded in all searches

 private:
  struct Cell {
    int x;
    int y;
    bool operator==(const Cell&) const = default;
  };
  struct Step {
    int x;
    int y;
  };

  std::size_t number(Cell c) const {
    return static_cast<std::size_t>(c.y) * static_cast<std::size_t>(field_.frame().width) +
           static_cast<std::size_t>(c.x);
  }
  Cell cell_at(std::size_t number) const;
  Cell cell_of(const Point2& p) const;
  Point2 place(Cell c) const;
  bool is_free(Cell c);
  bool may_step(Cell c, Step step);
  bool has_forced_neighbour(Cell c, Step step);
  bool opens(Cell c, Step step, int side);
  bool turns_off(Cell c, Step step);
  bool jump(Cell& c, Step step);
  std::vector<Step> directions(Cell c);

  enum class Known : char { nothing, free, blocked };

  const ClearanceField& field_;
  double radius_ = 0;
  Point2 start_place_ = Point2::Zero();
  Point2 goal_place_ = Point2::Zero();
  Cell start_{};
  Cell goal_{};
  std::vector<Known> known_{};  ///< by cell, for `radius_`
  std::vector<float> cost_{};
  std::vector<int> parent_{};
  std::vector<char> closed_{};
  std::size_t expanded_ = 0;
};

}  // namespace coppice
