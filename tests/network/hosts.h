// Simulated hosts on one machine: network namespaces, each with its own address and /dev/shm, joined by an
// Ethernet switch with links as bad as the test sets them (lossy_switch.cpp).
//
// The namespaces have no names. This process and the processes on the hosts hold them, and all of these end
// with it, so that the kernel removes everything however the test ends. To inspect a namespace while a test
// is stopped in a debugger: nsenter --net=/proc/PID/fd/N.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/processes.h"
#include "tests/support.h"

namespace coppice::test {

/// A file number that is closed at its end.
class FileNumber {
 public:
  explicit FileNumber(int number) : number_(number) {}
  FileNumber(FileNumber&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileNumber& operator=(FileNumber&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileNumber() {
    if (number_ >= 0) close(number_);
  }
  int get() const { return number_; }

 private:
  int number_;
};

class Hosts {
 public:
  /// Why this machine can have no such hosts; empty if it can.
  static std::string why_not();

  /// Makes hosts with clean links. `seed` determines all random effects of the links. Throws
  /// std::runtime_error if something is missing.
  explicit Hosts(std::size_t count, std::uint64_t seed = 1);

  std::size_t size() const { return spaces_.size(); }
  static std::string address(std::size_t host) { return "10.77.0." + std::to_string(host + 1); }

  /// Sets the rule of every link in each direction from now on; see link.h. Throws std::runtime_error for an
  /// unknown rule.
  void links(const std::string& rule) { tell("* * " + rule); }
  /// The same for one direction between two hosts.
  void link(std::size_t from, std::size_t to, const std::string& rule) {
    tell(std::to_string(from) + " " + std::to_string(to) + " " + rule);
  }

  /// Starts a process on a host. It ends with the returned object, and with this process.
  std::unique_ptr<Background> start(std::size_t host, std::vector<std::string> command,
                                    const std::filesystem::path& log) const;

  /// Calls f() in a thread on the host. Sockets that it opens stay on the host.
  template <class F>
  auto on(std::size_t host, F f) const {
    return std::async(std::launch::async,
                      [&] {
                        enter(host);
                        return f();
                      })
        .get();
  }

  /// Ends the switch. Returns a line with the counts of frames for each link.
  std::string end();

 private:
  struct Space {
    FileNumber network;
    FileNumber mounts;
  };
  static Space make_space();
  static std::string path_of(const FileNumber& file);
  void enter(std::size_t host) const;
  void configure(std::size_t host) const;
  void tell(const std::string& rule);
  /// Waits until the switch has confirmed `times` commands.
  void wait_for_switch(const std::string& word, int times);

  TemporaryFolder folder_;
  std::vector<Space> spaces_;
  FileNumber rules_{-1};  ///< to the switch
  int told_ = 0;
  std::unique_ptr<Background> switch_;
};

}  // namespace coppice::test
