// A folder for a while, and where such things go.
#pragma once

#include <filesystem>

namespace coppice {

/// What TMPDIR names, or /tmp. Throws InputError if that is no folder that may be written to.
std::filesystem::path place_for_temporary_files();

/// Removed, with all that is in it, at the end.
class TemporaryFolder {
 public:
  /// Throws InputError if none can be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace coppice
