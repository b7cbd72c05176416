// What `coppice record` has kept of a fleet, to be looked at from any time on.
//
// A recording is an MCAP file with a channel for each topic (recorded_messages.h). Messages of three kinds
// lie in chunks of their own: those that are not kept for anybody (volatile), those of which the latest of
// each key is, and those of which all are (topics.h). To begin at a time, `Playback` reads from the beginning
// what is kept, and of the rest, most of the file, nothing but the last seconds.
#pragma once

#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "messages/bus.h"
#include "monitor/mcap_reader.h"
#include "monitor/recorded_messages.h"

namespace coppice {

/// Which topics, by number.
using Topics = std::bitset<topic_count>;

class Recording {
 public:
  /// Throws InputError if it is no recording.
  explicit Recording(const std::string& file);

  const McapReader& file() const { return reader_; }
  /// When the first message was recorded, and the last.
  WallTime begin() const { return wall_time(reader_.statistics().start); }
  WallTime end() const { return wall_time(reader_.statistics().end); }
  std::uint64_t count(TopicNumber topic) const;
  /// None: of something else, which the file may hold besides.
  std::optional<TopicNumber> topic_of(std::uint16_t channel) const;
  std::set<std::uint16_t> channels_of(const Topics& topics) const;

 private:
  McapReader reader_;
  std::map<std::uint16_t, TopicNumber> topics_;  ///< by channel
};

/// A robot that stands says so less often than one that drives, but within so many seconds.
inline constexpr WallTime lead_in = 5;

/// The messages of a recording in the order of time.
class Playback {
 public:
  /// `from`: first what one who joins the bus then would be given, at the times at which that was said: the
  /// latest of each key of the transient-local topics, and all of those that keep all; and of what is not
  /// kept, the latest of each robot. Then what comes from that time on. `recording` outlives it.
  Playback(const Recording& recording, WallTime from, const Topics& topics = Topics().set());

  /// Nothing after the last one. Throws InputError where the file is damaged.
  std::optional<Arrival> next();
  /// Messages left out, as they are none of their topic or fail validation (messages/validation.h).
  std::uint64_t rejected() const { return rejected_; }

 private:
  std::optional<Arrival> next_of(McapMessages& messages);

  const Recording* recording_;
  std::vector<Arrival> state_;  ///< of those with keys, the earliest last
  McapMessages kept_;           ///< before `from`, of those that keep all
  std::optional<Arrival> next_kept_{};
  McapMessages rest_;
  std::uint64_t rejected_ = 0;
};

}  // namespace coppice
