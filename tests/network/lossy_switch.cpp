// lossy_switch NETNS...: an Ethernet switch between hosts in network namespaces, with links that lose, delay
// and duplicate frames (link.h).
//
// A file names each namespace: /run/netns/NAME, or /proc/PID/ns/net. The switch makes the TAP device eth0 in
// each. The devices vanish with the switch. It prints "ready" and then reads rules from standard input until
// that ends, one in each line: FROM TO RULE with the places of namespaces in the list, from 0 on, or * for
// all: "* * loss 20% delay 100ms 50ms", "0 2 down". A rule replaces the earlier rule of the link. In the end
// it prints the counts of frames for each link.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <queue>
#include <random>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <sched.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "tests/network/link.h"

namespace {

using namespace coppice::test;

constexpr const char* interface = "eth0";
constexpr std::size_t longest_frame = 65536 + 18;  // bytes, for any MTU of the interface
constexpr int most_read = 64;  // frames of one port at a time, so that all ports have their turn

int checked(int result, const std::string& what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
  return result;
}

class File {
 public:
  File(const std::string& path, int flags) : number_(checked(open(path.c_str(), flags | O_CLOEXEC), path)) {}
  File(File&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  File& operator=(File&&) = delete;
  ~File() {
    if (number_ >= 0) close(number_);
  }
  int number() const { return number_; }

 private:
  int number_;
};

/// A device belongs to the namespace of the thread that opened it.
File tap_in(const std::string& space) {
  const File home("/proc/thread-self/ns/net", O_RDONLY);
  const File there(space, O_RDONLY);
  checked(setns(there.number(), CLONE_NEWNET), space);
  File tap("/dev/net/tun", O_RDWR | O_NONBLOCK);
  ifreq request{};
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  std::strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
  checked(ioctl(tap.number(), TUNSETIFF, &request), "a TAP device in " + space);
  checked(setns(home.number(), CLONE_NEWNET), "back");
  return tap;
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

using Frame = std::vector<unsigned char>;
using Mac = std::array<unsigned char, 6>;

class Switch {
 public:
  Switch(const std::vector<std::string>& spaces, std::uint64_t seed)
      : links_(spaces.size() * spaces.size()), random_(seed) {
    for (const std::string& space : spaces) {
      ports_.push_back(tap_in(space));
      watch(ports_.back().number(), ports_.size() - 1);
    }
    watch(STDIN_FILENO, spaces.size());
  }

  void run() {
    while (true) {
      std::array<epoll_event, 16> events{};
      const std::optional<timespec> timeout = until_next();
      const int count = epoll_pwait2(epoll_, events.data(), static_cast<int>(events.size()),
                                     timeout ? &*timeout : nullptr, nullptr);
      if (count < 0 && errno != EINTR) checked(count, "epoll");
      for (const epoll_event& event : std::span(events).first(static_cast<std::size_t>(std::max(0, count)))) {
        if (event.data.u64 < ports_.size()) {
          read_port(event.data.u64);
        } else if (!read_rules()) {
          return;
        }
      }
      deliver();
    }
  }

  void say(std::ostream& out) const {
    for (std::size_t from = 0; from < ports_.size(); ++from) {
      for (std::size_t to = 0; to < ports_.size(); ++to) {
        const Link::Counts& n = links_[from * ports_.size() + to].counts();
        if (n.came == 0) continue;
        out << fmt::format(
            "{} -> {}: {} frames, {} lost, {} doubled, {} over the limit, {} multicast kept off\n", from, to,
            n.came, n.lost, n.doubled, n.over_limit, n.multicast);
      }
    }
  }

 private:
  struct UnderWay {
    double due = 0;
    std::uint64_t order = 0;  ///< order among frames that are due at the same time
    std::size_t from = 0;
    std::size_t to = 0;
    std::shared_ptr<const Frame> frame;
    bool operator>(const UnderWay& other) const {
      return std::tie(due, order) > std::tie(other.due, other.order);
    }
  };

  Link& link(std::size_t from, std::size_t to) { return links_[from * ports_.size() + to]; }

  void watch(int file, std::uint64_t number) {
    epoll_event event{.events = EPOLLIN, .data = {.u64 = number}};
    checked(epoll_ctl(epoll_, EPOLL_CTL_ADD, file, &event), "epoll");
  }

  std::optional<timespec> until_next() const {
    if (queue_.empty()) return std::nullopt;
    const double wait = std::max(0.0, queue_.top().due - now());
    const auto whole = static_cast<time_t>(wait);
    return timespec{whole, static_cast<long>((wait - static_cast<double>(whole)) * 1e9)};
  }

  void read_port(std::size_t from) {
    for (int k = 0; k < most_read; ++k) {
      std::array<unsigned char, longest_frame> buffer;  // NOLINT(cppcoreguidelines-pro-type-member-init)
      const ssize_t size = read(ports_[from].number(), buffer.data(), buffer.size());
      if (size < 14) return;  // no more frames
      forward(from, std::make_shared<const Frame>(buffer.begin(), buffer.begin() + size));
    }
  }

  /// To the port where its destination was last seen, or to all others.
  void forward(std::size_t from, const std::shared_ptr<const Frame>& frame) {
    const auto address = [&](std::size_t at) {
      Mac mac{};
      std::copy_n(frame->begin() + static_cast<std::ptrdiff_t>(at), mac.size(), mac.begin());
      return mac;
    };
    port_of_[address(6)] = from;
    const auto known = port_of_.find(address(0));
    const bool multicast = is_multicast(frame->data(), frame->size());
    const double time = now();
    for (std::size_t to = 0; to < ports_.size(); ++to) {
      if (to == from || (known != port_of_.end() && known->second != to)) continue;
      for (const double due : link(from, to).pass(frame->size(), multicast, time, random_)) {
        queue_.push({due, order_++, from, to, frame});
      }
    }
  }

  void deliver() {
    const double time = now();
    while (!queue_.empty() && queue_.top().due <= time) {
      const UnderWay& next = queue_.top();
      link(next.from, next.to).came_out();
      // A frame that the host does not take is lost, as on a wire (the interface may be down).
      (void)!write(ports_[next.to].number(), next.frame->data(), next.frame->size());
      queue_.pop();
    }
  }

  /// Returns false when standard input has ended.
  bool read_rules() {
    std::array<char, 4096> buffer{};
    const ssize_t size = read(STDIN_FILENO, buffer.data(), buffer.size());
    if (size <= 0) return false;
    typed_.append(buffer.data(), static_cast<std::size_t>(size));
    for (std::size_t end = typed_.find('\n'); end != std::string::npos; end = typed_.find('\n')) {
      take_rule(typed_.substr(0, end));
      typed_.erase(0, end + 1);
    }
    return true;
  }

  void take_rule(const std::string& line) {
    std::istringstream in(line);
    std::string from;
    std::string to;
    std::string rest;
    in >> from >> to;
    std::getline(in, rest);
    const LinkRule rule = parse_link_rule(rest);
    for (const std::size_t a : places(from)) {
      for (const std::size_t b : places(to)) link(a, b).rule = rule;
    }
    std::cout << "done" << std::endl;
  }

  std::vector<std::size_t> places(const std::string& word) const {
    std::vector<std::size_t> all(ports_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    if (word == "*") return all;
    const bool is_number =
        !word.empty() && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
    if (!is_number || word.size() > 6 || std::stoul(word) >= ports_.size())
      throw std::invalid_argument("\"" + word + "\" is no place in the list of namespaces");
    return {std::stoul(word)};
  }

  int epoll_ = checked(epoll_create1(EPOLL_CLOEXEC), "epoll");
  std::deque<File> ports_;
  std::vector<Link> links_;
  std::mt19937_64 random_;
  std::map<Mac, std::size_t> port_of_;
  std::priority_queue<UnderWay, std::vector<UnderWay>, std::greater<>> queue_;
  std::uint64_t order_ = 0;
  std::string typed_;
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> spaces;
  std::uint64_t seed = 1;
  CLI::App app{"An Ethernet switch between network namespaces, with links as bad as they are told to be"};
  app.add_option("netns", spaces, "files of network namespaces")->required();
  app.add_option("--seed", seed, "of every loss and delay");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  try {
    Switch ethernet(spaces, seed);
    std::cout << "ready" << std::endl;
    ethernet.run();
    ethernet.say(std::cout);
  } catch (const std::exception& problem) {
    std::cerr << "lossy_switch: " << problem.what() << '\n';
    return 2;
  }
  return 0;
}
