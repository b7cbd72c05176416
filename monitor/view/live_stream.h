// What all pages receive alike (idl/live.proto), encoded once for all: the robots, their positions and
// statuses, and the time series. page_feed.h adds what only some pages lack.
//
// A state machine: `look` reads the view and encodes what is due.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "live.pb.h"
#include "monitor/view/alarms.h"
#include "monitor/view/fleet_view.h"
#include "monitor/view/outbound.h"
#include "monitor/view/rhythm.h"

namespace coppice {

/// An encoded message and its number. A page that has received this number needs nothing more.
struct Edition {
  std::uint64_t number = 0;  ///< 0: there is none yet
  Payload bytes{};
};

class LiveStream {
 public:
  /// `source`: where the messages come from, as text for people. `recorded`: the messages come from a file.
  /// `controlled`: the monitor takes orders.
  explicit LiveStream(std::string source, bool recorded = false, bool controlled = false);

  /// Reads the view as of `now`. For a recording, `now` is the time that is shown, which may stand still, and
  /// `present` is the wall clock. Call it more often than pages need messages.
  void look(const FleetView& view, WallTime now, WallTime present, const AlarmBoard& alarms = AlarmBoard());
  void look(const FleetView& view, WallTime now) { look(view, now, now); }
  /// Forgets all that was seen. Call it when the view cannot know that it is obsolete, as after winding back
  /// a recording.
  void begin_anew();
  /// Shows the position in a recording.
  void show(const live::Playback& playback);
  /// Shows whether another process replays the messages from a recording.
  void show_replayed(bool replayed) { replayed_ = replayed; }

  WallTime at() const { return at_; }         ///< when it last looked
  std::uint32_t run() const { return run_; }  ///< grows when pages must forget all earlier messages
  /// Positions in messages are relative to this point.
  const Point2& origin() const { return origin_; }
  std::uint64_t slow_tick() const {
    return slow_tick_;
  }  ///< grows four times a second, for what may come later
  const Payload& begin() const { return begin_; }
  const Edition& map() const { return map_; }
  const Edition& roster() const { return roster_; }
  const Edition& frame() const { return frame_; }
  const Edition& playback() const { return playback_; }
  const Edition& alarms() const { return alarms_; }
  const Edition& beat() const { return beat_; }

  /// The last status of a robot, and the slow tick at which it changed.
  struct RobotStatus {
    std::uint64_t changed = 0;
    live::Statuses::Status status{};
  };
  const std::vector<RobotStatus>& statuses() const { return statuses_; }

  /// The last half hour. Of this run, `figures_dropped()` points came before the first of these.
  const std::deque<live::Figures::Point>& figures() const { return figures_; }
  std::size_t figures_dropped() const { return figures_dropped_; }

 private:
  void forget();
  void look_at_map(const FleetView& view);
  void look_at_roster(const FleetView& view);
  void look_at_statuses(const FleetView& view);
  void look_at_figures(const FleetView& view);
  void look_at_alarms(const FleetView& view, const AlarmBoard& board);

  Payload begin_;
  WallTime at_ = 0;
  std::uint32_t run_ = 0;
  std::optional<std::uint32_t> run_of_view_{};
  std::uint64_t slow_tick_ = 0;
  std::size_t robots_ = 0;  ///< number of robots in the roster
  std::string map_id_;
  Point2 origin_ = Point2::Zero();
  bool replayed_ = false;
  Edition map_;
  Edition roster_;
  Edition frame_;
  Edition playback_;
  Edition alarms_;
  Edition beat_;
  std::vector<RobotStatus> statuses_;
  std::deque<live::Figures::Point> figures_;
  std::size_t figures_dropped_ = 0;
  Rhythm frame_rhythm_;
  Rhythm slow_rhythm_;
  Rhythm figures_rhythm_;
};

/// The positions of all robots at that time, relative to `origin`.
live::Frame frame_of(const FleetView& view, const Point2& origin, WallTime now);

/// The bytes of a message.
Payload encoded(const live::ToPage& message);

}  // namespace coppice
