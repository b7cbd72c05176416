#include "coppice/run/examination.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <system_error>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/timex.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "dds/dds_bus.h"
#include "dds/discovery.h"

namespace coppice {

namespace {

constexpr int patience = 200;  // milliseconds for a datagram from this machine to itself
constexpr std::chrono::milliseconds clock_watch{300};
constexpr const char* group = "239.255.0.1";  // the multicast group of DDS participants

class UdpSocket {
 public:
  UdpSocket() : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~UdpSocket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  /// 0: any free port
  bool bind_to(int port) const {
    sockaddr_in address = to(INADDR_ANY, port);
    return bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  int port() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
  }
  template <class T>
  bool set(int level, int option, const T& value) const {
    return setsockopt(descriptor_, level, option, &value, sizeof value) == 0;
  }
  bool send(in_addr_t host, int port, const std::string& text) const {
    const sockaddr_in address = to(ntohl(host), port);
    return sendto(descriptor_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&address),
                  sizeof address) == static_cast<ssize_t>(text.size());
  }
  bool receives(const std::string& text) const {
    pollfd ready{.fd = descriptor_, .events = POLLIN, .revents = 0};
    while (poll(&ready, 1, patience) == 1) {
      std::array<char, 64> buffer{};
      const ssize_t size = recv(descriptor_, buffer.data(), buffer.size(), 0);
      if (size >= 0 && std::string(buffer.data(), static_cast<std::size_t>(size)) == text) return true;
    }
    return false;
  }
  int descriptor() const { return descriptor_; }

 private:
  static sockaddr_in to(in_addr_t host, int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(host);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    return address;
  }
  int descriptor_;
};

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

SystemLimit number_in(const std::string& text) {
  std::istringstream in(text);
  std::uint64_t value = 0;
  return in >> value ? SystemLimit(value) : std::nullopt;
}

/// The lower of two limits. None is no limit.
SystemLimit lower(const SystemLimit& a, const SystemLimit& b) {
  return a && b ? std::min(a, b) : a ? a : b;
}

SystemLimit left_of(const SystemLimit& limit, const SystemLimit& used) {
  if (!limit) return std::nullopt;
  return *limit - std::min(*limit, used.value_or(0));
}

SystemLimit resource(__rlimit_resource which) {
  rlimit limit{};
  const bool limited = getrlimit(which, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return limited ? SystemLimit(limit.rlim_cur) : std::nullopt;
}

/// The number after `word`, in a text with one such pair per line.
SystemLimit number_after(const std::string& word, const std::string& text) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(word)) return number_in(line.substr(word.size()));
  }
  return std::nullopt;
}

/// Folders of the control groups (version 2) of this process, the outermost first. In a container only its
/// own group is visible.
std::vector<std::filesystem::path> control_groups() {
  std::istringstream in(text_of("/proc/self/cgroup"));
  std::vector<std::filesystem::path> groups{"/sys/fs/cgroup"};
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("0::/")) continue;
    for (const auto& name : std::filesystem::path(line.substr(4))) groups.push_back(groups.back() / name);
  }
  return groups;
}

SystemLimit memory_available() {
  SystemLimit available = number_after("MemAvailable:", text_of("/proc/meminfo"));
  if (available) *available *= 1024;
  for (const auto& folder : control_groups()) {
    // The cache of files is freed when memory is needed, so it does not count as used.
    SystemLimit used = number_in(text_of(folder / "memory.current"));
    used = left_of(used, number_after("inactive_file ", text_of(folder / "memory.stat")));
    available = lower(available, left_of(number_in(text_of(folder / "memory.max")), used));
  }
  return available;
}

SystemLimit open_files_left() {
  std::istringstream in(text_of("/proc/sys/fs/file-nr"));
  std::uint64_t used = 0;
  std::uint64_t unused = 0;
  std::uint64_t limit = 0;
  return in >> used >> unused >> limit ? left_of(limit, used) : std::nullopt;
}

