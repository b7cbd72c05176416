#include "runtime/journal_format.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "dds/serialized.h"

namespace coppice {

namespace {

constexpr std::string_view types = COPPICE_MESSAGE_TYPES;  // eight hexadecimal digits
constexpr std::string_view title = "coppice journal 2 " COPPICE_MESSAGE_TYPES " ";
constexpr char whole = 'c';
constexpr char has_gaps = 'i';
constexpr std::size_t digits = 16;
constexpr std::size_t frame_size = 12;                      // bytes: marker, length, checksum
constexpr std::uint32_t longest_record = 256u << 20;        // bytes
constexpr std::size_t read_at_once = std::size_t{1} << 20;  // bytes
constexpr std::size_t zeros_of_a_torn_record = 8;           // bytes at its end
constexpr std::uint8_t note_kind = 0xff;                    // no message has this index

/// Two bytes that occur in no text, and two of the version.
constexpr std::array<std::uint8_t, 4> marker{
    0xc0, 0x9c, static_cast<std::uint8_t>(types[0] ^ (types[1] << 3) ^ (types[2] << 5)),
    static_cast<std::uint8_t>(types[3] ^ (types[4] << 2) ^ (types[5] << 4) ^ (types[6] << 1))};

std::uint32_t number_at(const std::uint8_t* bytes) {
  return bytes[0] | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
         std::uint32_t{bytes[3]} << 24;
}

void put_number(std::uint32_t number, std::uint8_t* bytes) {
  for (int k = 0; k < 4; ++k) bytes[k] = static_cast<std::uint8_t>(number >> (8 * k));
}

/// Over the four bytes of the length, and the record.
std::uint32_t checksum(const std::uint8_t* length, std::span<const std::uint8_t> record) {
  const uLong begun = crc32(crc32(0, nullptr, 0), length, 4);
  return static_cast<std::uint32_t>(crc32(begun, record.data(), static_cast<uInt>(record.size())));
}

std::optional<JournalHead> parsed(std::string_view line) {
  if (line.size() != first_line_size || !line.starts_with(title) || line.back() != '\n') return std::nullopt;
  const std::string_view rest = line.substr(title.size());
  JournalHead head{.complete = rest[0] == whole};
  const char* const first = rest.data() + 2;
  const auto [end, problem] = std::from_chars(first, first + digits, head.synced, 16);
  const bool is_sound =
      (rest[0] == whole || rest[0] == has_gaps) && problem == std::errc() && end == first + digits;
  return is_sound ? std::optional(head) : std::nullopt;
}

}  // namespace

const std::size_t first_line_size = title.size() + 2 + digits + 1;

std::string first_line(const JournalHead& head) {
  return fmt::format("{}{} {:016x}\n", title, head.complete ? whole : has_gaps, head.synced);
}

std::variant<JournalHead, NoHead, DamagedHead, ForeignFile> head_of(const DiskFile& file) {
  const std::vector<std::uint8_t> bytes = file.read(0, std::min(first_line_size, file.size()));
  const std::string_view line(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (const auto head = parsed(line)) return *head;
  if (line.size() < first_line_size && line.substr(0, title.size()) == title.substr(0, line.size()))
    return NoHead{};
  if (RecordReader(file).at(first_line_size)) return DamagedHead{};
  return ForeignFile{};
}

std::vector<std::uint8_t> framed(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> record(frame_size + bytes.size());
  std::ranges::copy(marker, record.begin());
  put_number(static_cast<std::uint32_t>(bytes.size()), record.data() + 4);
  put_number(checksum(record.data() + 4, bytes), record.data() + 8);
  std::ranges::copy(bytes, record.begin() + frame_size);
  return record;
}

std::vector<std::uint8_t> record_of(const Message& message) {
  return framed(serialized(message));
}

std::vector<std::uint8_t> record_of_note(std::string_view note) {
  std::vector<std::uint8_t> bytes{note_kind};
  bytes.insert(bytes.end(), note.begin(), note.end());
  return framed(bytes);
}

Recorded recorded_in(std::span<const std::uint8_t> record) {
  if (!record.empty() && record[0] == note_kind) return std::string(record.begin() + 1, record.end());
  auto message = deserialized(record);
  return message ? Recorded(*std::move(message)) : Recorded();
}

RecordReader::RecordReader(const DiskFile& file) : file_(file), file_size_(file.size()) {}

std::span<const std::uint8_t> RecordReader::bytes(std::size_t place, std::size_t size) {
  size = std::min(size, file_size_ - std::min(place, file_size_));
  if (place < buffer_at_ || place + size > buffer_at_ + buffer_.size()) {
    buffer_ = file_.read(place, std::max(size, read_at_once));
    buffer_at_ = place;
    size = std::min(size, buffer_.size());
  }
  return std::span(buffer_).subspan(place - buffer_at_, size);
}

std::optional<std::span<const std::uint8_t>> RecordReader::at(std::size_t place) {
  const std::span<const std::uint8_t> frame = bytes(place, frame_size);
  if (frame.size() < frame_size || !std::ranges::equal(frame.first(4), marker)) return std::nullopt;
  const std::uint32_t length = number_at(frame.data() + 4);
  const std::uint32_t sum = number_at(frame.data() + 8);
  if (length > longest_record || place + frame_size + length > file_size_) return std::nullopt;
  const std::span<const std::uint8_t> whole_record = bytes(place, frame_size + length);
  if (whole_record.size() < frame_size + length) return std::nullopt;
  const std::span<const std::uint8_t> record = whole_record.subspan(frame_size);
  return sum == checksum(whole_record.data() + 4, record) ? std::optional(record) : std::nullopt;
}

std::size_t RecordReader::end_of(std::size_t place, std::span<const std::uint8_t> record) {
  return place + frame_size + record.size();
}

std::optional<std::size_t> RecordReader::next_sound(std::size_t place) {
  while (place + frame_size <= file_size_) {
    const std::span<const std::uint8_t> here = bytes(place, read_at_once);
    const auto found = std::ranges::search(here, marker);
    if (found.empty()) {
      place += here.size() - std::min(here.size(), marker.size() - 1);
      if (here.size() < marker.size()) return std::nullopt;
      continue;
    }
    place += static_cast<std::size_t>(found.begin() - here.begin());
    if (at(place)) return place;
    ++place;
  }
  return std::nullopt;
}

bool RecordReader::is_torn(std::size_t place) {
  const std::span<const std::uint8_t> frame = bytes(place, frame_size);
  if (frame.size() < frame_size) return true;
  const bool has_frame = std::ranges::equal(frame.first(4), marker);
  if (has_frame && place + frame_size + number_at(frame.data() + 4) > file_size_) return true;
  const std::size_t from = std::max(place, file_size_ - std::min(file_size_, zeros_of_a_torn_record));
  const std::span<const std::uint8_t> end = bytes(from, zeros_of_a_torn_record);
  return std::ranges::all_of(end, [](std::uint8_t byte) { return byte == 0; });
}

}  // namespace coppice
