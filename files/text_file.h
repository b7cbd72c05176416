// Reads and writes whole files.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace coppice {

/// The bytes of a file. Throws InputError if the file cannot be read or is larger than 2 GiB.
std::string read_file(const std::filesystem::path& path);

/// The text of a file without a byte-order mark. Throws InputError if the file cannot be read, or if it
/// begins like UTF-16, UTF-32 or binary data. Whether it is valid UTF-8 is not checked.
std::string read_text(const std::filesystem::path& path);

/// The extension of a file's name in lower case, with its dot: ".json" for "FLEET.JSON".
std::string ending_of(const std::filesystem::path& path);

/// The file that write_file() replaces: it follows links.
std::filesystem::path written_file(const std::filesystem::path& path);

/// Writes a temporary file beside the target and renames it: a reader sees the old file or the new one, and a
/// full disk leaves the old one. Devices and pipes are written directly. Throws InputError if the file cannot
/// be written.
void write_file(const std::filesystem::path& path, std::string_view content);
/// The same for content that is too large for memory: `write` writes it to the stream.
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

}  // namespace coppice
