#include "motion/joint/joint_schedule.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ranges>
#include <utility>

#include "motion/lattice/safe_interval_search.h"
#include "motion/trajectory/corner_speed.h"

namespace coppice {

namespace {

constexpr std::size_t moves_a_step = 500;
constexpr std::size_t searches_a_step = 4;
constexpr double rounding = 1e-9;
constexpr double worthwhile = 0.01;  // seconds that an arrival must be earlier

double time_lost_at(const Point2& before, const Point2& corner, const Point2& after,
                    const JointSchedule::Robot& robot) {
  return time_lost_around((corner - before).normalized(), (after - corner).normalized(),
                          reserved_stray_radii * robot.radius, robot.limits);
}

/// A robot drives along a path from time 0 on, at full speed but for corners.
Trajectory drive_along(const Path& path, const JointSchedule::Robot& robot) {
  Trajectory drive{{0, path.front()}};
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double length = (path[k] - path[k - 1]).norm();
    if (length == 0) continue;
    if (drive.size() > 1) {
      const double lost = time_lost_at(drive[drive.size() - 2].position, path[k - 1], path[k], robot);
      if (lost > 0) drive.push_back({drive.back().time + lost, path[k - 1]});
    }
    drive.push_back({drive.back().time + length / robot.limits.max_speed, path[k]});
  }
  return drive;
}

/// Seconds that a robot loses at the corner between its trajectory so far and what comes next.
double time_lost_between(const Trajectory& so_far, const Path& next, const JointSchedule::Robot& robot) {
  return so_far.size() > 1 ? time_lost_at(so_far[so_far.size() - 2].position, next[0], next[1], robot) : 0;
}

double touching(double radius, double other_radius) {
  return radius + other_radius - rounding;
}

}  // namespace

JointSchedule::JointSchedule(MapRoadmaps& roadmaps, std::vector<Robot> robots, std::vector<Move> moves,
                             std::vector<Other> others, std::vector<Disc> obstacles, double begin,
                             double seconds_a_step)
    : roadmaps_(roadmaps),
      robots_(std::move(robots)),
      moves_(std::move(moves)),
      others_(std::move(others)),
      obstacles_(std::move(obstacles)),
      begin_(begin),
      seconds_a_step_(seconds_a_step) {
  begin_anew();
}

void JointSchedule::begin_anew() {
  scheduled_ = 0;
  taken_.clear();
  trajectories_.clear();
  for (const Robot& robot : robots_) trajectories_.push_back({{begin_, robot.start}});
}

bool JointSchedule::step() {
  if (!has_times()) {
    for (std::size_t k = 0; k < moves_a_step && scheduled_ < moves_.size(); ++k)
      schedule(moves_[scheduled_++]);
    return false;
  }
  taken_.clear();
  for (std::size_t k = 0; k < searches_a_step && next_ < robots_.size(); ++k) improve(next_++);
  if (next_ < robots_.size()) return false;
  next_ = 0;
  return std::exchange(saved_, 0) <= cost_of_a_pass();
}

double JointSchedule::sum_of_arrivals() const {
  double sum = 0;
  for (const Trajectory& trajectory : trajectories_) sum += trajectory.back().time;
  return sum;
}

/// Seconds that all robots together wait for a pass over all robots.
double JointSchedule::cost_of_a_pass() const {
  const auto robots = static_cast<double>(robots_.size());
  return robots * seconds_a_step_ * std::ceil(robots / static_cast<double>(searches_a_step));
}

/// The moves lead past the obstacles anyway.
JointSchedule::Taken& JointSchedule::taken_for(double radius) {
  const Box<2> bounds = roadmaps_.field().bounds();
  const auto [at, is_new] = taken_.try_emplace(radius);
  Taken& taken = at->second;
  if (!is_new) return taken;
  taken.emplace_back(bounds, radius);
  if (const double margin = roadmaps_.field().inflation(); margin > 0)
    taken.emplace_back(bounds, radius, [margin](double a, double b) { return touching(a, b) + margin; });
  taken.emplace_back(bounds, radius, touching);
  for (SpaceTime& space : taken) {
    for (const Other& other : others_) {
      if (!other.gives_way) space.add(other.trajectory, other.radius);
    }
    for (std::uint32_t k = 0; k < robots_.size(); ++k) space.add(trajectories_[k], robots_[k].radius, k);
  }
  return taken;
}