std::uint64_t threads_of_this_user() {
  std::uint64_t threads = 0;
  std::error_code gone;
  for (const auto& process : std::filesystem::directory_iterator("/proc", gone)) {
    if (process.path().filename().string().find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string status = text_of(process.path() / "status");
    if (number_after("Uid:", status) == SystemLimit(getuid()))
      threads += number_after("Threads:", status).value_or(0);
  }
  return threads;
}

/// By the limits of the whole system and, unless the user is root, by the limit of this user.
SystemLimit threads_left() {
  std::uint64_t running = 0;
  std::istringstream load(text_of("/proc/loadavg"));
  std::string word;
  for (int k = 0; k < 4; ++k) load >> word;
  if (const auto slash = word.find('/'); slash != std::string::npos)
    running = number_in(word.substr(slash + 1)).value_or(0);
  SystemLimit left = left_of(number_in(text_of("/proc/sys/kernel/threads-max")), running);
  if (geteuid() != 0) left = lower(left, left_of(resource(RLIMIT_NPROC), threads_of_this_user()));
  for (const auto& folder : control_groups())
    left = lower(
        left, left_of(number_in(text_of(folder / "pids.max")), number_in(text_of(folder / "pids.current"))));
  return left;
}

std::uint64_t granted_receive_buffer() {
  const UdpSocket udp;
  udp.set(SOL_SOCKET, SO_RCVBUF, wanted_receive_buffer);
  int granted = 0;
  socklen_t size = sizeof granted;
  getsockopt(udp.descriptor(), SOL_SOCKET, SO_RCVBUF, &granted, &size);
  return static_cast<std::uint64_t>(granted) / 2;  // Linux adds as much for its bookkeeping
}

bool loopback_works() {
  const UdpSocket receiver;
  const UdpSocket sender;
  return receiver.bind_to(0) && sender.send(htonl(INADDR_LOOPBACK), receiver.port(), "coppice") &&
         receiver.receives("coppice");
}

bool multicast_works(in_addr interface) {
  const UdpSocket receiver;
  const UdpSocket sender;
  ip_mreq membership{};
  inet_pton(AF_INET, group, &membership.imr_multiaddr);
  membership.imr_interface = interface;
  const std::string text = fmt::format("coppice {}", interface.s_addr);
  return receiver.bind_to(0) && receiver.set(IPPROTO_IP, IP_ADD_MEMBERSHIP, membership) &&
         receiver.set(IPPROTO_IP, IP_MULTICAST_ALL, 0) &&
         sender.set(IPPROTO_IP, IP_MULTICAST_IF, interface) && sender.set(IPPROTO_IP, IP_MULTICAST_LOOP, 1) &&
         sender.send(membership.imr_multiaddr.s_addr, receiver.port(), text) && receiver.receives(text);
}

/// Interfaces that are up, support multicast and have an address. DDS uses these; without any, the loopback.
std::vector<NetworkInterface> interfaces() {
  std::vector<NetworkInterface> found;
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return found;
  for (const ifaddrs* i = all; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    if ((i->ifa_flags & IFF_UP) == 0 || (i->ifa_flags & IFF_MULTICAST) == 0) continue;
    found.push_back(
        {i->ifa_name, multicast_works(reinterpret_cast<const sockaddr_in*>(i->ifa_addr)->sin_addr)});
  }
  freeifaddrs(all);
  return found;
}

bool is_free(int port) {
  const UdpSocket udp;
  return udp.bind_to(port);
}

/// Stops at `enough`.
int free_port_pairs(int domain, int enough) {
  int pairs = 0;
  for (int k = 0; k < most_participants && pairs < enough; ++k) {
    const int port = participant_port(domain, k);
    if (port + 1 > std::numeric_limits<std::uint16_t>::max()) break;
    pairs += is_free(port) && is_free(port + 1);
  }
  return pairs;
}

/// Seconds by which the settable clock moved more than the steady one.
double clock_jump() {
  using std::chrono::steady_clock;
  using std::chrono::system_clock;
  const auto set = system_clock::now();
  const auto steady = steady_clock::now();
  std::this_thread::sleep_for(clock_watch);
  const std::chrono::duration<double> moved = system_clock::now() - set;
  const std::chrono::duration<double> passed = steady_clock::now() - steady;
  return moved.count() - passed.count();
}

bool clock_synchronised() {
  timex state{};
  return adjtimex(&state) != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

std::string versions() {
  utsname system{};
  uname(&system);
  return fmt::format("coppice {}, Fast DDS {}, {} {}", COPPICE_VERSION, dds_version(), system.sysname,
                     system.release);
}

}  // namespace

double usable_cores() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  const int count = sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
  double cores = count;
  for (const auto& folder : control_groups()) {
    double quota = 0;
    double period = 0;
    std::istringstream in(text_of(folder / "cpu.max"));
    if (in >> quota >> period && period > 0) cores = std::min(cores, quota / period);
  }
  return cores;
}

Machine examine(const FleetPlan& plan) {
  return {.versions = versions(),
          .cores = usable_cores(),
          .memory_available = memory_available(),
          .receive_buffer = granted_receive_buffer(),
          .open_files = resource(RLIMIT_NOFILE),
          .open_files_left = open_files_left(),
          .threads_left = threads_left(),
          .loopback_works = loopback_works(),
          .servers = are_servers(plan.discovery) ? examine_servers(plan.discovery) : ServerExamination(),
          .interfaces = interfaces(),
          .free_ports = free_port_pairs(plan.domain, plan.robots + 100),
          .domain_in_use = !is_free(domain_port(plan.domain)),
          .first_ephemeral_port =
              static_cast<int>(number_in(text_of("/proc/sys/net/ipv4/ip_local_port_range")).value_or(32768)),
          .clock_synchronised = clock_synchronised(),
          .clock_jump = clock_jump()};
}

}  // namespace coppice
