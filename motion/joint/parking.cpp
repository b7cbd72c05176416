#include "motion/joint/parking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

// Limit of the close examination of parking positions for one robot: lattice vertices, some tens of
// milliseconds.
constexpr std::size_t most_effort = 3'000'000;
constexpr double apart = 0.5;  // radii between positions that are examined closely
// Radii: two, plus the clearance that a route keeps, plus what a lattice may miss.
constexpr double lane = 2.7;
constexpr double footprint = 5;  // area that a robot covers, in squares of its radius: more than pi

/// The first point of a way, approximately, that is at least `distance` from its beginning; its end if there
/// is none.
Point2 point_beyond(const Path& way, double distance) {
  constexpr int parts = 16;  // parts of a segment
  const auto is_beyond = [&](const Point2& q) { return (q - way[0]).norm() >= distance; };
  const auto end = std::ranges::find_if(way, is_beyond);
  if (end == way.end()) return way.back();
  for (int k = 1; k < parts; ++k) {
    const Point2 q = *(end - 1) + (*end - *(end - 1)) * k / parts;
    if (is_beyond(q)) return q;
  }
  return *end;
}

}  // namespace

Parking::Parking(Lattices& lattices, std::vector<Robot> robots)
    : lattices_(lattices),
      robots_(std::move(robots)),
      smallest_(std::numeric_limits<double>::infinity()),
      way_out_(robots_.size()) {
  for (const Robot& robot : robots_) {
    if (!robot.takes_part) continue;
    smallest_ = std::min(smallest_, robot.radius);
    largest_ = std::max(largest_, robot.radius);
  }
}

std::vector<std::size_t> Parking::left() const {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (robots_[i].takes_part && way_out_[i].empty()) all.push_back(i);
  }
  return all;
}

void Parking::park(std::size_t robot, const Path& way) {
  robots_[robot].at = way.back();
  way_out_[robot].assign(way.rbegin(), way.rend());
}

void Parking::begin_search(std::size_t robot) {
  robot_ = robot;
  asked_.clear();
  asks_until_ = lattices_.scouts.effort() + most_effort;
  groups_.clear();
}

Path Parking::way(std::size_t robot) {
  begin_search(robot);
  const Robot& self = robots_[robot];
  if (self.aim && closes_nothing(*self.aim)) {
    Path way = way_to_aim(robot);
    if (!way.empty()) return way;
  }
  if (closes_nothing(self.at)) return {self.at, self.at};
  return way_aside(robot);
}

Path Parking::way_aside(std::size_t robot) {
  begin_search(robot);
  RouteFinder& finder = lattices_.finders.of(robots_[robot].radius);
  const std::vector<Disc> discs = others(robot);
  const auto roomy = [&](const Point2& p) { return !overlaps(p) && can_be_driven_around(p); };
  Path way = finder.to_nearest(robots_[robot].at, discs, roomy);  // a cheap test
  if (!way.empty()) return way;
  return finder.to_nearest(robots_[robot].at, discs, [&](const Point2& p) { return closes_nothing(p); });
}

Path Parking::way_to_aim(std::size_t robot) {
  const Robot& self = robots_[robot];
  return lattices_.finders.of(self.radius).route(self.at, *self.aim, others(robot));
}

std::vector<Disc> Parking::others(std::size_t robot) const {
  std::vector<Disc> discs;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (i != robot) discs.push_back({robots_[i].at, robots_[i].radius});
  }
  return discs;
}

bool Parking::closes_nothing(const Point2& place) {
  if (overlaps(place)) return false;
  if (can_be_driven_around(place)) return true;
  const double near = apart * robots_[robot_].radius;
  const bool alike = std::ranges::any_of(asked_, [&](const Point2& p) { return (p - place).norm() < near; });
  if (alike || lattices_.scouts.effort() > asks_until_) return false;
  asked_.push_back(place);
  return keeps_all_connected(place);
}

/// Whether the position overlaps another robot's aim, or the way out of its parking position.
bool Parking::overlaps(const Point2& place) const {
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (i == robot_ || !robots_[i].takes_part) continue;
    const double distance = robots_[robot_].radius + robots_[i].radius + standing_gap;
    if (robots_[i].aim && (*robots_[i].aim - place).norm() < distance) return true;
    if (way_out_[i].empty()) continue;
    const Point2 gate = point_beyond(way_out_[i], distance);
    if (point_segment_distance(place, robots_[i].at, gate) < distance) return true;
  }
  return false;
}

/// Whether the largest robot could drive around the position, past all standing robots and all aims. Then
/// each way over the position can be replaced by a way around it.
bool Parking::can_be_driven_around(const Point2& place) const {
  const double room = robots_[robot_].radius + lane * largest_;
  if (!lattices_.field.is_free(place, room)) return false;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (i == robot_) continue;
    const double distance = room + robots_[i].radius;
    if ((robots_[i].at - place).norm() < distance) return false;
    if (robots_[i].takes_part && robots_[i].aim && (*robots_[i].aim - place).norm() < distance) return false;
  }
  return true;
}

/// The robots that do not move any more.
std::vector<Disc> Parking::standing() const {
  std::vector<Disc> discs;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (i != robot_ && (!robots_[i].takes_part || !way_out_[i].empty()))
      discs.push_back({robots_[i].at, robots_[i].radius});
  }
  return discs;
}

/// The points that must stay connected: positions of the robots that still have to move, their aims, and
/// where parked robots come out.
std::vector<Point2> Parking::to_be_connected() const {
  std::vector<Point2> places;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (!robots_[i].takes_part || i == robot_) continue;
    if (robots_[i].aim) places.push_back(*robots_[i].aim);
    const double beside = robots_[i].radius + largest_ + standing_gap;
    places.push_back(way_out_[i].empty() ? robots_[i].at : point_beyond(way_out_[i], beside));
  }
  return places;
}

/// Groups of points that are connected past all standing robots, for a robot of `radius`.
std::vector<Parking::Group> Parking::groups(double radius) {
  const std::vector<Disc> discs = standing();
  RouteFinder& scout = lattices_.scouts.of(radius);
  std::vector<Point2> left = to_be_connected();
  std::vector<Group> all;
  while (!left.empty()) {
    const std::size_t room = scout.flood(left.back(), discs);
    const auto elsewhere = [&](const Point2& p) { return p != left.back() && !scout.flooded(p); };
    const auto group = std::partition(left.begin(), left.end() - 1, elsewhere);
    all.push_back({{group, left.end()}, room});
    left.erase(group, left.end());
  }
  return all;
}

/// Whether all groups of connected points stay connected if a robot parks at the position, for the smallest
/// and for the largest robot, and whether the position takes away no more of the free space than the robot
/// covers.
bool Parking::keeps_all_connected(const Point2& place) {
  if (groups_.empty()) {
    for (const double radius : {smallest_, largest_}) groups_.try_emplace(radius, groups(radius));
  }
  std::vector<Disc> discs = standing();
  discs.push_back({place, robots_[robot_].radius});
  return std::ranges::all_of(groups_, [&](const auto& of_size) {
    const auto& [radius, groups] = of_size;
    RouteFinder& scout = lattices_.scouts.of(radius);
    const double covered = footprint * std::pow((radius + robots_[robot_].radius) / scout.spacing(), 2);
    return std::ranges::all_of(groups, [&](const Group& group) {
      const std::size_t room = scout.flood(group.places.front(), discs);
      return static_cast<double>(room) >= static_cast<double>(group.room) - covered &&
             std::ranges::all_of(group.places, [&](const Point2& p) { return scout.flooded(p); });
    });
  });
}

}  // namespace coppice
