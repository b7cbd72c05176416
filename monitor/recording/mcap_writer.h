// Writes MCAP (mcap_format.h). `take` returns the bytes to append; this class writes no file.
//
// The file is complete only after `finish`, but at any time readable up to the last chunk: schemas and
// channels stand before the chunks and not in them, and each chunk is followed by its message indexes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "monitor/recording/mcap_format.h"

namespace coppice {

/// Messages that are written together.
class McapChunk {
 public:
  /// `log_time`: nanoseconds since 1970.
  void add(std::uint16_t channel, std::uint32_t sequence, mcap::Time log_time, std::string_view data);
  bool empty() const { return indexes_.empty(); }
  std::size_t size() const { return records_.size(); }
  /// Time of the earliest message. Call it only if there is one.
  mcap::Time start() const { return start_; }

 private:
  friend class McapWriter;
  struct Entry {
    mcap::Time time;
    std::uint64_t offset;
  };
  mcap::Bytes records_;
  std::map<std::uint16_t, std::vector<Entry>> indexes_;
  mcap::Time start_ = 0;
  mcap::Time end_ = 0;
};

class McapWriter {
 public:
  enum class Compression : unsigned char { none, zstd };

  /// `library`: the name of the writing program, for people.
  explicit McapWriter(std::string_view library, Compression compression = Compression::zstd);

  /// Adds a channel with its own schema, and returns the channel's id. Call it before the first chunk.
  std::uint16_t add_channel(std::string_view topic, std::string_view encoding, std::string_view schema_name,
                            std::string_view schema);
  /// Writes a chunk, unless it is empty.
  void write(const McapChunk& chunk);
  /// Writes everything that comes after the last chunk.
  void finish();

  /// Returns the bytes to append to the file since the last call.
  mcap::Bytes take();
  const mcap::Statistics& statistics() const { return statistics_; }

 private:
  std::uint64_t end() const { return taken_ + out_.size(); }
  /// Writes the summary's groups of records, and the place of each group.
  void write_summary();
  void write_summary_group(mcap::Opcode opcode, const std::vector<mcap::Bytes>& contents,
                           mcap::Bytes& offsets);

  Compression compression_;
  mcap::Bytes out_;
  std::uint64_t taken_ = 0;
  std::uint32_t crc_ = 0;  ///< of the bytes taken so far
  std::vector<mcap::Schema> schemas_;
  std::vector<mcap::Channel> channels_;
  std::vector<mcap::ChunkIndex> chunks_;
  mcap::Statistics statistics_;
};

}  // namespace coppice
