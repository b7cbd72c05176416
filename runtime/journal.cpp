#include "runtime/journal.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace coppice {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", path.string(), what));
}

[[noreturn]] void fail_as_damaged(const std::filesystem::path& path, std::size_t place) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  fail(path,
       fmt::format("is damaged at byte {}: end the fleet; `coppice state {}` lists the damages, and with "
                   "--discard-damaged it removes the damaged records and keeps the others",
                   place, folder.string()));
}

std::filesystem::path successor_of(const std::filesystem::path& file) {
  return file.string() + ".next";
}

std::span<const std::uint8_t> as_bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

Journal::Journal(std::filesystem::path file, std::size_t room, const std::function<void()>& meanwhile)
    : path_(std::move(file)), room_(room), file_(path_) {
  if (!file_.lock()) throw JournalInUse(fmt::format("{}: is in use by another process", path_.string()));
  find_end(meanwhile);
  if (room_ == no_room) return;
  open_successor();
  reserve();
}

void Journal::find_end(const std::function<void()>& meanwhile) {
  const auto head = head_of(file_);
  if (std::holds_alternative<ForeignFile>(head))
    fail(path_,
         "is not a journal, or was written by a version with other messages: remove it, or name another "
         "folder");
  if (std::holds_alternative<DamagedHead>(head)) fail_as_damaged(path_, 0);
  if (std::holds_alternative<NoHead>(head)) return begin_file();
  complete_ = std::get<JournalHead>(head).complete;
  synced_ = std::get<JournalHead>(head).synced;
  RecordReader reader(file_);
  end_ = first_line_size;
  while (const auto record = reader.at(end_)) {
    end_ = RecordReader::end_of(end_, *record);
    meanwhile();
  }
  if (end_ == reader.file_size()) return;
  // A record that was being written when the process was killed, or the power failed, is the last one. What
  // was on disk for certain is never cut off silently, unless the file ends there.
  const bool is_torn = reader.is_torn(end_) || end_ >= synced_;
  if (!is_torn || reader.next_sound(end_ + 1)) fail_as_damaged(path_, end_);
  if (!file_.cut(end_)) fail(path_, fmt::format("cannot be written: {}", std::strerror(errno)));
}

void Journal::begin_file() {
  synced_ = end_ = first_line_size;
  if (!file_.write(0, as_bytes_of(first_line({complete_, synced_}))))
    fail(path_, fmt::format("cannot be written: {}", std::strerror(errno)));
}

void Journal::for_each(const std::function<void(const Message&)>& fn,
                       const std::function<void(const std::string&)>& note) const {
  RecordReader reader(file_);
  for (std::size_t place = first_line_size; place < end_;) {
    const auto record = reader.at(place);
    if (!record) fail(path_, "has changed since it was opened");
    place = RecordReader::end_of(place, *record);
    const Recorded recorded = recorded_in(*record);
    if (const auto* const message = std::get_if<Message>(&recorded)) fn(*message);
    if (const auto* const text = std::get_if<std::string>(&recorded)) note(*text);
  }
}

bool Journal::empty() const {
  return end_ == first_line_size;
}

std::vector<Message> Journal::messages() const {
  std::vector<Message> all;
  for_each([&](const Message& message) { all.push_back(message); });
  return all;
}

/// False: the disk has no room for another file. A process that has the journal has its successor.
bool Journal::open_successor() {
  try {
    if (!next_) next_.emplace(successor_of(path_));
    return next_->lock();
  } catch (const std::runtime_error&) {
    return false;
  }
}

/// Without room, the first line stays: a full disk may have no room to write it again, and a file without it
/// counts as new. The records are removed before the mark is set: a file with gaps must never count as
/// complete.
bool Journal::begin_anew() {
  if (room_ > no_room) return rewrite({});
  if (!file_.cut(first_line_size)) return false;
  synced_ = end_ = first_line_size;
  complete_ = true;
  complete_ = mark();
  return complete_;
}

/// Overwrites the first line in place, which needs no room.
bool Journal::mark() {
  const bool done = file_.write(0, as_bytes_of(first_line({complete_, synced_})));
  if (!done) spdlog::error("{}: cannot be marked: {}", path_.string(), std::strerror(errno));
  return done;
}

void Journal::accept_gaps() {
  complete_ = true;
  complete_ = mark();
}

bool Journal::write_at_end(std::span<const std::uint8_t> bytes) {
  if (file_.write(end_, bytes)) {
    end_ += bytes.size();
    return true;
  }
  const int error = errno;
  if (!file_.cut(end_)) spdlog::error("{}: {}", path_.string(), std::strerror(errno));
  errno = error;
  return false;
}

