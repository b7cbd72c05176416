// Makes a recording (recording.h) of what is heard on a bus: a state machine; what is to be appended to the
// file comes out as bytes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "messages/bus.h"
#include "monitor/mcap_writer.h"
#include "monitor/recorded_messages.h"

namespace coppice {

/// A chunk ends when it has that many bytes, before compression, or is that old: what a recorder loses that
/// is killed.
inline constexpr std::size_t chunk_size = 1u << 20;
inline constexpr WallTime chunk_period = 1;

class Recorder {
 public:
  explicit Recorder(McapWriter::Compression compression = McapWriter::Compression::zstd);

  /// What arrived since the last time, in any order.
  void on(std::vector<Arrival> arrivals);
  /// To be appended to the file now; often nothing.
  mcap::Bytes step(WallTime now);
  /// The rest: with that the file is whole.
  mcap::Bytes finish();

  /// Messages recorded, by topic.
  const std::array<std::uint32_t, topic_count>& counts() const { return counts_; }
  /// Messages that are longer than a recording holds.
  std::uint64_t left_out() const { return left_out_; }

 private:
  void add(const Arrival& arrival);
  void end_chunks();

  McapWriter writer_;
  std::array<std::uint16_t, topic_count> channels_{};
  std::array<McapChunk, 3> chunks_;
  std::optional<WallTime> begun_{};  ///< when the first message came that is in no chunk of the file yet
  WallTime latest_ = 0;
  WallTime ahead_ = 0;  ///< of the clock, where that was set back: the file's time goes on
  std::array<std::uint32_t, topic_count> counts_{};
  std::uint64_t left_out_ = 0;
};

}  // namespace coppice
