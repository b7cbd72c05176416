#include "runtime/journal_examination.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "runtime/disk_file.h"
#include "runtime/journal_format.h"

namespace coppice {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", file.string(), what));
}

DiskFile opened(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) refuse(file, "there is no such file");
  if (!std::filesystem::is_regular_file(file)) refuse(file, "is not a journal");
  return DiskFile(file);
}

using OnRecord = std::function<void(std::size_t, std::span<const std::uint8_t>)>;

/// Calls `on_record` with the place and the bytes of each sound record.
JournalExamination examined(const std::filesystem::path& path, const DiskFile& file,
                            const OnRecord& on_record) {
  const auto head = head_of(file);
  if (std::holds_alternative<ForeignFile>(head))
    refuse(path, "is not a journal, or was written by a version with other messages");
  RecordReader reader(file);
  JournalExamination all{.bytes = reader.file_size()};
  if (const auto* const whole = std::get_if<JournalHead>(&head)) all.complete = whole->complete;
  if (std::holds_alternative<DamagedHead>(head)) all.damages.push_back({0, first_line_size});
  std::size_t place = std::min(first_line_size, all.bytes);
  while (place < all.bytes) {
    if (const auto record = reader.at(place)) {
      ++all.records;
      on_record(place, *record);
      place = RecordReader::end_of(place, *record);
      continue;
    }
    const std::size_t next = reader.next_sound(place + 1).value_or(all.bytes);
    all.damages.push_back({place, next});
    place = next;
  }
  return all;
}

/// Beside the file, under a name that nothing has.
std::filesystem::path name_for_copy(const std::filesystem::path& file) {
  std::filesystem::path name = file.string() + ".damaged";
  for (int k = 2; std::filesystem::exists(name); ++k) name = fmt::format("{}.damaged-{}", file.string(), k);
  return name;
}

}  // namespace

JournalExamination examine_journal(const std::filesystem::path& path,
                                   const std::function<void(std::size_t, const Recorded&)>& on_record) {
  DiskFile file = opened(path);
  JournalExamination all = examined(path, file, [&](std::size_t place, std::span<const std::uint8_t> record) {
    if (on_record) on_record(place, recorded_in(record));
  });
  all.in_use = !file.lock();
  return all;
}

std::filesystem::path discard_damaged(const std::filesystem::path& path) {
  DiskFile file = opened(path);
  if (!file.lock()) refuse(path, "is in use by a process that runs: end the fleet first");
  std::vector<std::uint8_t> sound(first_line_size);
  const JournalExamination found =
      examined(path, file, [&](std::size_t, std::span<const std::uint8_t> record) {
        const std::vector<std::uint8_t> whole = framed(record);
        sound.insert(sound.end(), whole.begin(), whole.end());
      });
  std::ranges::copy(first_line({found.complete, sound.size()}), sound.begin());
  const std::filesystem::path copy = name_for_copy(path);
  const std::filesystem::path repaired = path.string() + ".repaired";
  std::error_code problem;
  std::filesystem::copy_file(path, copy, problem);
  if (problem) refuse(copy, fmt::format("cannot be written: {}", problem.message()));
  DiskFile to(repaired);
  const bool is_written = to.cut(0) && to.write(0, sound) && to.sync();
  if (!is_written) refuse(repaired, fmt::format("cannot be written: {}", std::strerror(errno)));
  std::filesystem::rename(repaired, path);
  sync_folder_of(path);
  return copy;
}

std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) refuse(folder, "is not a folder");
  std::vector<std::filesystem::path> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() == ".journal") all.push_back(entry.path());
  }
  std::ranges::sort(all);
  return all;
}

}  // namespace coppice
