#include "motion/joint/straightening.h"

#include <algorithm>
#include <cstddef>

#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr int rounds = 3;
constexpr std::size_t longest_window = 16;  // moves that are laid onto one line at once

class Straightener {
 public:
  Straightener(const ClearanceField& field, std::span<const JointTask> tasks, std::span<const Move> moves)
      : field_(field), tasks_(tasks), own_(tasks.size()) {
    for (const JointTask& task : tasks) around_.push_back({task.position, task.position});
    for (const Move& move : moves) {
      for (const Point2& p : move.path) around_[move.robot] = extended(around_[move.robot], p);
      for (std::size_t k = 1; k < move.path.size(); ++k) {
        own_[move.robot].push_back(moves_.size());
        moves_.push_back({move.robot, {move.path[k - 1], move.path[k]}});
      }
    }
  }

  /// Straightens windows of moves, as long as possible, one after the other.
  void straighten(std::size_t robot) {
    const std::size_t count = own_[robot].size();
    for (std::size_t first = 0; first + 1 < count;) {
      std::size_t window = std::min(longest_window, count - first);
      while (window > 1 && !lay_straight(robot, first, window))
        window = (window + 1) / 2 == window ? 1 : (window + 1) / 2;
      first += std::max<std::size_t>(1, window - 1);
    }
  }

  /// The moves without those of length 0; consecutive moves of a robot are joined.
  std::vector<Move> result() {
    std::vector<Move> result;
    for (Move& move : moves_) {
      if (length_of(move.path) == 0) continue;
      if (!result.empty() && result.back().robot == move.robot) {
        result.back().path.insert(result.back().path.end(), move.path.begin() + 1, move.path.end());
      } else {
        result.push_back(std::move(move));
      }
    }
    return result;
  }

 private:
  const Path& path(std::size_t robot, std::size_t k) const { return moves_[own_[robot][k]].path; }

  /// Lays `window` moves of a robot, from its `first` on, onto one line. Returns false if that is not
  /// possible.
  bool lay_straight(std::size_t robot, std::size_t first, std::size_t window) {
    const Point2 from = path(robot, first).front();
    const Point2 to = path(robot, first + window - 1).back();
    double length = 0;
    for (std::size_t k = 0; k < window; ++k) length += length_of(path(robot, first + k));
    if (length - (to - from).norm() < 1e-6 || !field_.segment_free(from, to, tasks_[robot].radius))
      return false;
    std::vector<Point2> line{from};
    double along = 0;
    for (std::size_t k = 0; k + 1 < window; ++k) {
      along += length_of(path(robot, first + k));
      line.push_back(from + (to - from) * (along / length));
    }
    line.push_back(to);
    const Box<2> box = extended(Box<2>{from, from}, to);
    for (std::size_t other = 0; other < tasks_.size(); ++other) {
      if (other == robot || distance(box, around_[other]) >= room(robot, other)) continue;
      if (!clear_of(other, robot, first, line)) return false;
    }
    for (std::size_t k = 0; k < window; ++k) moves_[own_[robot][first + k]].path = {line[k], line[k + 1]};
    return true;
  }

  /// Metres that the centre of a straightened robot keeps from the centre of another.
  double room(std::size_t robot, std::size_t other) const {
    return tasks_[robot].radius * (1 + comfort_radii) + tasks_[other].radius + standing_gap;
  }

  /// Whether `robot` on the line stays clear of another robot, in the plan's order.
  bool clear_of(std::size_t other, std::size_t robot, std::size_t first,
                const std::vector<Point2>& line) const {
    const double need = room(robot, other);
    const std::vector<std::size_t>& theirs = own_[other];
    auto next = std::ranges::lower_bound(theirs, own_[robot][first]);
    Point2 there = next == theirs.begin() ? tasks_[other].position : moves_[*(next - 1)].path.back();
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      for (; next != theirs.end() && *next < own_[robot][first + k]; ++next) {
        if (point_path_distance(line[k], moves_[*next].path) < need) return false;
        there = moves_[*next].path.back();
      }
      if (point_segment_distance(there, line[k], line[k + 1]) < need) return false;
    }
    return true;
  }

  const ClearanceField& field_;
  std::span<const JointTask> tasks_;
  std::vector<Move> moves_;                    ///< each along one straight segment
  std::vector<std::vector<std::size_t>> own_;  ///< by robot: indices of its moves
  std::vector<Box<2>> around_;                 ///< by robot: a box that its straightened ways do not leave
};

}  // namespace

std::vector<Move> straightened(const ClearanceField& field, std::span<const JointTask> tasks,
                               std::span<const Move> moves) {
  Straightener straightener(field, tasks, moves);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t robot = 0; robot < tasks.size(); ++robot) straightener.straighten(robot);
  }
  return straightener.result();
}

}  // namespace coppice
