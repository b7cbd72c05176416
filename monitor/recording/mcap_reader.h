// Reads MCAP (mcap_format.h) piece by piece: the file is never in memory as a whole.
//
// A file with a summary is found by its chunk indexes. One without, as its writer was killed or the file was
// cut, is gone through once from its beginning: it is read up to where it ends or makes no sense, and
// `ending` says where that is.
//
// Invalid input throws InputError, which names the file and the byte. No content of a file causes an
// allocation larger than the limits here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "files/binary_file.h"
#include "monitor/recording/mcap_format.h"

namespace coppice {

/// Bytes: the largest chunk before compression, and the largest other record that is read.
inline constexpr std::uint64_t largest_chunk = 64u << 20;
/// Bytes: the most chunks that are in memory at once because their times overlap.
inline constexpr std::uint64_t most_open_chunks = 256u << 20;
/// Two weeks of recording.
inline constexpr std::size_t most_chunks = 4'000'000;

class McapReader {
 public:
  /// A part of the file with messages: a chunk, or consecutive messages outside of chunks.
  struct Piece {
    mcap::Time start = 0;  ///< of its messages
    mcap::Time end = 0;
    std::uint64_t offset = 0;                  ///< of its first record in the file
    std::uint64_t length = 0;                  ///< of its records in the file
    std::optional<std::string> compression{};  ///< none: it is no chunk
    std::uint64_t uncompressed_size = 0;
    std::vector<std::uint16_t> channels{};  ///< sorted; empty: not known
  };
  /// The content of a piece, in memory.
  struct Records {
    mcap::Bytes bytes;
    std::vector<mcap::Message> messages;  ///< in the order of time; they point into `bytes`
  };

  explicit McapReader(const std::string& file);

  std::uint64_t size() const { return file_.size(); }
  /// The library that wrote the file.
  const std::string& library() const { return library_; }
  const std::map<std::uint16_t, mcap::Schema>& schemas() const { return schemas_; }
  const std::map<std::uint16_t, mcap::Channel>& channels() const { return channels_; }
  const mcap::Statistics& statistics() const { return statistics_; }
  const std::vector<Piece>& pieces() const { return pieces_; }
  /// Empty if the file is complete; else where and how it ends.
  const std::string& ending() const { return ending_; }

  std::unique_ptr<Records> load(const Piece& piece) const;
  /// For error messages. The reader must outlive it.
  mcap::Origin at(std::uint64_t offset) const { return {name_, offset}; }

 private:
  struct Head {
    mcap::Opcode opcode;
    std::uint64_t length;  ///< of the content
  };
  Head head_at(std::uint64_t offset) const;
  mcap::Bytes content_at(std::uint64_t offset, std::uint64_t length) const;

  std::uint64_t read_header();
  bool read_summary(std::uint64_t first);
  void check_summary(const mcap::Footer& footer, std::uint64_t first, std::uint64_t footer_at) const;
  void scan(std::uint64_t first);
  std::optional<std::uint64_t> scan_record(std::uint64_t offset);
  std::optional<std::uint64_t> scan_torn_record(const Head& head, std::uint64_t offset);
  void scan_chunk(std::uint64_t offset, std::uint64_t length);
  void scan_message(std::uint64_t offset, std::uint64_t length);

  void note(mcap::Opcode opcode, mcap::Fields fields);
  void add(Piece piece);
  mcap::Bytes records_of(const Piece& piece) const;
  std::vector<mcap::Message> messages_in(std::string_view records, const Piece& piece) const;

  BinaryInput file_;
  std::string name_;
  std::string library_;
  std::map<std::uint16_t, mcap::Schema> schemas_;
  std::map<std::uint16_t, mcap::Channel> channels_;
  mcap::Statistics statistics_;
  std::vector<Piece> pieces_;
  std::string ending_;
};

/// The messages of some channels in a range of time, in the order of `log_time`. Messages of the same time
/// are in the order of the file.
class McapMessages {
 public:
  /// `reader` must outlive it.
  McapMessages(const McapReader& reader, mcap::Time from, mcap::Time until, std::set<std::uint16_t> channels);

  /// The next message; null after the last one. The result is valid until the next call.
  const mcap::Message* next();

 private:
  struct Open {
    std::size_t number;  ///< of the piece
    std::unique_ptr<McapReader::Records> records;
    std::size_t next = 0;

    const mcap::Message& message() const { return records->messages[next]; }
    bool is_after(const Open& other) const;
  };
  bool is_wanted(const McapReader::Piece& piece) const;
  void open(std::size_t number);
  void push(Open piece);

  const McapReader* reader_;
  mcap::Time from_;
  mcap::Time until_;
  std::set<std::uint16_t> channels_;
  std::vector<std::size_t> waiting_;  ///< numbers of pieces, the earliest last
  std::vector<Open> open_;            ///< a heap: the piece with the next message comes first
  std::uint64_t open_bytes_ = 0;
  std::optional<Open> current_{};
};

}  // namespace coppice
