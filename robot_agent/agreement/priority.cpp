#include "robot_agent/agreement/priority.h"

#include <array>
#include <cmath>
#include <numbers>

#include "motion/trajectory/space_time.h"

namespace coppice {

namespace {

constexpr double winding = 1.4;  // of the straight line
constexpr int directions = 32;

}  // namespace

bool closes_a_passage(const Point2& p, double radius, const ClearanceField& field) {
  const double beside = kept_apart(radius, radius);  // metres between two robots that pass each other
  std::array<bool, directions> is_free{};
  for (std::size_t k = 0; k < directions; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / directions;
    is_free[k] = field.is_free(p + beside * Point2(std::cos(angle), std::sin(angle)), radius);
  }
  int parts = 0;
  for (std::size_t k = 0; k < directions; ++k)
    parts += is_free[k] && !is_free[(k + directions - 1) % directions];
  return parts > 1;
}

Priority priority_of(const Path& way, double radius, const ClearanceField& field) {
  if (length_of(way) > winding * (way.back() - way.front()).norm()) return Priority::winding;
  return closes_a_passage(way.back(), radius, field) ? Priority::last : Priority::usual;
}

bool plans_first(Priority priority, double way, const RobotName& robot, Priority other_priority,
                 double other_way, const RobotName& other) {
  if (priority != other_priority) return priority < other_priority;
  if (way != other_way) return priority == Priority::usual ? way < other_way : way > other_way;
  return robot < other;
}

}  // namespace coppice
