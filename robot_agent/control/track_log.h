// The track of a robot in one run, as far as it has not been sent.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"
#include "motion/body/driver.h"

namespace coppice {

/// What a body does in the period that begins.
inline TrackMessage::Point point_of(const Driver& body) {
  return {body.time(), body.position(), body.velocity(), body.yaw(), body.angular_velocity()};
}

class TrackLog {
 public:
  TrackLog() = default;
  /// Begins with the last points that the process before this one recorded. `first_index`: of the first one
  /// among all of this run.
  TrackLog(std::vector<TrackMessage::Point> points, std::uint32_t first_index)
      : points_(std::move(points)), sent_(first_index) {}

  void add(const TrackMessage::Point& point) { points_.push_back(point); }
  bool empty() const { return points_.empty(); }
  bool fills_a_batch() const { return points_.size() >= batch; }
  const TrackMessage::Point& last() const { return points_.back(); }
  /// Points that were sent.
  std::uint32_t sent() const { return sent_; }
  /// The points that were not sent, and some before them that may be lost with the process.
  TrackMessage rest(const RobotName& robot, std::uint32_t mission, const RunId& run) const {
    TrackMessage message{robot, mission, sent_ - static_cast<std::uint32_t>(last_sent_.size()), last_sent_,
                         run};
    message.points.insert(message.points.end(), points_.begin(), points_.end());
    return message;
  }

  /// Sends all points, in messages of bounded size.
  void send(const RobotName& robot, std::uint32_t mission, const RunId& run, std::vector<Outgoing>& out) {
    for (std::size_t from = 0; from < points_.size(); from += longest_message) {
      const std::size_t to = std::min(points_.size(), from + longest_message);
      TrackMessage message{robot, mission, sent_, {}, run};
      message.points.assign(points_.begin() + static_cast<std::ptrdiff_t>(from),
                            points_.begin() + static_cast<std::ptrdiff_t>(to));
      sent_ += static_cast<std::uint32_t>(message.points.size());
      out.emplace_back(std::move(message));
    }
    last_sent_.assign(points_.end() - static_cast<std::ptrdiff_t>(std::min(points_.size(), batch)),
                      points_.end());
    points_.clear();
  }

 private:
  static constexpr std::size_t batch = 10;                // half a second of fleet time
  static constexpr std::size_t longest_message = 10'000;  // points

  std::vector<TrackMessage::Point> points_{};
  std::vector<TrackMessage::Point> last_sent_{};
  std::uint32_t sent_ = 0;  ///< of all of this run, also by processes before this one
};

}  // namespace coppice
