#include "monitor/recording/mcap_reader.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <zstd.h>

#include "coppice/files/input_error.h"

namespace coppice {

using mcap::Bytes;
using mcap::Fields;
using mcap::Opcode;
using mcap::Origin;

namespace {

constexpr std::uint64_t longest_record = largest_chunk + (1u << 20);  // bytes
constexpr std::uint64_t longest_stretch = 1u << 20;                   // outside of chunks, bytes
constexpr std::size_t block = 1u << 16;                               // bytes, for checksums

/// Calls `fn` with the opcode and the fields of each record.
template <class Fn>
void for_each_record(std::string_view records, const Origin& origin, Fn&& fn) {
  Fields fields(records, origin);
  while (!fields.empty()) {
    const auto opcode = static_cast<Opcode>(fields.u8());
    const std::uint64_t length = fields.u64();
    fn(opcode, Fields(fields.bytes(length), origin));
  }
}

Bytes decompressed(std::string_view records, std::uint64_t size, const Origin& origin) {
  if (ZSTD_getFrameContentSize(records.data(), records.size()) != size)
    mcap::refuse(origin, fmt::format("expected zstd of {} bytes", size));
  Bytes out(size, '\0');
  const std::size_t done = ZSTD_decompress(out.data(), out.size(), records.data(), records.size());
  if (ZSTD_isError(done) != 0 || done != size)
    mcap::refuse(origin, fmt::format("expected zstd of {} bytes, found damaged data", size));
  return out;
}

/// Returns the records of a chunk.
Bytes unpacked(std::string_view content, const Origin& origin) {
  Fields fields(content, origin);
  const mcap::ChunkHead head = mcap::chunk_head_in(fields);
  if (head.uncompressed_size > largest_chunk)
    mcap::refuse(origin, fmt::format("a chunk of {} bytes, expected at most {}", head.uncompressed_size,
                                     largest_chunk));
  const std::string_view packed = fields.bytes(head.size);
  if (head.compression.empty() && head.size != head.uncompressed_size)
    mcap::refuse(origin, "the chunk's two sizes differ");
  if (!head.compression.empty() && head.compression != mcap::zstd)
    mcap::refuse(origin, fmt::format("compression {:?}, expected zstd or none", head.compression));
  Bytes records =
      head.compression.empty() ? Bytes(packed) : decompressed(packed, head.uncompressed_size, origin);
  if (head.crc != 0 && head.crc != mcap::crc32(records))
    mcap::refuse(origin, "the chunk is damaged: its checksum does not match");
  return records;
}

}  // namespace

McapReader::McapReader(const std::string& file) : file_(file), name_(file) {
  const std::uint64_t first = read_header();
  if (!read_summary(first)) scan(first);
}

McapReader::Head McapReader::head_at(std::uint64_t offset) const {
  const Bytes bytes = file_.read(offset, mcap::record_head);
  Fields fields(bytes, at(offset));
  const auto opcode = static_cast<Opcode>(fields.u8());
  return {opcode, fields.u64()};
}

Bytes McapReader::content_at(std::uint64_t offset, std::uint64_t length) const {
  if (length > longest_record)
    mcap::refuse(at(offset), fmt::format("{} bytes, expected at most {}", length, longest_record));
  return file_.read(offset + mcap::record_head, length);
}

/// Returns the place of the first record after the header.
std::uint64_t McapReader::read_header() {
  constexpr std::uint64_t begin = mcap::magic.size();
  const std::size_t there = std::min<std::uint64_t>(file_.size(), begin);
  if (file_.read(0, there) != mcap::magic) mcap::refuse(at(0), "is not an MCAP file of format 0");
  if (file_.size() < begin + mcap::record_head) mcap::refuse(at(begin), "the file ends before its header");
  const Head head = head_at(begin);
  if (head.opcode != Opcode::header) mcap::refuse(at(begin), "expected the header");
  const Bytes content = content_at(begin, head.length);
  Fields fields(content, at(begin));
  fields.string();  // profile
  library_ = fields.string();
  return begin + mcap::record_head + head.length;
}

/// False if there is no usable summary.
bool McapReader::read_summary(std::uint64_t first) {
  constexpr std::uint64_t tail = mcap::footer_size + mcap::magic.size();
  if (file_.size() < first + tail) return false;
  if (file_.read(file_.size() - mcap::magic.size(), mcap::magic.size()) != mcap::magic) return false;
  const std::uint64_t footer_at = file_.size() - tail;
  const Head head = head_at(footer_at);
  if (head.opcode != Opcode::footer || head.length != mcap::footer_size - mcap::record_head) return false;
  const Bytes content = content_at(footer_at, head.length);
  const mcap::Footer footer = mcap::footer_in({content, at(footer_at)});
  if (footer.summary_start == 0) return false;
  check_summary(footer, first, footer_at);

  bool has_statistics = false;
  for (std::uint64_t offset = footer.summary_start; offset < footer_at;) {
    const Head record = head_at(offset);
    const Bytes bytes = content_at(offset, record.length);
    const Fields fields(bytes, at(offset));
    note(record.opcode, fields);
    if (record.opcode == Opcode::statistics) {
      statistics_ = mcap::statistics_in(fields);
      has_statistics = statistics_.start <= statistics_.end;
    }
    if (record.opcode == Opcode::chunk_index) {
      const mcap::ChunkIndex index = mcap::chunk_index_in(fields);
      Piece piece{.start = index.start,
                  .end = index.end,
                  .offset = index.offset,
                  .length = index.length,
                  .compression = index.compression,
                  .uncompressed_size = index.uncompressed_size};
      for (const auto& [channel, place] : index.message_indexes) piece.channels.push_back(channel);
      add(std::move(piece));
    }
    offset += mcap::record_head + record.length;
  }
  if (has_statistics && pieces_.empty() == (statistics_.messages == 0)) return true;
  statistics_ = {};
  pieces_.clear();
  return false;
}

void McapReader::check_summary(const mcap::Footer& footer, std::uint64_t first,
                               std::uint64_t footer_at) const {
  if (footer.summary_start < first || footer.summary_start > footer_at)
    mcap::refuse(at(footer_at), fmt::format("the summary begins at byte {}", footer.summary_start));
  if (footer.summary_crc == 0) return;
  const std::uint64_t end = footer_at + mcap::footer_size - 4;
  std::uint32_t crc = 0;
  for (std::uint64_t offset = footer.summary_start; offset < end; offset += block)
    crc = mcap::crc32(file_.read(offset, std::min<std::uint64_t>(block, end - offset)), crc);
  if (crc != footer.summary_crc)
    mcap::refuse(at(footer.summary_start), "the summary is damaged: its checksum does not match");
}

void McapReader::scan(std::uint64_t first) {
  try {
    for (std::optional<std::uint64_t> offset = first; offset;) offset = scan_record(*offset);
  } catch (const InputError& problem) {
    ending_ = problem.what();  // the part before it is intact
  }
}

/// Returns the place of the next record, if there is one.
std::optional<std::uint64_t> McapReader::scan_record(std::uint64_t offset) {
  if (file_.size() - offset < mcap::record_head) {
    ending_ = fmt::format(
        "ends at byte {}, before its summary: its writer was killed, or the file was cut off", file_.size());
    return std::nullopt;
  }
  const Head head = head_at(offset);
  if (head.length > file_.size() - offset - mcap::record_head) return scan_torn_record(head, offset);
  if (head.opcode == static_cast<Opcode>(0)) mcap::refuse(at(offset), "opcode 0");
  if (head.opcode == Opcode::chunk) scan_chunk(offset, head.length);
  if (head.opcode == Opcode::message) scan_message(offset, head.length);
  if (head.opcode == Opcode::schema || head.opcode == Opcode::channel) {
    const Bytes content = content_at(offset, head.length);
    note(head.opcode, {content, at(offset)});
  }
  const std::uint64_t next = offset + mcap::record_head + head.length;
  if (head.opcode != Opcode::footer) return next;
  const std::size_t left = std::min<std::uint64_t>(file_.size() - next, mcap::magic.size());
  if (file_.read(next, left) != mcap::magic) ending_ = "lacks its last bytes";
  return std::nullopt;
}

/// Reads the complete messages of a torn chunk without compression as if they were outside of a chunk.
std::optional<std::uint64_t> McapReader::scan_torn_record(const Head& head, std::uint64_t offset) {
  ending_ = fmt::format("ends at byte {}, within the record that begins at byte {}", file_.size(), offset);
  constexpr std::uint64_t before_records = 8 + 8 + 8 + 4 + 4 + 8;  // in a chunk without compression
  const std::uint64_t content = offset + mcap::record_head;
  if (head.opcode != Opcode::chunk || file_.size() - content < before_records) return std::nullopt;
  const Bytes bytes = file_.read(content, before_records);
  Fields fields(bytes, at(offset));
  fields.bytes(28);
  if (!fields.string().empty()) return std::nullopt;
  return content + before_records;
}

void McapReader::scan_chunk(std::uint64_t offset, std::uint64_t length) {
  Piece piece{.offset = offset, .length = mcap::record_head + length};
  {
    const Bytes content = content_at(offset, length);
    Fields fields(content, at(offset));
    const mcap::ChunkHead head = mcap::chunk_head_in(fields);
    piece.start = head.start;
    piece.end = head.end;
    piece.compression = head.compression;
    piece.uncompressed_size = head.uncompressed_size;
  }
  const Bytes records = records_of(piece);
  for_each_record(records, at(offset), [&](Opcode opcode, Fields fields) { note(opcode, fields); });
  std::set<std::uint16_t> channels;
  for (const mcap::Message& message : messages_in(records, piece)) {
    statistics_.count(message.channel, message.log_time);
    channels.insert(message.channel);
  }
  piece.channels.assign(channels.begin(), channels.end());
  add(std::move(piece));
}

void McapReader::scan_message(std::uint64_t offset, std::uint64_t length) {
  const std::uint64_t whole = mcap::record_head + length;
  const Bytes head =
      file_.read(offset + mcap::record_head, std::min<std::uint64_t>(length, mcap::message_head));
  const mcap::Message message = mcap::message_in({head, at(offset)});
  if (!channels_.contains(message.channel))
    mcap::refuse(at(offset), fmt::format("a message of channel {}, which is unknown", message.channel));
  statistics_.count(message.channel, message.log_time);
  const bool goes_on = !pieces_.empty() && !pieces_.back().compression &&
                       pieces_.back().offset + pieces_.back().length == offset &&
                       pieces_.back().length + whole <= longest_stretch;
  if (!goes_on) add({.start = message.log_time, .end = message.log_time, .offset = offset});
  Piece& piece = pieces_.back();
  piece.start = std::min(piece.start, message.log_time);
  piece.end = std::max(piece.end, message.log_time);
  piece.length += whole;
  piece.uncompressed_size += whole;
}

void McapReader::note(Opcode opcode, Fields fields) {
  if (opcode == Opcode::schema) {
    mcap::Schema schema = mcap::schema_in(fields);
    schemas_.try_emplace(schema.id, std::move(schema));
  }
  if (opcode == Opcode::channel) {
    mcap::Channel channel = mcap::channel_in(fields);
    channels_.try_emplace(channel.id, std::move(channel));
  }
}

void McapReader::add(Piece piece) {
  if (pieces_.size() >= most_chunks)
    mcap::refuse(at(piece.offset), fmt::format("more than {} chunks", most_chunks));
  pieces_.push_back(std::move(piece));
}

Bytes McapReader::records_of(const Piece& piece) const {
  if (!piece.compression) {
    if (piece.length > longest_record) mcap::refuse(at(piece.offset), "is too long");
    return file_.read(piece.offset, piece.length);
  }
  if (piece.offset > file_.size() || file_.size() - piece.offset < mcap::record_head)
    mcap::refuse(at(piece.offset), "expected a chunk, found the end");
  const Head head = head_at(piece.offset);
  if (head.opcode != Opcode::chunk || head.length != piece.length - mcap::record_head)
    mcap::refuse(at(piece.offset), "expected the chunk that the summary names");
  return unpacked(content_at(piece.offset, head.length), at(piece.offset));
}

std::vector<mcap::Message> McapReader::messages_in(std::string_view records, const Piece& piece) const {
  std::vector<mcap::Message> messages;
  const Origin origin = at(piece.offset);
  for_each_record(records, origin, [&](Opcode opcode, Fields fields) {
    if (opcode != Opcode::message) return;
    const mcap::Message message = mcap::message_in(fields);
    if (!channels_.contains(message.channel))
      mcap::refuse(origin, fmt::format("a message of channel {}, which is unknown", message.channel));
    if (message.log_time < piece.start || message.log_time > piece.end)
      mcap::refuse(origin, "a message whose time is outside of the chunk's times");
    messages.push_back(message);
  });
  std::ranges::stable_sort(messages, {}, &mcap::Message::log_time);
  return messages;
}

std::unique_ptr<McapReader::Records> McapReader::load(const Piece& piece) const {
  auto records = std::make_unique<Records>();
  records->bytes = records_of(piece);
  records->messages = messages_in(records->bytes, piece);
  return records;
}

// --- in the order of time ---

McapMessages::McapMessages(const McapReader& reader, mcap::Time from, mcap::Time until,
                           std::set<std::uint16_t> channels)
    : reader_(&reader), from_(from), until_(until), channels_(std::move(channels)) {
  const auto& pieces = reader.pieces();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (is_wanted(pieces[k])) waiting_.push_back(k);
  }
  std::ranges::stable_sort(waiting_, {}, [&](std::size_t k) { return pieces[k].start; });
  std::ranges::reverse(waiting_);
}

