// The records of MCAP, format 0, a file of messages, and their bytes.
//
// Source: https://mcap.dev/spec (opcodes, order of fields, checksums) and https://mcap.dev/spec/registry
// (names of encodings and compressions). Integers are little-endian. Times are nanoseconds since 1970. A
// record consists of its opcode, the length of its content in eight bytes, and the content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace coppice::mcap {

using Time = std::uint64_t;
using Bytes = std::string;

inline constexpr std::string_view magic{"\x89MCAP0\r\n", 8};
inline constexpr std::size_t record_head = 9;                 // opcode and length
inline constexpr std::size_t message_head = 22;               // part of a message's content before its data
inline constexpr std::size_t footer_size = record_head + 20;  // fixed by the format
inline constexpr std::string_view zstd = "zstd";
inline constexpr std::string_view protobuf = "protobuf";

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

struct Schema {
  std::uint16_t id = 0;  ///< above 0
  std::string name;
  std::string encoding;
  Bytes data;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;
  std::string topic;
  std::string message_encoding;
};

struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  Time log_time = 0;
  std::string_view data;
};

struct ChunkHead {
  Time start = 0;  ///< of its messages
  Time end = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t crc = 0;  ///< of its records before compression; 0: not known
  std::string compression;
  std::uint64_t size = 0;  ///< of its records in the file
};

struct ChunkIndex {
  Time start = 0;
  Time end = 0;
  std::uint64_t offset = 0;                                  ///< of the record in the file
  std::uint64_t length = 0;                                  ///< of the whole record
  std::map<std::uint16_t, std::uint64_t> message_indexes{};  ///< positions in the file, by channel
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

struct Statistics {
  std::uint64_t messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0;
  std::uint32_t chunks = 0;
  Time start = 0;
  Time end = 0;
  std::map<std::uint16_t, std::uint64_t> channel_messages{};

  void count(std::uint16_t channel, Time at);
};

struct Footer {
  std::uint64_t summary_start = 0;  ///< 0: none
  std::uint64_t summary_offset_start = 0;
  std::uint32_t summary_crc = 0;
};

std::uint32_t crc32(std::string_view bytes, std::uint32_t of_those_before = 0);

// --- bytes of records ---

void append_u16(Bytes& out, std::uint16_t value);
void append_u32(Bytes& out, std::uint32_t value);
void append_u64(Bytes& out, std::uint64_t value);
void append_string(Bytes& out, std::string_view text);
void append_record(Bytes& out, Opcode opcode, std::string_view content);

Bytes content_of(const Schema& schema);
Bytes content_of(const Channel& channel);
Bytes content_of(const ChunkIndex& index);
Bytes content_of(const Statistics& statistics);

// --- fields of records ---

/// The origin of bytes, for error messages.
struct Origin {
  std::string_view file;
  std::uint64_t offset = 0;  ///< of the record
};
/// Throws InputError with the file, the byte at which the record begins, and `what`.
[[noreturn]] void refuse(const Origin& origin, std::string_view what);

/// Takes one field after the other. Refuses a record that is too short for a field.
class Fields {
 public:
  Fields(std::string_view content, const Origin& origin) : left_(content), origin_(origin) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  std::string_view bytes(std::uint64_t count);
  std::string_view string() { return bytes(u32()); }
  /// Returns the entries of a map or an array.
  Fields list() { return {string(), origin_}; }
  std::string_view rest() { return bytes(left_.size()); }
  bool empty() const { return left_.empty(); }

 private:
  std::uint64_t number(std::size_t count);

  std::string_view left_;
  Origin origin_;
};

Schema schema_in(Fields fields);
Channel channel_in(Fields fields);
Message message_in(Fields fields);
/// Reads the fields of a chunk that come before its records.
ChunkHead chunk_head_in(Fields& fields);
ChunkIndex chunk_index_in(Fields fields);
Statistics statistics_in(Fields fields);
Footer footer_in(Fields fields);

}  // namespace coppice::mcap
