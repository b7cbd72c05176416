#include "monitor/recording/mcap_writer.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <zstd.h>

namespace coppice {

using mcap::Bytes;
using mcap::Opcode;

namespace {

Bytes compressed(const Bytes& records) {
  Bytes out(ZSTD_compressBound(records.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), records.data(), records.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

}  // namespace

void McapChunk::add(std::uint16_t channel, std::uint32_t sequence, mcap::Time log_time,
                    std::string_view data) {
  start_ = empty() ? log_time : std::min(start_, log_time);
  end_ = std::max(end_, log_time);
  indexes_[channel].push_back({log_time, records_.size()});
  records_.push_back(static_cast<char>(Opcode::message));
  mcap::append_u64(records_, mcap::message_head + data.size());
  mcap::append_u16(records_, channel);
  mcap::append_u32(records_, sequence);
  mcap::append_u64(records_, log_time);
  mcap::append_u64(records_, log_time);  // publish time, which is not known
  records_ += data;
}

McapWriter::McapWriter(std::string_view library, Compression compression) : compression_(compression) {
  out_ = mcap::magic;
  Bytes header;
  mcap::append_string(header, "");  // profile: none
  mcap::append_string(header, library);
  mcap::append_record(out_, Opcode::header, header);
}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::string_view encoding,
                                      std::string_view schema_name, std::string_view schema) {
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  schemas_.push_back({id, std::string(schema_name), std::string(encoding), Bytes(schema)});
  channels_.push_back({id, id, std::string(topic), std::string(encoding)});
  mcap::append_record(out_, Opcode::schema, content_of(schemas_.back()));
  mcap::append_record(out_, Opcode::channel, content_of(channels_.back()));
  return id;
}

void McapWriter::write(const McapChunk& chunk) {
  if (chunk.empty()) return;
  const bool compresses = compression_ == Compression::zstd;
  const Bytes records = compresses ? compressed(chunk.records_) : chunk.records_;
  mcap::ChunkIndex index{.start = chunk.start_,
                         .end = chunk.end_,
                         .offset = end(),
                         .compression = std::string(compresses ? mcap::zstd : ""),
                         .compressed_size = records.size(),
                         .uncompressed_size = chunk.size()};
  Bytes content;
  mcap::append_u64(content, index.start);
  mcap::append_u64(content, index.end);
  mcap::append_u64(content, index.uncompressed_size);
  mcap::append_u32(content, mcap::crc32(chunk.records_));
  mcap::append_string(content, index.compression);
  mcap::append_u64(content, records.size());
  content += records;
  mcap::append_record(out_, Opcode::chunk, content);
  index.length = end() - index.offset;

  for (const auto& [channel, entries] : chunk.indexes_) {
    index.message_indexes[channel] = end();
    Bytes list;
    mcap::append_u16(list, channel);
    mcap::append_u32(list, static_cast<std::uint32_t>(entries.size() * 16));
    for (const McapChunk::Entry& entry : entries) {
      mcap::append_u64(list, entry.time);
      mcap::append_u64(list, entry.offset);
      statistics_.count(channel, entry.time);
    }
    mcap::append_record(out_, Opcode::message_index, list);
  }
  index.message_index_length = end() - index.offset - index.length;
  chunks_.push_back(std::move(index));
}

void McapWriter::finish() {
  Bytes checksum;
  mcap::append_u32(checksum, mcap::crc32(out_, crc_));
  mcap::append_record(out_, Opcode::data_end, checksum);
  write_summary();
  out_ += mcap::magic;
}

void McapWriter::write_summary() {
  const std::size_t begin = out_.size();
  const std::uint64_t summary_start = end();
  statistics_.schemas = static_cast<std::uint16_t>(schemas_.size());
  statistics_.channels = static_cast<std::uint32_t>(channels_.size());
  statistics_.chunks = static_cast<std::uint32_t>(chunks_.size());
  const auto contents = [](const auto& all) {
    std::vector<Bytes> each;
    for (const auto& one : all) each.push_back(content_of(one));
    return each;
  };
  Bytes offsets;
  write_summary_group(Opcode::schema, contents(schemas_), offsets);
  write_summary_group(Opcode::channel, contents(channels_), offsets);
  write_summary_group(Opcode::statistics, {content_of(statistics_)}, offsets);
  write_summary_group(Opcode::chunk_index, contents(chunks_), offsets);
  const std::uint64_t summary_offset_start = end();
  out_ += offsets;

  // The footer's checksum covers the summary and the footer up to this field.
  out_.push_back(static_cast<char>(Opcode::footer));
  mcap::append_u64(out_, mcap::footer_size - mcap::record_head);
  mcap::append_u64(out_, summary_start);
  mcap::append_u64(out_, summary_offset_start);
  mcap::append_u32(out_, mcap::crc32(std::string_view(out_).substr(begin)));
}

void McapWriter::write_summary_group(Opcode opcode, const std::vector<Bytes>& contents, Bytes& offsets) {
  if (contents.empty()) return;
  const std::uint64_t start = end();
  for (const Bytes& content : contents) mcap::append_record(out_, opcode, content);
  Bytes offset(1, static_cast<char>(opcode));
  mcap::append_u64(offset, start);
  mcap::append_u64(offset, end() - start);
  mcap::append_record(offsets, Opcode::summary_offset, offset);
}

Bytes McapWriter::take() {
  crc_ = mcap::crc32(out_, crc_);
  taken_ += out_.size();
  return std::exchange(out_, {});
}

}  // namespace coppice