bool McapMessages::is_wanted(const McapReader::Piece& piece) const {
  return piece.end >= from_ && piece.start < until_ &&
         (piece.channels.empty() ||
          std::ranges::any_of(piece.channels, [&](std::uint16_t id) { return channels_.contains(id); }));
}

bool McapMessages::Open::is_after(const Open& other) const {
  return std::pair(message().log_time, number) > std::pair(other.message().log_time, other.number);
}

void McapMessages::push(Open piece) {
  open_.push_back(std::move(piece));
  std::ranges::push_heap(open_, [](const Open& a, const Open& b) { return a.is_after(b); });
}

void McapMessages::open(std::size_t number) {
  const McapReader::Piece& piece = reader_->pieces()[number];
  auto records = reader_->load(piece);
  std::erase_if(records->messages, [&](const mcap::Message& message) {
    return message.log_time < from_ || message.log_time >= until_ || !channels_.contains(message.channel);
  });
  if (records->messages.empty()) return;
  open_bytes_ += records->bytes.size();
  if (open_bytes_ > most_open_chunks)
    mcap::refuse(reader_->at(piece.offset),
                 fmt::format("more than {} bytes of chunks are of the same time", most_open_chunks));
  push({number, std::move(records)});
}

const mcap::Message* McapMessages::next() {
  if (current_) {
    if (++current_->next < current_->records->messages.size()) {
      push(std::move(*current_));
    } else {
      open_bytes_ -= current_->records->bytes.size();
    }
    current_.reset();
  }
  while (!waiting_.empty() &&
         (open_.empty() || reader_->pieces()[waiting_.back()].start <= open_.front().message().log_time)) {
    const std::size_t number = waiting_.back();
    waiting_.pop_back();
    open(number);
  }
  if (open_.empty()) return nullptr;
  std::ranges::pop_heap(open_, [](const Open& a, const Open& b) { return a.is_after(b); });
  current_.emplace(std::move(open_.back()));
  open_.pop_back();
  return &current_->message();
}

}  // namespace coppice
