// Messages on disk, in order: what a process must know again that takes the place of one that was killed.
//
// Each is on its way to the disk when `append` returns, so that it survives the process; not a loss of power.
// A file of its own rather than a database: an agent writes twenty times a second, some hundred bytes each
// time, and a database writes whole pages.
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
  /// Opens the file, or makes it; what follows after the first record that is torn is cut off. Throws
  /// std::runtime_error, which names the file, if it cannot be opened or written, is in use by another
  /// process (JournalInUse), is no journal, or holds messages of another version's types. It reads the file
  /// once; `meanwhile` is called after each record, for a long one takes seconds.
  explicit Journal(
      std::filesystem::path file, const std::function<void()>& meanwhile = [] {});
  ~Journal();
  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&&) = delete;

  /// Each message that it holds, in order, one at a time: a long run's do not fit into memory. Throws as the
  /// constructor does.
  void for_each(const std::function<void(const Message&)>& fn) const;
  bool empty() const;
  /// All of them at once.
  std::vector<Message> messages() const;

  /// Where there is no room this is logged, once, and the file counts as incomplete from then on: it keeps
  /// what it has, and takes no more.
  void append(const Message& message);
  /// The same, or empties it first.
  void keep(Keep choice, const Message& message);
  /// False: the disk was full at some time since the file was begun, and what came then is missing.
  bool complete() const { return complete_; }
  /// From now on it counts as complete, and takes more: for a process to which each message is of use without
  /// the others.
  void accept_gaps();

  const std::filesystem::path& file() const { return path_; }

 private:
  /// The record that begins there, if a whole one does.
  std::optional<std::vector<std::uint8_t>> record_at(std::size_t place) const;
  void find_end(const std::function<void()>& meanwhile);
  bool begin_anew();
  void give_up();
  bool mark(char as);
  bool write_at_end(const std::vector<std::uint8_t>& bytes);

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::size_t end_ = 0;  ///< of the last whole record
  bool complete_ = true;
};

/// The journal of a process in the folder that `--state` names, which is made if there is none; nothing if
/// that is empty: then nothing is kept. Throws as Journal does.
std::optional<Journal> journal_in(
    const std::string& folder, const std::string& process, const std::function<void()>& meanwhile = [] {});

}  // namespace coppice
