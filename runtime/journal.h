// Messages on disk, in order: what the successor of a killed process must know.
//
// `append` hands a message to the operating system before it returns. So the message survives the process,
// but not a loss of power. The journal is a plain file and no database: an agent writes a few hundred bytes
// twenty times a second, and a database would write whole pages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "messages/keep.h"
#include "messages/messages.h"

namespace coppice {

/// Another process has the file open.
class JournalInUse : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Journal {
 public:
  /// Opens or creates the file. Cuts off everything after the last complete record before the first damaged
  /// one. Throws std::runtime_error, which names the file, if it cannot be opened or written, is in use by
  /// another process (JournalInUse), is not a journal, or holds message types of another version. Reads the
  /// whole file once, which takes seconds for a long file; calls `meanwhile` after each record.
  explicit Journal(
      std::filesystem::path file, const std::function<void()>& meanwhile = [] {});
  ~Journal();
  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&&) = delete;

  /// Calls `fn` with each message in order. Reads one message at a time, because those of a long run do not
  /// fit into memory. Throws as the constructor does.
  void for_each(const std::function<void(const Message&)>& fn) const;
  bool empty() const;
  /// Returns all messages at once.
  std::vector<Message> messages() const;

  /// If the disk is full, this is logged once, and the file counts as incomplete from then on: it keeps its
  /// messages and takes no more.
  void append(const Message& message);
  /// Appends the message, or removes all others first, or does nothing, as `choice` says.
  void keep(Keep choice, const Message& message);
  /// False if messages are missing because the disk was full at some time since the file was begun.
  bool complete() const { return complete_; }
  /// Makes the file count as complete, so that it takes messages again. For a process to which each message
  /// is useful without the others.
  void accept_gaps();

  const std::filesystem::path& file() const { return path_; }

 private:
  /// The record at this place, if it is complete.
  std::optional<std::vector<std::uint8_t>> record_at(std::size_t place) const;
  void find_end(const std::function<void()>& meanwhile);
  bool begin_anew();
  void give_up();
  bool mark(char as);
  bool write_at_end(const std::vector<std::uint8_t>& bytes);

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::size_t end_ = 0;  ///< end of the last complete record
  bool complete_ = true;
};

/// Makes a folder for journals if there is none. Throws std::runtime_error if that fails.
void make_folder(const std::string& folder);

/// The journal of a process in the folder that `--state` names. Creates the folder. Returns nothing if
/// `folder` is empty: then nothing is kept. Throws as Journal does.
std::optional<Journal> journal_in(
    const std::string& folder, const std::string& process, const std::function<void()>& meanwhile = [] {});

}  // namespace coppice
