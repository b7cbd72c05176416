// What robots drove, point by point: kept in memory, or on disk, where a fleet of 200 writes 10 MB a minute;
// and looked at part by part, so that nobody needs it whole.
//
// Fleet time in seconds; metres in the map frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "motion/separation.h"

namespace coppice {

struct NamedTrack {
  std::string robot;
  Track track;
};

/// All robots, always in one order, from one time until before another. Tracks reach over both ends by a
/// point each, where there is one, so that it is known what happens there.
struct TrackPart {
  double from = 0;
  double until = 0;
  std::vector<NamedTrack> tracks;

  /// Not of the parts before and after it.
  bool holds(const TrackPoint& point) const { return point.time >= from && point.time < until; }
};

/// Calls its argument with each part of a run, one after the other.
using TrackParts = std::function<void(const std::function<void(const TrackPart&)>&)>;

/// A few megabytes each. `tracks` outlive it.
TrackParts in_parts(const std::vector<NamedTrack>& tracks);

class TrackRecord {
 public:
  /// In memory.
  TrackRecord() = default;
  /// In a file of this folder that has no name and vanishes with the process. Where there can be none, or the
  /// disk fills up, this is logged, and what follows stays in memory.
  static TrackRecord on_disk(const std::filesystem::path& folder);
  ~TrackRecord();
  TrackRecord(TrackRecord&& other) noexcept;
  TrackRecord& operator=(TrackRecord&& other) noexcept;
  TrackRecord(const TrackRecord&) = delete;
  TrackRecord& operator=(const TrackRecord&) = delete;

  /// Times grow. Robots are numbered.
  void append(std::size_t robot, const TrackPoint& point);
  std::size_t size(std::size_t robot) const { return robot < robots_.size() ? robots_[robot].size : 0; }
  std::optional<TrackPoint> last(std::size_t robot) const;

  /// A robot's points at or after `from` and before `until`, the one before these, and the one after them.
  std::vector<TrackPoint> around(std::size_t robot, double from, double until) const;
  /// Calls fn(from, until) for stretches of time that cover all points, each small beside a process's memory.
  void for_each_stretch(const std::function<void(double, double)>& fn) const;

 private:
  struct Block {
    double begin = 0;
    std::size_t size = 0;
    std::int64_t at = -1;  ///< in the file; below 0: not there
    std::vector<TrackPoint> points;
  };
  struct Robot {
    std::size_t size = 0;
    std::vector<Block> blocks;
    std::optional<TrackPoint> last;
  };

  void put_on_disk(Block& block);
  void read(const Block& block, std::vector<TrackPoint>& points) const;

  int descriptor_ = -1;
  std::int64_t end_ = 0;  ///< of the file; below 0: the disk is full
  std::vector<Robot> robots_;
};

}  // namespace coppice
