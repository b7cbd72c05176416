#include "coppice/run/unused_domain.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "dds/discovery.h"

namespace coppice {

namespace {

constexpr int domains = 100;

/// Returns a bound socket, or -1 if another socket has the address.
int bound_socket(int family, const sockaddr* address, socklen_t size) {
  const int socket = ::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return -1;
  if (bind(socket, address, size) == 0) return socket;
  close(socket);
  return -1;
}

/// Returns a descriptor that holds the reservation, or -1 if another run has reserved the domain.
int reserve(int domain) {
  const std::string name = fmt::format("coppice-domain-{}", domain);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::ranges::copy(name, address.sun_path + 1);  // a zero first: the abstract namespace
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return bound_socket(AF_UNIX, reinterpret_cast<const sockaddr*>(&address), size);
}

/// Whether no process of this machine has joined the DDS domain. Each participant listens at the domain's
/// multicast port (DDS-RTPS 2.2, 9.6.1.1: 7400 + 250 d), which participants share among themselves, but not
/// with other sockets.
bool nobody_joined(int domain) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  address.sin_port = htons(static_cast<std::uint16_t>(domain_port(domain)));
  const int socket = bound_socket(AF_INET, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  if (socket < 0) return false;
  close(socket);
  return true;
}

}  // namespace

UnusedDomain::UnusedDomain(const std::string& unique) {
  const int first = static_cast<int>(std::hash<std::string>{}(unique) % domains);
  for (int i = 0; i < domains; ++i) {
    number_ = 1 + (first + i) % domains;
    reservation_ = reserve(number_);
    if (reservation_ < 0) continue;
    if (nobody_joined(number_)) return;
    close(reservation_);
  }
  throw std::runtime_error("every DDS domain from 1 to 100 is in use on this machine; name one by --domain");
}

UnusedDomain::~UnusedDomain() {
  close(reservation_);
}

}  // namespace coppice
