// An open file of a process's state: written in place, with room reserved on its disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace coppice {

class DiskFile {
 public:
  /// Opens or creates the file. Throws std::runtime_error, which names the file, if that fails. A new file
  /// survives a loss of power: its folder is written to disk.
  explicit DiskFile(const std::filesystem::path& path);
  ~DiskFile();
  DiskFile(DiskFile&& other) noexcept;
  DiskFile& operator=(DiskFile&& other) noexcept;

  /// False: another process has locked the file. The lock ends with this object.
  bool lock();
  /// Bytes. Throws std::runtime_error if it cannot be asked.
  std::size_t size() const;
  /// Returns up to `size` bytes from `place` on; fewer at the end of the file. Throws std::runtime_error if
  /// the disk cannot be read.
  std::vector<std::uint8_t> read(std::size_t place, std::size_t size) const;

  // These return false, with errno, if the disk is full or broken.
  bool write(std::size_t place, std::span<const std::uint8_t> bytes);
  bool cut(std::size_t size);
  /// What was written survives a loss of power.
  bool sync();
  /// Reserves room up to that size, without making the file longer. True also where a file system cannot
  /// reserve room.
  bool reserve(std::size_t size);

 private:
  int descriptor_ = -1;
};

/// Makes the two files change their names in one step. False, with errno: nothing was done.
bool exchange(const std::filesystem::path& one, const std::filesystem::path& other);
/// What was created, renamed or removed in the folder of this file survives a loss of power.
bool sync_folder_of(const std::filesystem::path& file);

/// Bytes that this process can still write to the disk of a folder; none: the folder is not there.
std::optional<std::size_t> free_room(const std::filesystem::path& folder);

}  // namespace coppice
