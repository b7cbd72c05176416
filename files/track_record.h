// The tracks of robots, point by point, in memory or on disk. A fleet of 200 robots records 10 MB a minute,
// so tracks are read part by part. A fleet that runs for days forgets the points that it has counted.
//
// Fleet time in seconds; metres in the map frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "coppice/motion/separation.h"

namespace coppice {

struct NamedTrack {
  std::string robot;
  Track track;
};

/// The tracks of all robots from one time until before another, always in the same order of robots. Each
/// track includes the last point before and the first point after that time, if any, so that the motion at
/// both ends is known.
struct TrackPart {
  double from = 0;
  double until = 0;
  std::vector<NamedTrack> tracks;

  /// Whether the point belongs to this part, and not to the part before or after it.
  bool holds(const TrackPoint& point) const { return point.time >= from && point.time < until; }
};

/// Calls its argument with each part of a run, in order of time.
using TrackParts = std::function<void(const std::function<void(const TrackPart&)>&)>;

/// Splits tracks into parts of a few megabytes. `tracks` must outlive the result.
TrackParts in_parts(const std::vector<NamedTrack>& tracks);

class TrackRecord {
 public:
  /// Keeps the tracks in memory.
  TrackRecord() = default;
  /// Keeps the tracks in an unnamed file of this folder that vanishes with the process. If the file cannot be
  /// made, that is logged and points stay in memory. So do those for which the disk has no room.
  static TrackRecord on_disk(const std::filesystem::path& folder);
  ~TrackRecord();
  TrackRecord(TrackRecord&& other) noexcept;
  TrackRecord& operator=(TrackRecord&& other) noexcept;
  TrackRecord(const TrackRecord&) = delete;
  TrackRecord& operator=(const TrackRecord&) = delete;

  /// Appends a point. Times must grow. Robots are numbered from 0.
  void append(std::size_t robot, const TrackPoint& point);
  /// Forgets the points before that time, except the last one of each robot before it.
  void forget_before(double time);
  /// Points of a robot that were appended, also those that were forgotten.
  std::size_t size(std::size_t robot) const { return robot < robots_.size() ? robots_[robot].size : 0; }
  /// Counts points that were recorded and forgotten by a process before this one.
  void count_forgotten(std::size_t robot, std::size_t points);
  /// Points of a robot that it holds.
  std::size_t held(std::size_t robot) const;
  std::optional<TrackPoint> last(std::size_t robot) const;

  /// A robot's points at or after `from` and before `until`, and the points just before and after them.
  /// Throws InputError if the disk cannot be read.
  std::vector<TrackPoint> around(std::size_t robot, double from, double until) const;
  /// Calls fn(from, until) for intervals of time that together cover all points from `earliest` on. The
  /// points of an interval are small compared with a process's memory.
  void for_each_stretch(const std::function<void(double, double)>& fn,
                        double earliest = -std::numeric_limits<double>::infinity()) const;

 private:
  struct Block {
    double begin = 0;
    std::size_t size = 0;
    std::int64_t at = -1;  ///< offset in the file, bytes; below 0: in memory
    std::vector<TrackPoint> points;
  };
  struct Robot {
    std::size_t size = 0;
    std::size_t held = 0;
    std::deque<Block> blocks;
    std::optional<TrackPoint> last;
  };

  void put_on_disk(Block& block);
  void forget(const Block& block);
  void read(const Block& block, std::vector<TrackPoint>& points) const;

  int descriptor_ = -1;
  std::int64_t end_ = 0;              ///< size of the file, bytes
  std::vector<std::int64_t> free_{};  ///< places of blocks in the file that were forgotten
  bool has_told_ = false;             ///< that the disk is full
  std::vector<Robot> robots_;
};

}  // namespace coppice
