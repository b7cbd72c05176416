#include "files/binary_file.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "coppice/files/input_error.h"

namespace coppice {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw InputError(fmt::format("{}: {}", path.string(), what));
}

}  // namespace

BinaryInput::BinaryInput(std::filesystem::path path) : path_(std::move(path)) {
  descriptor_ = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
  struct stat status {};
  if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    close(descriptor_);
    fail(path_, "cannot be read: not a regular file");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

BinaryInput::BinaryInput(BinaryInput&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

BinaryInput::~BinaryInput() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::string BinaryInput::read(std::uint64_t place, std::size_t count) const {
  if (place > size_ || count > size_ - place)
    fail(path_, fmt::format("expected {} bytes at byte {}, found the end", count, place));
  std::string bytes(count, '\0');
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got =
        pread(descriptor_, bytes.data() + done, count - done, static_cast<off_t>(place + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
    if (got == 0) fail(path_, "has become shorter while it was read");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

BinaryOutput::BinaryOutput(std::filesystem::path path, Existing existing) : path_(std::move(path)) {
  const int how = existing == Existing::refuse ? O_EXCL : O_TRUNC;
  descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | how, 0644);
  if (descriptor_ < 0 && errno == EEXIST) fail(path_, "already exists (--force replaces it)");
  if (descriptor_ < 0) fail(path_, fmt::format("cannot be written: {}", std::strerror(errno)));
}

BinaryOutput::~BinaryOutput() {
  close(descriptor_);
}

void BinaryOutput::append(std::string_view bytes) {
  ssize_t written = 0;
  do {
    written = write(descriptor_, bytes.data(), bytes.size());
  } while (written < 0 && errno == EINTR);
  if (written == static_cast<ssize_t>(bytes.size())) {
    size_ += bytes.size();
    return;
  }
  const int error = written < 0 ? errno : ENOSPC;
  // Truncate to the old size: readers ignore a torn end, but it is of no use to them.
  if (written > 0 && (ftruncate(descriptor_, static_cast<off_t>(size_)) != 0 ||
                      lseek(descriptor_, static_cast<off_t>(size_), SEEK_SET) < 0))
    fail(path_, fmt::format("cannot be written: {}; its end is torn", std::strerror(error)));
  fail(path_, fmt::format("cannot be written: {}; it ends after {} bytes", std::strerror(error), size_));
}

}  // namespace coppice
