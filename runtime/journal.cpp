#include "runtime/journal.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "dds/serialized.h"

namespace coppice {

namespace {

// The file begins with a line of text. Then follow the records: length and checksum of the bytes, four bytes
// each, and the bytes. The content of a record depends on the message types, so the line names their version.
constexpr std::string_view magic = "coppice journal " COPPICE_MESSAGE_TYPES " ";
constexpr char whole = 'c';
constexpr char has_gaps = 'i';
constexpr std::size_t header_size = magic.size() + 2;
constexpr std::size_t frame_size = 8;
constexpr std::uint32_t longest_record = 256u << 20;  // bytes

std::uint32_t checksum(const std::uint8_t* bytes, std::size_t size) {
  return static_cast<std::uint32_t>(crc32(crc32(0, nullptr, 0), bytes, static_cast<uInt>(size)));
}

std::uint32_t number_at(const std::uint8_t* bytes) {
  return bytes[0] | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
         std::uint32_t{bytes[3]} << 24;
}

void append_number(std::uint32_t number, std::vector<std::uint8_t>& bytes) {
  for (const int shift : {0, 8, 16, 24}) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", path.string(), what));
}

/// Returns up to `size` bytes from `place` on; fewer at the end of the file.
std::vector<std::uint8_t> bytes_at(int descriptor, std::size_t place, std::size_t size,
                                   const std::filesystem::path& path) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) fail(path, std::strerror(errno));
  const auto end = static_cast<std::size_t>(status.st_size);
  std::vector<std::uint8_t> bytes(std::min(size, end - std::min(place, end)));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        pread(descriptor, bytes.data() + done, bytes.size() - done, static_cast<off_t>(place + done));
    if (got <= 0) fail(path, "reading failed");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

}  // namespace

Journal::Journal(std::filesystem::path file, const std::function<void()>& meanwhile)
    : path_(std::move(file)) {
  descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) fail(path_, fmt::format("cannot be opened for writing: {}", std::strerror(errno)));
  try {
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
      throw JournalInUse(fmt::format("{}: is in use by another process", path_.string()));
    find_end(meanwhile);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

Journal::Journal(Journal&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      end_(other.end_),
      complete_(other.complete_) {}

Journal::~Journal() {
  if (descriptor_ >= 0) close(descriptor_);
}

void Journal::find_end(const std::function<void()>& meanwhile) {
  const std::vector<std::uint8_t> header = bytes_at(descriptor_, 0, header_size, path_);
  // A process that was killed while it created the file has left only a part of the first line.
  const std::size_t known = std::min(header.size(), magic.size());
  if (!std::equal(header.begin(), header.begin() + static_cast<std::ptrdiff_t>(known), magic.begin()))
    fail(path_,
         "is not a journal, or was written by a version with other messages: remove it, or name another "
         "folder");
  if (header.size() < header_size) {
    std::vector<std::uint8_t> begin(magic.begin(), magic.end());
    begin.push_back(whole);
    begin.push_back('\n');
    if (!write_at_end(begin)) fail(path_, fmt::format("cannot be written: {}", std::strerror(errno)));
    return;
  }
  complete_ = header[magic.size()] == whole;
  end_ = header_size;
  while (const auto record = record_at(end_)) {
    end_ += frame_size + record->size();
    meanwhile();
  }
  if (ftruncate(descriptor_, static_cast<off_t>(end_)) != 0) fail(path_, std::strerror(errno));
}

std::optional<std::vector<std::uint8_t>> Journal::record_at(std::size_t place) const {
  const std::vector<std::uint8_t> frame = bytes_at(descriptor_, place, frame_size, path_);
  if (frame.size() < frame_size) return std::nullopt;
  const std::uint32_t length = number_at(frame.data());
  if (length > longest_record) return std::nullopt;
  std::vector<std::uint8_t> record = bytes_at(descriptor_, place + frame_size, length, path_);
  const bool sound =
      record.size() == length && number_at(frame.data() + 4) == checksum(record.data(), record.size());
  return sound ? std::optional(std::move(record)) : std::nullopt;
}

void Journal::for_each(const std::function<void(const Message&)>& fn) const {
  for (std::size_t place = header_size; place < end_;) {
    const auto record = record_at(place);
    if (!record) fail(path_, "has changed since it was opened");
    if (const auto message = deserialized(*record)) fn(*message);
    place += frame_size + record->size();
  }
}

bool Journal::empty() const {
  return end_ == header_size;
}

std::vector<Message> Journal::messages() const {
  std::vector<Message> all;
  for_each([&](const Message& message) { all.push_back(message); });
  return all;
}

/// The first line stays: a full disk may have no room to write it again, and a file without it counts as new.
/// The records are removed before the mark is set: a file with gaps must never count as complete.
bool Journal::begin_anew() {
  if (ftruncate(descriptor_, static_cast<off_t>(header_size)) != 0) return false;
  end_ = header_size;
  complete_ = complete_ || mark(whole);
  return complete_;
}

/// Overwrites one byte in place, which needs no room.
bool Journal::mark(char as) {
  const bool done = pwrite(descriptor_, &as, 1, static_cast<off_t>(magic.size())) == 1;
  if (!done) spdlog::error("{}: cannot be marked: {}", path_.string(), std::strerror(errno));
  return done;
}

void Journal::accept_gaps() {
  complete_ = complete_ || mark(whole);
}

bool Journal::write_at_end(const std::vector<std::uint8_t>& bytes) {
  const ssize_t written = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(end_));
  if (written == static_cast<ssize_t>(bytes.size())) {
    end_ += bytes.size();
    return true;
  }
  const int error = written < 0 ? errno : ENOSPC;
  if (ftruncate(descriptor_, static_cast<off_t>(end_)) != 0)
    spdlog::error("{}: {}", path_.string(), std::strerror(errno));
  errno = error;
  return false;
}

void Journal::append(const Message& message) {
  if (!complete_) return;
  const std::vector<std::uint8_t> bytes = serialized(message);
  std::vector<std::uint8_t> record;
  record.reserve(frame_size + bytes.size());
  append_number(static_cast<std::uint32_t>(bytes.size()), record);
  append_number(checksum(bytes.data(), bytes.size()), record);
  record.insert(record.end(), bytes.begin(), bytes.end());
  if (!write_at_end(record)) give_up();
}

void Journal::give_up() {
  spdlog::error("{}: cannot be written: {}; later messages are not kept", path_.string(),
                std::strerror(errno));
  complete_ = false;
  mark(has_gaps);
}

void Journal::keep(Keep choice, const Message& message) {
  if (choice == Keep::begin_anew && !begin_anew()) give_up();
  if (choice != Keep::nothing) append(message);
}

void make_folder(const std::string& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) fail(folder, fmt::format("cannot be made: {}", problem.message()));
}

std::optional<Journal> journal_in(const std::string& folder, const std::string& process,
                                  const std::function<void()>& meanwhile) {
  if (folder.empty()) return std::nullopt;
  make_folder(folder);
  std::string name;
  for (const char c : process) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    name += plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  }
  return Journal(std::filesystem::path(folder) / (name + ".journal"), meanwhile);
}

}  // namespace coppice
