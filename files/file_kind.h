// Recognises a file's kind by its first bytes. Error messages use it when a file of another kind was
// expected.
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

/// `begin`: the first bytes of the file; a few thousand are enough.
FileKind kind_of_file(std::string_view begin);

/// Throws InputError if the file is a folder or cannot be read, or if its kind is known (`empty` is one) and
/// not among `fitting`. `expected` describes the fitting kinds: "a scenario (.json or .scen)".
void refuse_other_kinds(const std::filesystem::path& path, std::initializer_list<FileKind> fitting,
                        const std::string& expected);

}  // namespace coppice
