// The project's own C++ sources, for tests that read them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace coppice::test {

inline std::filesystem::path source_folder() {
  return COPPICE_SOURCE_DIR;
}

/// Paths from the repository's root, sorted: every .h, .cpp and .c outside of hidden folders and of generated
/// ones.
inline std::vector<std::string> source_files() {
  const std::set<std::filesystem::path> generated{"build", "out", "node_modules"};
  const std::set<std::filesystem::path> extensions{".h", ".cpp", ".c"};
  std::vector<std::string> files;
  auto entry = std::filesystem::recursive_directory_iterator(source_folder());
  for (; entry != std::filesystem::recursive_directory_iterator(); ++entry) {
    const std::filesystem::path& path = entry->path();
    const std::filesystem::path name = path.filename();
    if (entry->is_directory() && (generated.contains(name) || name.string().starts_with('.'))) {
      entry.disable_recursion_pending();
    } else if (entry->is_regular_file() && extensions.contains(path.extension())) {
      files.push_back(path.lexically_relative(source_folder()).string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace coppice::test
