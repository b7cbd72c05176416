#include "monitor/recording/mcap_format.h"

#include <algorithm>

#include <fmt/format.h>
#include <zlib.h>

#include "coppice/files/input_error.h"

namespace coppice::mcap {

namespace {

void append_number(Bytes& out, std::uint64_t value, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) out.push_back(static_cast<char>(value >> 8 * k & 0xff));
}

/// The entries are pairs of an id and a number.
std::map<std::uint16_t, std::uint64_t> numbers_by_id(Fields entries) {
  std::map<std::uint16_t, std::uint64_t> all;
  while (!entries.empty()) {
    const std::uint16_t id = entries.u16();
    all[id] = entries.u64();
  }
  return all;
}
void append_numbers_by_id(Bytes& out, const std::map<std::uint16_t, std::uint64_t>& all) {
  append_u32(out, static_cast<std::uint32_t>(all.size() * 10));
  for (const auto& [id, number] : all) {
    append_u16(out, id);
    append_u64(out, number);
  }
}

}  // namespace

void Statistics::count(std::uint16_t channel, Time at) {
  start = messages == 0 ? at : std::min(start, at);
  end = std::max(end, at);
  ++messages;
  ++channel_messages[channel];
}

std::uint32_t crc32(std::string_view bytes, std::uint32_t of_those_before) {
  return static_cast<std::uint32_t>(
      ::crc32_z(of_those_before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void append_u16(Bytes& out, std::uint16_t value) {
  append_number(out, value, 2);
}
void append_u32(Bytes& out, std::uint32_t value) {
  append_number(out, value, 4);
}
void append_u64(Bytes& out, std::uint64_t value) {
  append_number(out, value, 8);
}
void append_string(Bytes& out, std::string_view text) {
  append_u32(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}
void append_record(Bytes& out, Opcode opcode, std::string_view content) {
  out.push_back(static_cast<char>(opcode));
  append_u64(out, content.size());
  out += content;
}

Bytes content_of(const Schema& schema) {
  Bytes out;
  append_u16(out, schema.id);
  append_string(out, schema.name);
  append_string(out, schema.encoding);
  append_string(out, schema.data);
  return out;
}

Bytes content_of(const Channel& channel) {
  Bytes out;
  append_u16(out, channel.id);
  append_u16(out, channel.schema);
  append_string(out, channel.topic);
  append_string(out, channel.message_encoding);
  append_u32(out, 0);  // metadata: none
  return out;
}

Bytes content_of(const ChunkIndex& index) {
  Bytes out;
  append_u64(out, index.start);
  append_u64(out, index.end);
  append_u64(out, index.offset);
  append_u64(out, index.length);
  append_numbers_by_id(out, index.message_indexes);
  append_u64(out, index.message_index_length);
  append_string(out, index.compression);
  append_u64(out, index.compressed_size);
  append_u64(out, index.uncompressed_size);
  return out;
}

Bytes content_of(const Statistics& statistics) {
  Bytes out;
  append_u64(out, statistics.messages);
  append_u16(out, statistics.schemas);
  append_u32(out, statistics.channels);
  append_u32(out, 0);  // attachments
  append_u32(out, 0);  // metadata
  append_u32(out, statistics.chunks);
  append_u64(out, statistics.start);
  append_u64(out, statistics.end);
  append_numbers_by_id(out, statistics.channel_messages);
  return out;
}

void refuse(const Origin& origin, std::string_view what) {
  throw InputError(fmt::format("{}: record at byte {}: {}", origin.file, origin.offset, what));
}

std::string_view Fields::bytes(std::uint64_t count) {
  if (count > left_.size())
    refuse(origin_, fmt::format("expected {} more bytes, found {}", count, left_.size()));
  const std::string_view taken = left_.substr(0, count);
  left_.remove_prefix(count);
  return taken;
}

std::uint64_t Fields::number(std::size_t count) {
  const std::string_view taken = bytes(count);
  std::uint64_t value = 0;
  for (std::size_t k = count; k-- > 0;) value = value << 8 | static_cast<unsigned char>(taken[k]);
  return value;
}

Schema schema_in(Fields fields) {
  Schema schema;
  schema.id = fields.u16();
  schema.name = fields.string();
  schema.encoding = fields.string();
  schema.data = fields.string();
  return schema;
}

Channel channel_in(Fields fields) {
  Channel channel;
  channel.id = fields.u16();
  channel.schema = fields.u16();
  channel.topic = fields.string();
  channel.message_encoding = fields.string();
  fields.string();  // metadata
  return channel;
}

Message message_in(Fields fields) {
  Message message;
  message.channel = fields.u16();
  message.sequence = fields.u32();
  message.log_time = fields.u64();
  fields.u64();  // publish time
  message.data = fields.rest();
  return message;
}

ChunkHead chunk_head_in(Fields& fields) {
  ChunkHead head;
  head.start = fields.u64();
  head.end = fields.u64();
  head.uncompressed_size = fields.u64();
  head.crc = fields.u32();
  head.compression = fields.string();
  head.size = fields.u64();
  return head;
}

ChunkIndex chunk_index_in(Fields fields) {
  ChunkIndex index;
  index.start = fields.u64();
  index.end = fields.u64();
  index.offset = fields.u64();
  index.length = fields.u64();
  index.message_indexes = numbers_by_id(fields.list());
  index.message_index_length = fields.u64();
  index.compression = fields.string();
  index.compressed_size = fields.u64();
  index.uncompressed_size = fields.u64();
  return index;
}

Statistics statistics_in(Fields fields) {
  Statistics statistics;
  statistics.messages = fields.u64();
  statistics.schemas = fields.u16();
  statistics.channels = fields.u32();
  fields.u32();  // attachments
  fields.u32();  // metadata
  statistics.chunks = fields.u32();
  statistics.start = fields.u64();
  statistics.end = fields.u64();
  statistics.channel_messages = numbers_by_id(fields.list());
  return statistics;
}

Footer footer_in(Fields fields) {
  Footer footer;
  footer.summary_start = fields.u64();
  footer.summary_offset_start = fields.u64();
  footer.summary_crc = fields.u32();
  return footer;
}

}  // namespace coppice::mcap
