// Files that are too long for memory: read piece by piece, or written at their end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace coppice {

class BinaryInput {
 public:
  /// Throws InputError if it is no file that can be read.
  explicit BinaryInput(std::filesystem::path path);
  ~BinaryInput();
  BinaryInput(BinaryInput&& other) noexcept;
  BinaryInput& operator=(BinaryInput&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Bytes, when it was opened.
  std::uint64_t size() const { return size_; }
  /// From `place` on, all of them. Throws InputError if there are fewer.
  std::string read(std::uint64_t place, std::size_t count) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

class BinaryOutput {
 public:
  enum class Existing : unsigned char { refuse, replace };

  /// Throws InputError if it cannot be made, or is there and is not to be replaced.
  BinaryOutput(std::filesystem::path path, Existing existing);
  ~BinaryOutput();
  BinaryOutput(const BinaryOutput&) = delete;
  BinaryOutput& operator=(const BinaryOutput&) = delete;

  std::uint64_t size() const { return size_; }
  /// All of it with one write. Where there is no room for that, none of it, and throws InputError: what was
  /// there stays as it is.
  void append(std::string_view bytes);

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace coppice
