// What is in a journal that no process has open, and the way on with a damaged one.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "runtime/journal_format.h"

namespace coppice {

/// Bytes of a journal that are not what was written.
struct JournalDamage {
  std::size_t from = 0;
  std::size_t until = 0;  ///< a sound record begins there, or the file ends
};

struct JournalExamination {
  std::size_t bytes = 0;
  std::size_t records = 0;  ///< sound ones
  bool complete = true;     ///< the disk was never full
  bool in_use = false;      ///< by a process that runs: its last record may be under way
  std::vector<JournalDamage> damages{};
};

/// Calls `on_record` with the place of each sound record, in bytes, and what it holds. Throws
/// std::runtime_error, which names the file, if it cannot be read, is not a journal, or is of another
/// version.
JournalExamination examine_journal(
    const std::filesystem::path& file,
    const std::function<void(std::size_t, const Recorded&)>& on_record = nullptr);

/// Leaves the sound records, and a copy of the damaged file beside it. Returns the name of the copy. Throws
/// std::runtime_error, which names the file, if a process has it open or the disk has no room; then the file
/// is as it was.
std::filesystem::path discard_damaged(const std::filesystem::path& file);

/// All journals in a folder and the folders in it, by name. Throws std::runtime_error if there is no such
/// folder.
std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder);

}  // namespace coppice
