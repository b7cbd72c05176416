// A temporary folder that is removed after use, and where temporary files are made.
#pragma once

#include <filesystem>

namespace coppice {

/// The folder that TMPDIR names, or else /tmp, as an absolute path. Throws InputError if it is not a folder
/// or cannot be written to.
std::filesystem::path place_for_temporary_files();

/// Makes a folder, and removes it with its content at the end.
class TemporaryFolder {
 public:
  /// Throws InputError if the folder cannot be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace coppice