void JointSchedule::schedule(const Move& move) {
  for (const Robot& robot : robots_) taken_for(robot.radius);
  const Robot& robot = robots_[move.robot];
  Taken& taken = taken_for(robot.radius);
  Trajectory& own = trajectories_[move.robot];
  const Trajectory drive = drive_along(move.path, robot);
  const double ready = own.back().time + time_lost_between(own, move.path, robot);
  double time = SpaceTime::forever;
  for (auto space = taken.begin(); space != taken.end() && time == SpaceTime::forever; ++space)
    time = departure(*space, move.robot, drive, ready);
  if (time == SpaceTime::forever) {
    if (let_give_way(move)) return begin_anew();
    time = ready;  // the members' moves are free in this order, but for rounding
  }
  const Trajectory rest = shifted(drive, time);
  for (auto& [radius, other] : taken_) {
    for (SpaceTime& space : other) space.go_on(static_cast<std::uint32_t>(move.robot), rest, robot.radius);
  }
  own.insert(own.end(), rest.begin() + (rest.front().time > own.back().time ? 0 : 1), rest.end());
}

/// Lets those give way that end in the way of a move. Returns whether any of them did not yet.
bool JointSchedule::let_give_way(const Move& move) {
  bool is_news = false;
  for (Other& other : others_) {
    const double near = touching(robots_[move.robot].radius, other.radius);
    const bool in_the_way = point_path_distance(other.trajectory.back().position, move.path) < near;
    is_news = is_news || (in_the_way && !other.gives_way);
    other.gives_way = other.gives_way || in_the_way;
  }
  return is_news;
}

/// A robot may also wait where another one is to pass.
std::vector<std::size_t> JointSchedule::passed() const {
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < others_.size(); ++k) {
    const Other& other = others_[k];
    const auto is_met = [&](std::size_t i) {
      return come_too_close(trajectories_[i], other.trajectory, touching(robots_[i].radius, other.radius),
                            begin_);
    };
    if (!other.gives_way && std::ranges::none_of(std::views::iota(std::size_t{0}, robots_.size()), is_met))
      result.push_back(k);
  }
  return result;
}

/// The first time at which a robot may set off.
double JointSchedule::departure(SpaceTime& taken, std::size_t k, const Trajectory& drive,
                                double ready) const {
  const auto number = static_cast<std::uint32_t>(k);
  std::vector<Interval> blocked;
  taken.blocked_at(drive.back().position, blocked, number);
  double arrival = ready;
  for (const Interval& i : blocked) arrival = std::max(arrival, i.end);
  const double first = std::max(ready, arrival - drive.back().time);
  const auto free_from = [&](double time) {
    for (bool is_free = false; !is_free && time < SpaceTime::forever;) {
      is_free = true;
      for (std::size_t i = 1; i < drive.size(); ++i) {
        const TimedPoint& from = drive[i - 1];
        const TimedPoint& to = drive[i];
        const double free =
            taken.first_departure(from.position, to.position, to.time - from.time, time + from.time, number);
        if (free <= time + from.time + rounding) continue;
        time = free - from.time;
        is_free = false;
      }
    }
    return time;
  };
  const double time = free_from(first);
  const bool waits = time > ready && time < SpaceTime::forever;
  return waits ? free_from(time + speeding_up(robots_[k].limits)) : time;
}

/// One robot plans again around all others.
void JointSchedule::improve(std::size_t k) {
  const Robot& robot = robots_[k];
  Trajectory& own = trajectories_[k];
  if (own.back().position == robot.start || !roadmaps_.has_lattice(robot.radius)) return;
  SpaceTime taken(roadmaps_.field().bounds(), robot.radius);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (i != k) taken.add(trajectories_[i], robots_[i].radius);
  }
  for (const Other& other : others_) {
    if (!other.gives_way) taken.add(other.trajectory, other.radius);
  }
  for (const Disc& disc : obstacles_) taken.add_obstacle(disc);
  taken.start_at(robot.start, begin_);
  SafeIntervalSearch search(roadmaps_.field(), roadmaps_.lattice(robot.radius), robot.radius, path_of(own));
  auto found = search.search(taken, begin_, robot.limits, own.back().time - worthwhile);
  if (!found || found->size() < 2) return;
  saved_ += own.back().time - found->back().time;
  own = *std::move(found);
}

}  // namespace coppice
