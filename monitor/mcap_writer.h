// Writes MCAP (mcap_format.h): what is to be appended to the file comes out as bytes; nothing is written
// here.
//
// The file is whole after `finish` alone, but at any time readable up to the last chunk: schemas and channels
// stand before the chunks, not in them, and each chunk has its message indexes right behind it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "monitor/mcap_format.h"

namespace coppice {

/// Messages that go into the file together.
class McapChunk {
 public:
  /// `log_time`: nanoseconds since 1970.
  void add(std::uint16_t channel, std::uint32_t sequence, mcap::Time log_time, std::string_view data);
  bool empty() const { return indexes_.empty(); }
  std::size_t size() const { return records_.size(); }
  /// Of the earliest message; only if there is one.
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

  /// `library`: who writes, for people.
  explicit McapWriter(std::string_view library, Compression compression = Compression::zstd);

  /// A schema for each channel, and the id of the channel. Before the first chunk.
  std::uint16_t add_channel(std::string_view topic, std::string_view encoding, std::string_view schema_name,
                            std::string_view schema);
  /// One that is empty is left out.
  void write(const McapChunk& chunk);
  /// What comes after the last chunk.
  void finish();

  /// What is to be appended to the file since the last call.
  mcap::Bytes take();
  const mcap::Statistics& statistics() const { return statistics_; }

 private:
  std::uint64_t end() const { return taken_ + out_.size(); }
  /// The summary's groups of records, one after the other, and where each lies.
  void write_summary();
  void write_summary_group(mcap::Opcode opcode, const std::vector<mcap::Bytes>& contents,
                           mcap::Bytes& offsets);

  Compression compression_;
  mcap::Bytes out_;
  std::uint64_t taken_ = 0;
  std::uint32_t crc_ = 0;  ///< of what was taken
  std::vector<mcap::Schema> schemas_;
  std::vector<mcap::Channel> channels_;
  std::vector<mcap::ChunkIndex> chunks_;
  mcap::Statistics statistics_;
};

}  // namespace coppice
