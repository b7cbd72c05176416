// Messages on disk, in order: what the successor of a killed process must know.
//
// `append` hands a message to the operating system before it returns. So the message survives the process.
// `sync` makes what counts survive a loss of power too. A process that saves twenty states a second does not
// wait for its disk: after a loss of power its robot has long come to rest. The journal is a plain file and
// no database, which would write whole pages for a few hundred bytes.
//
// A journal with room does not grow with time: its owner rewrites it, with what its messages amount to. The
// disk holds room for the file and for its successor (FILE.next), so that a full disk does not keep a process
// from saving where it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "messages/keep.h"
#include "messages/messages.h"
#include "runtime/disk_file.h"
#include "runtime/journal_format.h"

namespace coppice {

/// Another process has the file open.
class JournalInUse : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Bytes. Room of a journal that is never rewritten.
inline constexpr std::size_t no_room = 0;

class Journal {
 public:
  /// Opens or creates the file. Cuts off a record at its end that was not written to its end. Throws
  /// std::runtime_error, which names the file, if it cannot be opened or written, is in use by another
  /// process (JournalInUse), is not a journal, holds message types of another version, or is damaged: then
  /// the line says where, and what to do. `room`: bytes by which the file may grow before it is to be
  /// rewritten. Reads the whole file once; calls `meanwhile` after each record.
  explicit Journal(
      std::filesystem::path file, std::size_t room = no_room, const std::function<void()>& meanwhile = [] {});

  /// Calls `fn` with each message in order, and `note` with each note. Reads one at a time, because those of
  /// a long run do not fit into memory. Throws as the constructor does.
  void for_each(
      const std::function<void(const Message&)>& fn,
      const std::function<void(const std::string&)>& note = [](const std::string&) {}) const;
  bool empty() const;
  /// Returns all messages at once.
  std::vector<Message> messages() const;

  /// False: it was not saved, because the disk is full or broken, now or before. The file counts as
  /// incomplete until it is rewritten: it keeps its messages and takes no more.
  bool append(const Message& message);
  /// Appends the message, or removes all others first, or does nothing, as `choice` says. False as above.
  bool keep(Keep choice, const Message& message);
  /// Removes all messages. False: the disk is full or broken.
  bool begin_anew();
  /// Returns when all messages that were kept with Keep::append_surely are on disk. False: the disk failed.
  bool sync();

  /// It is time to rewrite it: it is long, or incomplete.
  bool wants_rewriting() const;
  /// Replaces all that it holds, in one step. False: the disk is full, and the file stays as it was.
  bool rewrite(std::span<const Message> messages, std::string_view note = {});

  /// False if messages are missing because the disk was full since the file was begun or rewritten.
  bool complete() const { return complete_; }
  /// Makes the file count as complete, so that it takes messages again. For a process to which each message
  /// is useful without the others.
  void accept_gaps();

  const std::filesystem::path& file() const { return path_; }
  /// Removes the files. The journal is of no use afterwards.
  void remove();

 private:
  void find_end(const std::function<void()>& meanwhile);
  void begin_file();
  bool open_successor();
  bool write_at_end(std::span<const std::uint8_t> bytes);
  bool write_successor(std::span<const std::uint8_t> bytes);
  bool reserve_successor();
  void give_up(const char* what);
  bool mark();
  void reserve();

  std::filesystem::path path_;
  std::size_t room_;
  DiskFile file_;
  std::optional<DiskFile> next_{};  ///< holds room for the successor of the file
  std::size_t end_ = 0;             ///< end of the last complete record
  std::size_t synced_ = 0;          ///< of these, bytes that are on disk for certain
  std::size_t rewritten_ = 0;       ///< end when it was rewritten; 0: not by this process
  std::size_t longest_ = 0;         ///< a longer file is to be rewritten
  bool must_sync_ = false;
  bool complete_ = true;
  bool has_told_ = false;    ///< that it cannot be written
  bool lacks_room_ = false;  ///< for its growth, and has said so
};

/// Makes a folder for journals if there is none. Throws std::runtime_error if that fails.
void make_folder(const std::string& folder);

/// The journal of a process in the folder that `--state` names. Creates the folder. Returns nothing if
/// `folder` is empty: then nothing is kept. Throws as Journal does.
std::optional<Journal> journal_in(
    const std::string& folder, const std::string& process, std::size_t room = no_room,
    const std::function<void()>& meanwhile = [] {});

}  // namespace coppice