bool Journal::append(const Message& message) {
  if (!complete_) return false;
  if (write_at_end(record_of(message))) {
    has_told_ = false;
    return true;
  }
  give_up("later messages are not kept");
  return false;
}

void Journal::give_up(const char* what) {
  if (!std::exchange(has_told_, true))
    spdlog::error("{}: cannot be written: {}; {}", path_.string(), std::strerror(errno), what);
  complete_ = false;
  mark();
}

bool Journal::keep(Keep choice, const Message& message) {
  if (choice == Keep::nothing) return true;
  if (choice == Keep::begin_anew && !begin_anew()) give_up("its messages are not kept");
  must_sync_ = must_sync_ || choice == Keep::append_surely;
  return append(message);
}

bool Journal::sync() {
  if (!std::exchange(must_sync_, false)) return true;
  if (!file_.sync()) {
    give_up("it is not certain that it is on disk");
    return false;
  }
  synced_ = end_;
  return mark();
}

/// Without `room` the owner knows no way to rewrite it.
bool Journal::wants_rewriting() const {
  return room_ > no_room && (!complete_ || end_ + room_ / 8 > longest_);
}

/// Cutting a file gives away the room behind its new end, which another process takes if the disk is full.
bool Journal::write_successor(std::span<const std::uint8_t> bytes) {
  return next_->write(0, bytes) && (next_->size() == bytes.size() || next_->cut(bytes.size()));
}

bool Journal::rewrite(std::span<const Message> messages, std::string_view note) {
  std::vector<std::uint8_t> bytes(first_line_size);
  const auto add = [&](const std::vector<std::uint8_t>& record) {
    bytes.insert(bytes.end(), record.begin(), record.end());
  };
  if (!note.empty()) add(record_of_note(note));
  for (const Message& message : messages) add(record_of(message));
  std::ranges::copy(first_line({true, bytes.size()}), bytes.begin());
  const bool is_there =
      open_successor() && write_successor(bytes) && next_->sync() && exchange(successor_of(path_), path_);
  if (!is_there) {
    if (!std::exchange(has_told_, true))
      spdlog::error("{}: cannot be rewritten: {}", path_.string(), std::strerror(errno));
    reserve();
    return false;
  }
  std::swap(file_, *next_);
  if (!sync_folder_of(path_)) spdlog::error("{}: {}", path_.parent_path().string(), std::strerror(errno));
  // A file system that cannot exchange names has taken that of the successor away.
  if (!std::filesystem::exists(successor_of(path_))) next_.reset();
  open_successor();
  if (std::exchange(has_told_, false)) spdlog::info("{}: is complete again", path_.string());
  complete_ = true;
  must_sync_ = false;
  rewritten_ = synced_ = end_ = bytes.size();
  longest_ = 0;
  reserve();
  return true;
}

/// The successor is empty, so that it needs no cut when it is written. With less room than that it keeps at
/// least what it has.
bool Journal::reserve_successor() {
  if (!next_) return false;
  const std::size_t has = next_->size();
  if (has > 0 && !next_->cut(0)) return false;
  if (next_->reserve(longest_)) return true;
  const int error = errno;
  if (has > 0) next_->reserve(std::min(has, longest_));
  errno = error;
  return false;
}

/// The file may grow by half, and by its room. Its successor may become as long.
void Journal::reserve() {
  if (longest_ == 0) longest_ = end_ + end_ / 2 + room_;
  const bool has_room = file_.reserve(longest_) && reserve_successor();
  if (has_room) lacks_room_ = false;
  if (has_room) return;
  // The file is rewritten soon, into the room that its successor has.
  if (end_ > rewritten_) longest_ = end_;
  if (!std::exchange(lacks_room_, true))
    spdlog::warn("{}: the disk has no room left to reserve for it: {}", path_.string(), std::strerror(errno));
}

void Journal::remove() {
  std::filesystem::remove(path_);
  if (next_) std::filesystem::remove(successor_of(path_));
  sync_folder_of(path_);
}

void make_folder(const std::string& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) fail(folder, fmt::format("cannot be made: {}", problem.message()));
}

std::optional<Journal> journal_in(const std::string& folder, const std::string& process, std::size_t room,
                                  const std::function<void()>& meanwhile) {
  if (folder.empty()) return std::nullopt;
  make_folder(folder);
  std::string name;
  for (const char c : process) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    name += plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  }
  return Journal(std::filesystem::path(folder) / (name + ".journal"), room, meanwhile);
}

}  // namespace coppice
