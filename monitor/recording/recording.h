// A recording of a fleet by `coppice record`, to be read from any time on.
//
// A recording is an MCAP file with a channel for each topic (recorded_messages.h). Three kinds of topics have
// their own chunks: volatile topics, topics that keep the latest of each key, and topics that keep all
// messages (messages/topics.h). To start at a time, `Playback` reads from the beginning only the kept
// messages. Of the volatile ones, which are most of the file, it reads only the last seconds.
#pragma once

#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "messages/bus.h"
#include "monitor/recording/mcap_reader.h"
#include "monitor/recording/recorded_messages.h"

namespace coppice {

/// A set of topics, by number.
using Topics = std::bitset<topic_count>;

class Recording {
 public:
  /// Throws InputError if the file is not a recording.
  explicit Recording(const std::string& file);

  const McapReader& file() const { return reader_; }
  /// Times of the first and the last message.
  WallTime begin() const { return wall_time(reader_.statistics().start); }
  WallTime end() const { return wall_time(reader_.statistics().end); }
  std::uint64_t count(TopicNumber topic) const;
  /// The topic of a channel; nothing for other content of the file.
  std::optional<TopicNumber> topic_of(std::uint16_t channel) const;
  std::set<std::uint16_t> channels_of(const Topics& topics) const;

 private:
  McapReader reader_;
  std::map<std::uint16_t, TopicNumber> topics_;  ///< by channel
};

/// Seconds. A standing robot sends its state less often than a driving one, but at least this often.
inline constexpr WallTime lead_in = 5;

/// The messages of a recording in the order of time.
class Playback {
 public:
  /// First returns what a process that joins the bus at `from` would receive, with the original times: the
  /// latest of each key, or all messages, of the transient-local topics, and the latest of each robot of the
  /// volatile topics. Then returns the messages from `from` on. `recording` must outlive it.
  Playback(const Recording& recording, WallTime from, const Topics& topics = Topics().set());

  /// Returns nothing after the last message. Throws InputError if the file is damaged.
  std::optional<Arrival> next();
  /// Number of messages that were left out because they cannot be read or fail validation
  /// (messages/validation.h).
  std::uint64_t rejected() const { return rejected_; }

 private:
  std::optional<Arrival> next_of(McapMessages& messages);

  const Recording* recording_;
  std::vector<Arrival> state_;  ///< the latest of each key, the earliest last
  McapMessages kept_;           ///< messages before `from` of the topics that keep all
  std::optional<Arrival> next_kept_{};
  McapMessages rest_;
  std::uint64_t rejected_ = 0;
};

}  // namespace coppice
