// The bytes of a journal: a first line of text, and records.
//
// The first line names the version of the format and of the message types, says whether the journal is
// complete, and up to which byte it was certainly on disk. A record is a frame (a marker, the length of the
// bytes, and a checksum over length and bytes) and the bytes. The marker also names the version of the
// message types, so that records are found behind a damage, whatever was damaged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "messages/messages.h"
#include "runtime/disk_file.h"

namespace coppice {

struct JournalHead {
  bool complete = true;    ///< no message is missing
  std::size_t synced = 0;  ///< bytes of the file that were written to disk for certain
};

/// Always of the same size, so that it can be overwritten in place.
std::string first_line(const JournalHead& head);
extern const std::size_t first_line_size;

/// The file has no whole first line: the process was killed while it created it.
struct NoHead {};
/// The first line is not what was written, and records follow it.
struct DamagedHead {};
/// The file is no journal, or its messages are those of another version.
struct ForeignFile {};
std::variant<JournalHead, NoHead, DamagedHead, ForeignFile> head_of(const DiskFile& file);

/// A record that holds these bytes.
std::vector<std::uint8_t> framed(std::span<const std::uint8_t> bytes);
std::vector<std::uint8_t> record_of(const Message& message);
/// Text that a role saves beside its messages.
std::vector<std::uint8_t> record_of_note(std::string_view note);

/// Reads the records of a file from front to back, through a buffer. Throws std::runtime_error if the disk
/// cannot be read.
class RecordReader {
 public:
  explicit RecordReader(const DiskFile& file);

  /// The bytes of the sound record at this place; none: there is no record, or it is damaged. Valid until the
  /// next call.
  std::optional<std::span<const std::uint8_t>> at(std::size_t place);
  /// The end of a record whose bytes are these.
  static std::size_t end_of(std::size_t place, std::span<const std::uint8_t> record);
  /// The next place, from this one on, where a sound record begins.
  std::optional<std::size_t> next_sound(std::size_t place);
  /// Whether the record at this place is one that was not written to its end: the file ends within it, or
  /// its end was never written and reads as zeros.
  bool is_torn(std::size_t place);
  std::size_t file_size() const { return file_size_; }

 private:
  std::span<const std::uint8_t> bytes(std::size_t place, std::size_t size);

  const DiskFile& file_;
  std::size_t file_size_;
  std::vector<std::uint8_t> buffer_{};
  std::size_t buffer_at_ = 0;
};

/// What a record holds.
using Recorded = std::variant<std::monostate, Message, std::string>;
/// Nothing: the bytes are no valid message. Text: a note.
Recorded recorded_in(std::span<const std::uint8_t> record);

}  // namespace coppice
