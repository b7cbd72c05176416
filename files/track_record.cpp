#include "files/track_record.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

constexpr std::size_t points_a_block = 64;
constexpr double stretch = 2;  // seconds; a part of 200 robots takes about 0.5 MB, with the points around it

/// A point as it is stored on disk: time, x, y, velocity x, velocity y, yaw, angular velocity.
using Row = std::array<double, 7>;

/// The points at or after `from` and before `until`, and the points just before and after them.
std::vector<TrackPoint> around(const std::vector<TrackPoint>& points, double from, double until) {
  const auto is_before = [&](double time) {
    return std::ranges::partition_point(points, [&](const TrackPoint& p) { return p.time < time; });
  };
  const auto first = is_before(from);
  const auto last = is_before(until);
  return {first == points.begin() ? first : first - 1, last == points.end() ? last : last + 1};
}

}  // namespace

TrackParts in_parts(const std::vector<NamedTrack>& tracks) {
  return [&tracks](const std::function<void(const TrackPart&)>& fn) {
    double begin = std::numeric_limits<double>::infinity();
    double end = -begin;
    for (const NamedTrack& named : tracks) {
      if (named.track.points.empty()) continue;
      begin = std::min(begin, named.track.points.front().time);
      end = std::max(end, named.track.points.back().time);
    }
    for (double from = begin; from <= end; from += stretch) {
      TrackPart part{from, from + stretch, {}};
      for (const NamedTrack& named : tracks)
        part.tracks.push_back(
            {named.robot, {named.track.radius, around(named.track.points, from, from + stretch)}});
      fn(part);
    }
  };
}

TrackRecord TrackRecord::on_disk(const std::filesystem::path& folder) {
  std::string name = (folder / "coppice-tracks-XXXXXX").string();
  TrackRecord record;
  record.descriptor_ = ::mkstemp(name.data());
  if (record.descriptor_ >= 0) {
    ::unlink(name.c_str());
  } else {
    spdlog::warn("{}: no file for the robots' tracks can be made there: they stay in memory ({})",
                 folder.string(), std::system_category().message(errno));
  }
  return record;
}

TrackRecord::~TrackRecord() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

TrackRecord::TrackRecord(TrackRecord&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      end_(other.end_),
      free_(std::move(other.free_)),
      has_told_(other.has_told_),
      robots_(std::move(other.robots_)) {}

TrackRecord& TrackRecord::operator=(TrackRecord&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(end_, other.end_);
  std::swap(free_, other.free_);
  std::swap(has_told_, other.has_told_);
  std::swap(robots_, other.robots_);
  return *this;
}

void TrackRecord::append(std::size_t robot, const TrackPoint& point) {
  if (robot >= robots_.size()) robots_.resize(robot + 1);
  Robot& r = robots_[robot];
  ++r.size;
  ++r.held;
  r.last = point;
  if (r.blocks.empty() || r.blocks.back().size == points_a_block) {
    if (!r.blocks.empty()) put_on_disk(r.blocks.back());
    r.blocks.push_back({.begin = point.time, .points = {}});
    r.blocks.back().points.reserve(points_a_block);
  }
  r.blocks.back().points.push_back(point);
  ++r.blocks.back().size;
}

void TrackRecord::put_on_disk(Block& block) {
  if (descriptor_ < 0) return;
  std::vector<Row> rows;
  for (const TrackPoint& p : block.points)
    rows.push_back(
        {p.time, p.position.x(), p.position.y(), p.velocity.x(), p.velocity.y(), p.yaw, p.angular_velocity});
  const std::size_t bytes = rows.size() * sizeof(Row);
  const std::int64_t place = free_.empty() ? end_ : free_.back();
  const ::ssize_t written = ::pwrite(descriptor_, rows.data(), bytes, place);
  if (written != static_cast<::ssize_t>(bytes)) {
    if (!std::exchange(has_told_, true))
      spdlog::error("no room for the robots' tracks on disk: they stay in memory ({})",
                    std::system_category().message(written < 0 ? errno : ENOSPC));
    return;
  }
  has_told_ = false;
  if (free_.empty()) {
    end_ += static_cast<std::int64_t>(bytes);
  } else {
    free_.pop_back();
  }
  block.at = place;
  block.points = std::vector<TrackPoint>();  // frees the memory, which `= {}` would keep
}

/// A block on disk is full, so that another one fits into its place.
void TrackRecord::forget(const Block& block) {
  if (block.at >= 0) free_.push_back(block.at);
}

void TrackRecord::forget_before(double time) {
  for (Robot& robot : robots_) {
    while (robot.blocks.size() > 1 && robot.blocks[1].begin < time) {
      robot.held -= robot.blocks.front().size;
      forget(robot.blocks.front());
      robot.blocks.pop_front();
    }
  }
}

void TrackRecord::count_forgotten(std::size_t robot, std::size_t points) {
  if (robot >= robots_.size()) robots_.resize(robot + 1);
  robots_[robot].size += points;
}

std::size_t TrackRecord::held(std::size_t robot) const {
  return robot < robots_.size() ? robots_[robot].held : 0;
}

std::optional<TrackPoint> TrackRecord::last(std::size_t robot) const {
  return robot < robots_.size() ? robots_[robot].last : std::nullopt;
}

void TrackRecord::read(const Block& block, std::vector<TrackPoint>& points) const {
  if (block.at < 0) {
    points.insert(points.end(), block.points.begin(), block.points.end());
    return;
  }
  std::vector<Row> rows(block.size);
  const std::size_t bytes = rows.size() * sizeof(Row);
  if (::pread(descriptor_, rows.data(), bytes, block.at) != static_cast<::ssize_t>(bytes))
    throw InputError("the robots' tracks cannot be read back from disk");
  for (const auto& [time, x, y, vx, vy, yaw, omega] : rows)
    points.push_back({time, {x, y}, {vx, vy}, yaw, omega});
}

std::vector<TrackPoint> TrackRecord::around(std::size_t robot, double from, double until) const {
  std::vector<TrackPoint> points;
  if (robot >= robots_.size()) return points;
  const std::deque<Block>& blocks = robots_[robot].blocks;
  const auto begins_before = [&](double time) {
    return std::ranges::partition_point(blocks, [&](const Block& block) { return block.begin < time; });
  };
  auto block = begins_before(from);
  if (block != blocks.begin()) --block;
  const auto after = begins_before(until);
  const auto end = after == blocks.end() ? after : after + 1;
  for (; block < end; ++block) read(*block, points);

  return coppice::around(points, from, until);
}

void TrackRecord::for_each_stretch(const std::function<void(double, double)>& fn, double earliest) const {
  double begin = std::numeric_limits<double>::infinity();
  double end = -begin;
  for (const Robot& robot : robots_) {
    if (robot.blocks.empty()) continue;
    begin = std::min(begin, robot.blocks.front().begin);
    end = std::max(end, robot.last->time);
  }
  for (double from = std::max(begin, earliest); from <= end; from += stretch) fn(from, from + stretch);
}

}  // namespace coppice
