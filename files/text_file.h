// Whole files, read and written: what every format here begins or ends with.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace coppice {

/// The bytes of a file. Throws InputError if it cannot be read.
std::string read_file(const std::filesystem::path& path);

/// The text of a file, UTF-8, without a byte-order mark. Throws InputError if it cannot be read, or is no
/// such text.
std::string read_text(const std::filesystem::path& path);

/// Of a file's name, in lower case, with its dot: ".json" of "FLEET.JSON".
std::string ending_of(const std::filesystem::path& path);

/// The file that is replaced when a file of this name is written: a link is followed.
std::filesystem::path written_file(const std::filesystem::path& path);

/// Writes beside the target and renames: a reader sees the old file or the new one, and a full disk leaves
/// the old. Throws InputError if it cannot be written.
void write_file(const std::filesystem::path& path, std::string_view content);
/// The same, for what is not to be in memory whole.
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

}  // namespace coppice
