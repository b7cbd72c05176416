// A small disk that tests fill. Only root can mount one: tests that use it are skipped without.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <sys/mount.h>

namespace coppice::test {

inline constexpr const char* why_no_disk = "only root can mount a small disk";

class SmallDisk {
 public:
  /// `size`: as of tmpfs, such as "1M".
  SmallDisk(std::filesystem::path folder, const std::string& size) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
    is_there_ = mount("tmpfs", folder_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  }
  ~SmallDisk() {
    if (is_there_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool is_there() const { return is_there_; }
  /// Leaves no room on it.
  void fill() const {
    std::ofstream ballast(folder_ / "ballast", std::ios::binary | std::ios::app);
    const std::string block(4096, 'x');
    while (ballast.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) {
    }
  }
  void make_room() const { std::filesystem::remove(folder_ / "ballast"); }

 private:
  std::filesystem::path folder_;
  bool is_there_ = false;
};

}  // namespace coppice::test
