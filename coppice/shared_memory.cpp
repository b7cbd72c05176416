#include "coppice/shared_memory.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace coppice {

namespace {

namespace fs = std::filesystem;

const fs::path folder = "/dev/shm";
constexpr std::string_view prefix = "fastrtps_";
constexpr std::array<std::string_view, 2> lock_suffixes{"_el", "_sl"};  // exclusive, shared

/// "fastrtps_port7410" for each of "fastrtps_port7410", "fastrtps_port7410_el" and
/// "sem.fastrtps_port7410_mutex"; empty for what is not Fast DDS's.
std::string segment_of(std::string_view file) {
  const auto drop = [&](std::string_view suffix) {
    if (file.ends_with(suffix)) file.remove_suffix(suffix.size());
  };
  if (file.starts_with("sem.")) {
    file.remove_prefix(4);
    drop("_mutex");
  }
  for (const std::string_view suffix : lock_suffixes) drop(suffix);
  return file.starts_with(prefix) ? std::string(file) : std::string();
}

std::set<std::string> segments_present() {
  std::set<std::string> present;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (std::string segment = segment_of(entry.path().filename().string()); !segment.empty()) {
      present.insert(std::move(segment));
    }
  }
  return present;
}

/// The segments that some process maps, as far as this user may look.
std::set<std::string> segments_mapped() {
  std::set<std::string> mapped;
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    std::ifstream maps(process.path() / "maps");
    for (std::string line; std::getline(maps, line);) {
      const std::size_t name = line.find("/dev/shm/");
      if (name != std::string::npos)
        mapped.insert(segment_of(line.substr(name + folder.string().size() + 1)));
    }
  }
  return mapped;
}

/// The lock of a segment: taken, or there is none (a port's senders make it without), or somebody else holds
/// it.
class SegmentLock {
 public:
  explicit SegmentLock(const std::string& segment) {
    for (std::size_t i = 0; i < files_.size(); ++i) {
      files_[i] = open((folder / (segment + std::string(lock_suffixes[i]))).c_str(), O_RDONLY | O_CLOEXEC);
      if (files_[i] >= 0 && flock(files_[i], LOCK_EX | LOCK_NB) != 0) held_elsewhere_ = true;
    }
  }
  ~SegmentLock() {
    for (const int file : files_) {
      if (file >= 0) close(file);
    }
  }
  SegmentLock(const SegmentLock&) = delete;
  SegmentLock& operator=(const SegmentLock&) = delete;
  bool held_elsewhere() const { return held_elsewhere_; }

 private:
  std::array<int, lock_suffixes.size()> files_{};
  bool held_elsewhere_ = false;
};

}  // namespace

std::size_t remove_stale_shared_memory() {
  const std::set<std::string> present =
      segments_present();  // before the maps: what comes later is not looked at
  const std::set<std::string> mapped = segments_mapped();
  std::size_t locked = 0;
  for (const std::string& segment : present) {
    if (mapped.contains(segment)) continue;
    const SegmentLock lock(segment);  // kept while we remove, so that nobody takes up what is about to go
    if (lock.held_elsewhere()) {
      ++locked;
      continue;
    }
    std::error_code ignored;  // another clean-up may have been faster
    fs::remove(folder / segment, ignored);
    fs::remove(folder / ("sem." + segment + "_mutex"), ignored);
    for (const std::string_view suffix : lock_suffixes)
      fs::remove(folder / (segment + std::string(suffix)), ignored);
  }
  return locked;
}

}  // namespace coppice
