#include "dds/server_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>

namespace coppice {

namespace {

bool names_a_host(std::string_view server) {
  const std::size_t colon = server.find(':');
  const std::string_view host = server.substr(0, colon);
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '.' || c == '_';
  };
  const auto is_letter = [&](char c) { return plain(c) && c != '.' && (c < '0' || c > '9'); };
  if (!std::ranges::all_of(host, plain) || std::ranges::none_of(host, is_letter)) return false;
  if (colon == std::string_view::npos) return true;
  const std::string_view port = server.substr(colon + 1);
  std::uint16_t number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  return error == std::errc() && end == port.data() + port.size() && number > 0;
}

/// Returns the server with its host's current address, or nothing if the host has none. IPv4 only, as the
/// transport. Fast DDS itself would also use IPv6 addresses, and take a name like "beef" for one.
std::optional<std::string> at_its_address(const std::string& server) {
  const std::size_t colon = std::min(server.find(':'), server.size());
  const addrinfo hints{.ai_family = AF_INET, .ai_socktype = SOCK_DGRAM};
  addrinfo* found = nullptr;
  if (getaddrinfo(server.substr(0, colon).c_str(), nullptr, &hints, &found) != 0) return std::nullopt;
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(found, freeaddrinfo);
  sockaddr_in address{};
  std::memcpy(&address, all->ai_addr, sizeof(address));
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return text.data() + server.substr(colon);
}

bool is_of_ipv6(std::string_view server) {
  return std::ranges::count(server, ':') > 1;
}

}  // namespace

ServerList look_up_servers(const std::string& servers) {
  ServerList list;
  // One ";" for each place before this server, because the place gives the server's identity.
  std::string before;
  for (std::size_t begin = 0; begin <= servers.size(); before += ';') {
    const std::size_t end = std::min(servers.find(';', begin), servers.size());
    const std::string server = servers.substr(begin, end - begin);
    begin = end + 1;
    if (server.empty()) continue;
    const auto known = names_a_host(server) ? at_its_address(server) : server;
    eprosima::fastdds::rtps::RemoteServerList_t found;
    if (!known) {
      list.unknown.push_back(server);
    } else if (!is_of_ipv6(*known) &&
               eprosima::fastdds::rtps::load_environment_server_info(before + *known, found)) {
      list.found.splice(list.found.end(), found);
    } else {
      list.malformed.push_back(server);
    }
  }
  return list;
}

}  // namespace coppice
