// The way that a robot has come since it last saw its path. Back along this trail the robot finds its path
// again, also from a nook that no sampled path leads out of.
//
// Metres in the map frame.
#pragma once

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "planning/geometry/free_way.h"

namespace coppice {

class Trail {
 public:
  void begin(const Point2& p) { points_.assign(1, p); }
  /// The robot has driven straight to p, along a way that keeps `radius` clear.
  void go_on(const Point2& p, const ClearanceField& field, double radius) {
    if (points_.empty()) return begin(p);
    if (p == points_.back()) return;
    if (points_.size() > 1 && way_free(field, points_[points_.size() - 2], p, radius)) points_.pop_back();
    points_.push_back(p);
  }

  /// The way from the last position to the first, along straight lines that keep the radius clear.
  Path back() const { return {points_.rbegin(), points_.rend()}; }

 private:
  Path points_;
};

}  // namespace coppice
