// Files that are too large for memory. They are read piece by piece, or written by appending.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace coppice {

class BinaryInput {
 public:
  /// Throws InputError if the path does not name a regular file, or if the file cannot be read.
  explicit BinaryInput(std::filesystem::path path);
  ~BinaryInput();
  BinaryInput(BinaryInput&& other) noexcept;
  BinaryInput& operator=(BinaryInput&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Size in bytes at the time when the file was opened.
  std::uint64_t size() const { return size_; }
  /// Reads exactly `count` bytes from byte offset `place` on. Throws InputError if the file has fewer.
  std::string read(std::uint64_t place, std::size_t count) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

class BinaryOutput {
 public:
  enum class Existing : unsigned char { refuse, replace };

  /// Creates the file. Throws InputError if that fails, or if the file exists and `existing` is `refuse`.
  BinaryOutput(std::filesystem::path path, Existing existing);
  ~BinaryOutput();
  BinaryOutput(const BinaryOutput&) = delete;
  BinaryOutput& operator=(const BinaryOutput&) = delete;

  std::uint64_t size() const { return size_; }
  /// Appends all bytes with one write. If the disk has no room for all of them, none is appended, the file
  /// keeps its earlier content, and InputError is thrown.
  void append(std::string_view bytes);

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace coppice
