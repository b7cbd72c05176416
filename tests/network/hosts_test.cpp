// Tests of the simulated hosts and links: they behave as requested, and nothing is left.
//
// CTest: RESOURCE_LOCK hosts

#include "tests/network/hosts.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>

namespace coppice::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::uint16_t port = 4000;
const char* const group = "239.255.0.77";

sockaddr_in address_of(const std::string& ip) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  inet_pton(AF_INET, ip.c_str(), &address.sin_addr);
  return address;
}

/// A UDP socket on a host that hears datagrams to its address and to the group.
FileNumber socket_on(const Hosts& hosts, std::size_t host) {
  return hosts.on(host, [&] {
    FileNumber made(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const sockaddr_in any = address_of("0.0.0.0");
    const sockaddr_in own = address_of(Hosts::address(host));
    const ip_mreqn membership{{inet_addr(group)}, own.sin_addr, 0};
    const timeval patience{0, 500'000};
    constexpr int buffer = 4 << 20;
    constexpr int to_itself = 0;
    if (bind(made.get(), reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0 ||
        setsockopt(made.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0 ||
        setsockopt(made.get(), IPPROTO_IP, IP_MULTICAST_IF, &own.sin_addr, sizeof own.sin_addr) != 0 ||
        setsockopt(made.get(), IPPROTO_IP, IP_MULTICAST_LOOP, &to_itself, sizeof to_itself) != 0 ||
        setsockopt(made.get(), SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer) != 0 ||
        setsockopt(made.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0)
      throw std::runtime_error("no socket");
    return made;
  });
}

struct Heard {
  std::vector<double> delays;  ///< seconds
  std::set<int> numbers;
};

/// Sends `count` datagrams of `size` bytes, one each `pause`, each with its number and the time.
Heard send_and_hear(const FileNumber& from, const FileNumber& to, const std::string& ip, int count,
                    std::chrono::microseconds pause, std::size_t size = 200) {
  std::jthread sender([&] {
    std::vector<char> bytes(size);
    const sockaddr_in address = address_of(ip);
    auto next = Clock::now();
    for (int k = 0; k < count; ++k) {
      std::this_thread::sleep_until(next += pause);
      const auto now = Clock::now();
      std::memcpy(bytes.data(), &k, sizeof k);
      std::memcpy(bytes.data() + 8, &now, sizeof now);
      sendto(from.get(), bytes.data(), size, 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    }
  });
  Heard heard;
  std::vector<char> bytes(size);
  while (recv(to.get(), bytes.data(), size, 0) > 0) {
    const auto now = Clock::now();
    int k = 0;
    Clock::time_point sent;
    std::memcpy(&k, bytes.data(), sizeof k);
    std::memcpy(&sent, bytes.data() + 8, sizeof sent);
    heard.numbers.insert(k);
    heard.delays.push_back(std::chrono::duration<double>(now - sent).count());
  }
  return heard;
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values.at(static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

class HostsTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string reason = Hosts::why_not(); !reason.empty()) GTEST_SKIP() << reason;
  }
};

TEST_F(HostsTest, CleanLinksDeliverEverythingToItsDestination) {
  const Hosts hosts(3);
  const FileNumber a = socket_on(hosts, 0);
  const FileNumber b = socket_on(hosts, 1);
  const FileNumber c = socket_on(hosts, 2);
  EXPECT_EQ(send_and_hear(a, b, Hosts::address(1), 200, 1ms).numbers.size(), 200u);
  EXPECT_EQ(send_and_hear(a, c, Hosts::address(2), 5, 1ms).numbers.size(), 5u);
  EXPECT_EQ(send_and_hear(a, c, group, 50, 1ms).numbers.size(), 50u);
  EXPECT_EQ(send_and_hear(b, a, Hosts::address(0), 3, 1ms, 20'000).numbers.size(), 3u) << "in fragments";
}

TEST_F(HostsTest, LossAndDelayAreAsRequestedInEachDirection) {
  Hosts hosts(2, 5);
  const FileNumber a = socket_on(hosts, 0);
  const FileNumber b = socket_on(hosts, 1);
  send_and_hear(a, b, Hosts::address(1), 1,
                1ms);  // so that addresses are known: an unanswered request takes a second
  hosts.link(0, 1, "loss 20% delay 100ms 50ms");
  hosts.link(1, 0, "duplicate 50%");
  constexpr int count = 2000;
  const Heard heard = send_and_hear(a, b, Hosts::address(1), count, 1ms);
  EXPECT_NEAR(static_cast<double>(heard.numbers.size()), 0.8 * count, 72);  // 4 standard deviations
  EXPECT_GE(quantile(heard.delays, 0), 0.05);
  EXPECT_NEAR(quantile(heard.delays, 0.5), 0.1, 0.01);
  EXPECT_NEAR(quantile(heard.delays, 0.9), 0.14, 0.015);
  const Heard back = send_and_hear(b, a, Hosts::address(0), count, 1ms);
  EXPECT_EQ(back.numbers.size(), static_cast<std::size_t>(count));
  EXPECT_NEAR(static_cast<double>(back.delays.size()), 1.5 * count, 90);
  EXPECT_LE(quantile(back.delays, 0.5), 0.02);
}

TEST_F(HostsTest, TheRateIsKept) {
  Hosts hosts(2);
  hosts.links("rate 1mbit limit 50");
  const FileNumber a = socket_on(hosts, 0);
  const FileNumber b = socket_on(hosts, 1);
  const auto begin = Clock::now();
  // 1042 bytes with their headers every 2 ms: four times as much as passes.
  const Heard heard = send_and_hear(a, b, Hosts::address(1), 500, 2ms, 1000);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count() - 0.5;  // its wait
  EXPECT_NEAR(static_cast<double>(heard.numbers.size()) * 1042 * 8, 1e6 * seconds, 0.15e6 * seconds);
}

TEST_F(HostsTest, HostsFindEachOthersAddressesWithoutMulticast) {
  Hosts hosts(2);
  hosts.links("multicast off");
  const FileNumber a = socket_on(hosts, 0);
  const FileNumber b = socket_on(hosts, 1);
  EXPECT_TRUE(send_and_hear(a, b, group, 20, 1ms).numbers.empty());
  EXPECT_EQ(send_and_hear(a, b, Hosts::address(1), 20, 1ms).numbers.size(), 20u);
}

TEST_F(HostsTest, ALinkGoesDownAndHeals) {
  Hosts hosts(3);
  const FileNumber a = socket_on(hosts, 0);
  const FileNumber b = socket_on(hosts, 1);
  const FileNumber c = socket_on(hosts, 2);
  EXPECT_EQ(send_and_hear(a, b, Hosts::address(1), 20, 1ms).numbers.size(), 20u);
  hosts.link(0, 1, "down");
  EXPECT_TRUE(send_and_hear(a, b, Hosts::address(1), 20, 1ms).numbers.empty());
  EXPECT_EQ(send_and_hear(a, c, Hosts::address(2), 20, 1ms).numbers.size(), 20u);
  hosts.links("");
  EXPECT_EQ(send_and_hear(a, b, Hosts::address(1), 20, 1ms).numbers.size(), 20u);
  EXPECT_THROW(hosts.links("loss much"), std::runtime_error);
}

TEST_F(HostsTest, EachHostHasItsOwnSharedMemory) {
  const Hosts hosts(2);
  const TemporaryFolder folder;
  const auto run = [&](std::size_t host, const std::string& script) {
    return hosts.start(host, {"/bin/sh", "-c", script}, folder.path() / "log")->wait();
  };
  EXPECT_EQ(run(0, "touch /dev/shm/coppice_test && test -e /dev/shm/coppice_test"), 0);
  EXPECT_NE(run(1, "test -e /dev/shm/coppice_test"), 0);
  EXPECT_FALSE(std::filesystem::exists("/dev/shm/coppice_test"));
}

/// The network namespaces of all processes.
std::set<ino_t> network_namespaces() {
  std::set<ino_t> all;
  for (const ProcessInfo& process : processes()) {
    struct stat info {};
    if (stat(("/proc/" + std::to_string(process.pid) + "/ns/net").c_str(), &info) == 0)
      all.insert(info.st_ino);
  }
  return all;
}

TEST_F(HostsTest, NothingOutlivesAKilledTest) {
  const TemporaryFolder folder;
  const auto before = network_namespaces();
  const auto log = folder.path() / "log";
  const pid_t killed = fork();
  if (killed == 0) {
    setenv("TMPDIR", folder.path().c_str(), 1);  // it leaves its own folder
    const Hosts hosts(2);
    const auto sleeper = hosts.start(1, {"/bin/sh", "-c", "echo there; exec sleep 100"}, log);
    while (true) pause();
  }
  EXPECT_TRUE(within(10s, [&] { return contents(log) == "there\n"; }));
  const auto children = children_of(killed);
  EXPECT_EQ(children.size(), 2u) << "the switch and the process";
  const auto during = network_namespaces();
  EXPECT_EQ(std::ranges::count_if(during, [&](ino_t n) { return !before.contains(n); }), 1);
  kill(killed, SIGKILL);
  waitpid(killed, nullptr, 0);
  for (const ProcessInfo& child : children) {
    EXPECT_TRUE(within(3s, [&] { return has_ended(child.pid); })) << child.name;
  }
  for (const ino_t space : network_namespaces())
    EXPECT_TRUE(before.contains(space) || !during.contains(space));
}

}  // namespace
}  // namespace coppice::test
