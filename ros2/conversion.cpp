#include "ros2/conversion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "planning/quantities.h"
#include "ros2/names.h"

namespace coppice {

namespace {

constexpr double standing = 1e-3;  // m/s; a slower robot has no direction of motion

bool sane(const Point2& p) {
  return is_sane(p.x()) && is_sane(p.y());
}

}  // namespace

OccupancyMap with_y_up(const OccupancyMap& map) {
  if (map.y_axis == YAxis::up) return map;
  OccupancyMap up = map;
  up.y_axis = YAxis::up;
  up.origin.y() = -(map.origin.y() + map.height * map.resolution);
  const auto width = static_cast<std::ptrdiff_t>(map.width);
  for (std::ptrdiff_t j = 0; j < map.height; ++j) {
    const auto row = map.blocked.begin() + j * width;
    std::copy(row, row + width, up.blocked.begin() + (map.height - 1 - j) * width);
  }
  return up;
}

Point2 into_robot(const Point2& v, double yaw) {
  return out_of_robot(v, -yaw);
}

Point2 out_of_robot(const Point2& v, double yaw) {
  return rotated(v, yaw);
}

double yaw_of(double x, double y, double z, double w) {
  return std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

std::optional<std::string> problem_with(const RosOdometry& seen, const std::string& map_frame) {
  if (seen.frame != map_frame) return "its frame_id is not \"" + map_frame + "\"";
  const auto& [linear, angular] = seen.twist;
  if (!sane(seen.pose.position) || !sane(linear) || !is_sane(angular))
    return "its position or velocity is out of range";
  if (!is_sane(seen.pose.yaw)) return "its orientation is not valid";
  return std::nullopt;
}

std::optional<std::string> problem_with(const RosGoal& goal, const std::string& map_frame) {
  if (goal.frame != map_frame && !goal.frame.empty()) return "its frame_id is not \"" + map_frame + "\"";
  if (!sane(goal.position)) return "its position is out of range";
  if (goal.yaw && !is_sane(*goal.yaw)) return "its orientation is not valid";
  return std::nullopt;
}

double Heading::facing(const Point2& velocity) {
  if (velocity.norm() > standing) yaw_ = std::atan2(velocity.y(), velocity.x());
  return yaw_;
}

}  // namespace coppice
