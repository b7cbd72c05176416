// What a file is, by how it begins: for those who give one kind of file where another is expected.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace coppice {

enum class FileKind : unsigned char {
  unknown,
  empty,
  map,        ///< Moving AI
  ros_map,    ///< YAML of map_server
  scenario,   ///< JSON
  scen,       ///< Moving AI
  recording,  ///< MCAP
  report,
  trajectory,
  picture,
};

/// By the first bytes, a few thousand at most.
FileKind kind_of_file(std::string_view begin);

/// Throws InputError if the file is of a known kind and of none of `fitting`, empty or a folder, or cannot be
/// read. `expected`: "a scenario (.json or .scen)".
void refuse_other_kinds(const std::filesystem::path& path, std::initializer_list<FileKind> fitting,
                        const std::string& expected);

}  // namespace coppice
