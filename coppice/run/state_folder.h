// The folder in which the processes of a fleet on this machine keep their state (--state).
#pragma once

#include <filesystem>
#include <optional>

namespace coppice {

/// Where a standing fleet keeps its state unless it is told where: one folder for each site, and each domain
/// that is named, below $XDG_STATE_HOME, or ~/.local/state (XDG base directories). Throws InputError if the
/// environment names neither.
std::filesystem::path usual_state_folder(const std::filesystem::path& site, std::optional<int> domain);

/// Keeps other fleets from using a folder, as long as it lives.
class FolderLock {
 public:
  /// Throws InputError if another fleet uses the folder.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace coppice
