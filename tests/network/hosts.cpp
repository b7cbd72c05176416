#include "tests/network/hosts.h"

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>

namespace coppice::test {

namespace {

int checked(int result, const std::string& what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
  return result;
}

FileNumber opened(const std::string& path) {
  return FileNumber(checked(open(path.c_str(), O_RDONLY | O_CLOEXEC), path));
}

void must_succeed(const std::string& command) {
  const Outcome outcome = shell(command);
  if (outcome.exit_code != 0) throw std::runtime_error(command + ": " + outcome.output);
}

int count(const std::string& text, const std::string& word) {
  int n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

}  // namespace

std::string Hosts::why_not() {
  if (access("/dev/net/tun", R_OK | W_OK) != 0) return "/dev/net/tun cannot be opened";
  for (const char* command :
       {"unshare --net --mount true", "ip -Version", "setpriv --version", "nsenter --version"}) {
    const Outcome outcome = shell(command);
    if (outcome.exit_code != 0) return std::string(command) + ": " + outcome.output;
  }
  return {};
}

Hosts::Hosts(std::size_t count, std::uint64_t seed) {
  std::vector<std::string> command{
      "/usr/bin/setpriv", "--pdeathsig",       "KILL", std::string(COPPICE_TEST_BIN_DIR) + "/lossy_switch",
      "--seed",           std::to_string(seed)};
  for (std::size_t host = 0; host < count; ++host) {
    spaces_.push_back(make_space());
    command.push_back(path_of(spaces_.back().network));
  }
  int ends[2];
  checked(pipe2(ends, O_CLOEXEC), "pipe");
  const FileNumber input(ends[0]);
  rules_ = FileNumber(ends[1]);
  switch_ = std::make_unique<Background>(command, folder_.path() / "switch.log", input.get());
  wait_for_switch("ready", 1);
  for (std::size_t host = 0; host < count; ++host) configure(host);
}

Hosts::Space Hosts::make_space() {
  return std::async(std::launch::async,
                    [] {
                      checked(unshare(CLONE_NEWNET | CLONE_NEWNS), "new namespaces");
                      checked(mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr), "private mounts");
                      checked(mount("tmpfs", "/dev/shm", "tmpfs", 0, nullptr), "/dev/shm");
                      return Space{opened("/proc/thread-self/ns/net"), opened("/proc/thread-self/ns/mnt")};
                    })
      .get();
}

std::string Hosts::path_of(const FileNumber& file) {
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(file.get());
}

void Hosts::enter(std::size_t host) const {
  checked(setns(spaces_[host].network.get(), CLONE_NEWNET), "a host's network");
}

void Hosts::configure(std::size_t host) const {
  on(host, [&] {
    must_succeed("ip link set lo up");
    must_succeed("ip address add " + address(host) + "/24 dev eth0");
    must_succeed("ip link set eth0 up");
  });
}

std::unique_ptr<Background> Hosts::start(std::size_t host, std::vector<std::string> command,
                                         const std::filesystem::path& log) const {
  const Space& space = spaces_.at(host);
  command.insert(command.begin(),
                 {"/usr/bin/setpriv", "--pdeathsig", "KILL", "/usr/bin/nsenter",
                  "--net=" + path_of(space.network), "--mount=" + path_of(space.mounts), "--"});
  return std::make_unique<Background>(command, log);
}

void Hosts::tell(const std::string& rule) {
  const std::string line = rule + "\n";
  if (write(rules_.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    throw std::runtime_error("the switch takes no rules");
  wait_for_switch("done", ++told_);
}

void Hosts::wait_for_switch(const std::string& word, int times) {
  const auto log = [&] { return contents(folder_.path() / "switch.log"); };
  const bool done = within(std::chrono::seconds(10),
                           [&] { return count(log(), word) >= times || has_ended(switch_->pid()); });
  if (!done || count(log(), word) < times) throw std::runtime_error("the switch: " + log());
}

std::string Hosts::end() {
  rules_ = FileNumber(-1);
  switch_->wait();
  return contents(folder_.path() / "switch.log");
}

}  // namespace coppice::test
