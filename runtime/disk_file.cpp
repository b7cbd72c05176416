#include "runtime/disk_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace coppice {

namespace {

[[noreturn]] void fail_by_errno(const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", what, std::strerror(errno)));
}

}  // namespace

DiskFile::DiskFile(const std::filesystem::path& path) {
  const bool is_new = !std::filesystem::exists(path);
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) fail_by_errno(fmt::format("{}: cannot be opened for writing", path.string()));
  if (is_new) sync_folder_of(path);
}

DiskFile::~DiskFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

DiskFile::DiskFile(DiskFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

DiskFile& DiskFile::operator=(DiskFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

bool DiskFile::lock() {
  return ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
}

std::size_t DiskFile::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail_by_errno("the size of a file cannot be read");
  return static_cast<std::size_t>(status.st_size);
}

std::vector<std::uint8_t> DiskFile::read(std::size_t place, std::size_t size) const {
  std::vector<std::uint8_t> bytes(size);
  std::size_t done = 0;
  while (done < size) {
    const ::ssize_t got =
        ::pread(descriptor_, bytes.data() + done, size - done, static_cast<::off_t>(place + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_by_errno("a file cannot be read");
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

bool DiskFile::write(std::size_t place, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ::ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<::off_t>(place));
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return false;
    place += static_cast<std::size_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

bool DiskFile::cut(std::size_t size) {
  return ::ftruncate(descriptor_, static_cast<::off_t>(size)) == 0;
}

bool DiskFile::sync() {
  return ::fdatasync(descriptor_) == 0;
}

bool DiskFile::reserve(std::size_t size) {
  int result = 0;
  do {
    result = ::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, 0, static_cast<::off_t>(size));
  } while (result != 0 && errno == EINTR);
  return result == 0 || errno == EOPNOTSUPP || errno == ENOSYS;
}

bool exchange(const std::filesystem::path& one, const std::filesystem::path& other) {
  if (::renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE) == 0) return true;
  // A file system without that step replaces one file by the other, and the replaced one loses its name.
  return errno == EINVAL && ::rename(one.c_str(), other.c_str()) == 0;
}

bool sync_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool synced = ::fsync(descriptor) == 0;
  ::close(descriptor);
  return synced;
}

std::optional<std::size_t> free_room(const std::filesystem::path& folder) {
  struct statvfs status {};
  if (::statvfs(folder.c_str(), &status) != 0) return std::nullopt;
  return static_cast<std::size_t>(status.f_bavail) * status.f_frsize;
}

}  // namespace coppice
