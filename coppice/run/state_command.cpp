#include <iostream>
#include <string>

#include <fmt/format.h>

#include "coppice/commands.h"
#include "runtime/disk_file.h"
#include "runtime/journal_examination.h"

namespace coppice {

namespace {

std::string state_of(const JournalExamination& journal) {
  if (journal.in_use) return "in use";
  if (!journal.damages.empty()) return "damaged";
  return journal.complete ? "sound" : "incomplete, because the disk was full";
}

void tell_of(const std::filesystem::path& file, const JournalExamination& journal) {
  std::cout << fmt::format("{}: {}, {} records, {:.1f} kB\n", file.string(), state_of(journal),
                           journal.records, static_cast<double>(journal.bytes) / 1000);
  if (journal.in_use) return;
  for (const JournalDamage& damage : journal.damages)
    std::cout << fmt::format("  damaged from byte {} to byte {}\n", damage.from, damage.until);
}

}  // namespace

int state_command(const StateOptions& options) {
  bool is_sound = true;
  const auto journals = journals_in(options.folder);
  if (journals.empty()) std::cout << fmt::format("{} holds no journals\n", options.folder);
  for (const std::filesystem::path& file : journals) {
    const JournalExamination journal = examine_journal(file);
    tell_of(file, journal);
    const bool is_damaged = !journal.in_use && !journal.damages.empty();
    if (is_damaged && options.discards) {
      const std::filesystem::path copy = discard_damaged(file);
      std::cout << fmt::format("  keeps its {} sound records now; the file as it was is {}\n",
                               journal.records, copy.string());
    }
    is_sound = is_sound && (!is_damaged || options.discards);
  }
  std::cout << fmt::format("{:.1f} MB of the disk are free\n",
                           static_cast<double>(free_room(options.folder).value_or(0)) / 1e6);
  return is_sound ? 0 : 1;
}

}  // namespace coppice
