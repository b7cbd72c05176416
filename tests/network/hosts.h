// Hosts for tests, on one machine: network namespaces, each with an address and a /dev/shm of its own, joined
// by an Ethernet switch whose links are as bad as the test says (lossy_switch.cpp).
//
// The namespaces have no names: this process and the processes on the hosts hold them, and all of these end
// with it. So the kernel removes everything, however the test ends. To look at one while a test stands in a
// debugger: nsenter --net=/proc/PID/fd/N.
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

/// Closed at its end.
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
  /// Why there can be none here; empty: there can.
  static std::string why_not();

  /// With clean links. `seed`: of all that the links do. Throws std::runtime_error if something is missing.
  explicit Hosts(std::size_t count, std::uint64_t seed = 1);

  std::size_t size() const { return spaces_.size(); }
  static std::string address(std::size_t host) { return "10.77.0." + std::to_string(host + 1); }

  /// What every link does from now on, in each direction; see link.h. Throws std::runtime_error for an
  /// unknown rule.
  void links(const std::string& rule) { tell("* * " + rule); }
  /// The same of one direction between two hosts.
  void link(std::size_t from, std::size_t to, const std::string& rule) {
    tell(std::to_string(from) + " " + std::to_string(to) + " " + rule);
  }

  /// A process on a host. It ends with what is returned, and with this process.
  std::unique_ptr<Background> start(std::size_t host, std::vector<std::string> command,
                                    const std::filesystem::path& log) const;

  /// Calls f() in a thread on the host: sockets that it opens stay there.
  template <class F>
  auto on(std::size_t host, F f) const {
    return std::async(std::launch::async,
                      [&] {
                        enter(host);
                        return f();
                      })
        .get();
  }

  /// Ends the switch; what became of the frames of each link, a line each.
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
  /// Until the switch has said `times` times that it has done what it was told.
  void wait_for_switch(const std::string& word, int times);

  TemporaryFolder folder_;
  std::vector<Space> spaces_;
  FileNumber rules_{-1};  ///< to the switch
  int told_ = 0;
  std::unique_ptr<Background> switch_;
};

}  // namespace coppice::test
