// Records (recording.h) the messages of a bus. A state machine: it returns the bytes to append to the file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "messages/bus.h"
#include "monitor/recording/mcap_writer.h"
#include "monitor/recording/recorded_messages.h"

namespace coppice {

/// A chunk ends when it has this many bytes before compression, or is this old (seconds). A recorder that is
/// killed loses at most the current chunks.
inline constexpr std::size_t chunk_size = 1u << 20;
inline constexpr WallTime chunk_period = 1;

class Recorder {
 public:
  explicit Recorder(McapWriter::Compression compression = McapWriter::Compression::zstd);

  /// Takes the messages that arrived since the last call, in any order.
  void on(std::vector<Arrival> arrivals);
  /// Returns the bytes to append to the file now; often none.
  mcap::Bytes step(WallTime now);
  /// Returns the rest. With it the file is complete.
  mcap::Bytes finish();

  /// Messages recorded, by topic.
  const std::array<std::uint32_t, topic_count>& counts() const { return counts_; }
  /// Number of messages that were too long to be recorded.
  std::uint64_t left_out() const { return left_out_; }

 private:
  void add(const Arrival& arrival);
  void end_chunks();

  McapWriter writer_;
  std::array<std::uint16_t, topic_count> channels_{};
  std::array<McapChunk, 3> chunks_;
  std::optional<WallTime> begun_{};  ///< when the first message arrived that is not in the file yet
  WallTime latest_ = 0;
  WallTime ahead_ = 0;  ///< offset of the file's time if the clock was set back
  std::array<std::uint32_t, topic_count> counts_{};
  std::uint64_t left_out_ = 0;
};

}  // namespace coppice
