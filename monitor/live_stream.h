// What all pages are told alike (idl/live.proto), encoded once for all of them: who the robots are, where
// they are, how they do, and the time series. What only some lack, page_feed.h adds.
//
// A state machine: `look` says what there is to see now, and what has become due is encoded anew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "live.pb.h"
#include "monitor/fleet_view.h"
#include "monitor/outbound.h"
#include "monitor/rhythm.h"

namespace coppice {

/// A message as it goes out, and which one it is: a page that has had this number lacks nothing.
struct Edition {
  std::uint64_t number = 0;  ///< 0: there is none yet
  Bytes bytes{};
};

class LiveStream {
 public:
  /// `source`: where all of it comes from, for people. `recorded`: what is seen is no fleet that drives now.
  explicit LiveStream(std::string source, bool recorded = false);

  /// As of `now`; of a recording that is the time that it is played at, which may stand still, and `present`
  /// the wall's clock. Call it more often than a page is to hear of anything.
  void look(const FleetView& view, WallTime now, WallTime present);
  void look(const FleetView& view, WallTime now) { look(view, now, now); }
  /// What was seen so far is not true any more, though the view may not know that: a recording was wound
  /// back.
  void begin_anew();
  /// Where a recording is by now.
  void show(const live::Playback& playback);
  /// Whether what is heard is said again from a recording.
  void show_replayed(bool replayed) { replayed_ = replayed; }

  WallTime at() const { return at_; }         ///< when it looked last
  std::uint32_t run() const { return run_; }  ///< grows when all that was said before is to be forgotten
  /// What floats are relative to.
  const Point2& origin() const { return origin_; }
  std::uint64_t beat() const { return beat_; }  ///< grows a few times a second, for what need not be sooner
  const Bytes& begin() const { return begin_; }
  const Edition& map() const { return map_; }
  const Edition& roster() const { return roster_; }
  const Edition& frame() const { return frame_; }
  const Edition& playback() const { return playback_; }

  /// Of a robot that has said how it is, and the beat of the last change.
  struct RobotStatus {
    std::uint64_t changed = 0;
    live::Statuses::Status status{};
  };
  const std::vector<RobotStatus>& statuses() const { return statuses_; }

  /// The last half hour. The first of these has had `figures_dropped()` before it in this run.
  const std::deque<live::Figures::Point>& figures() const { return figures_; }
  std::size_t figures_dropped() const { return figures_dropped_; }

 private:
  void forget();
  void look_at_map(const FleetView& view);
  void look_at_roster(const FleetView& view);
  void look_at_statuses(const FleetView& view);
  void look_at_figures(const FleetView& view);

  Bytes begin_;
  WallTime at_ = 0;
  std::uint32_t run_ = 0;
  std::optional<std::uint32_t> run_of_view_{};
  std::uint64_t beat_ = 0;
  std::size_t robots_ = 0;  ///< in the roster
  std::string map_id_;
  Point2 origin_ = Point2::Zero();
  bool replayed_ = false;
  Edition map_;
  Edition roster_;
  Edition frame_;
  Edition playback_;
  std::vector<RobotStatus> statuses_;
  std::deque<live::Figures::Point> figures_;
  std::size_t figures_dropped_ = 0;
  Rhythm frame_rhythm_;
  Rhythm beat_rhythm_;
  Rhythm figures_rhythm_;
};

/// Where all robots are at that time, relative to that place.
live::Frame frame_of(const FleetView& view, const Point2& origin, WallTime now);

/// As it goes over the wire.
Bytes encoded(const live::ToPage& message);

}  // namespace coppice
