#include "bus/dds_server_list.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

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

}  // namespace

ServerList look_up_servers(const std::string& servers) {
  ServerList list;
  std::string before;  // empty places
  for (std::size_t begin = 0; begin <= servers.size(); before += ';') {
    const std::size_t end = std::min(servers.find(';', begin), servers.size());
    const std::string server = servers.substr(begin, end - begin);
    begin = end + 1;
    if (server.empty()) continue;
    eprosima::fastdds::rtps::RemoteServerList_t found;
    if (eprosima::fastdds::rtps::load_environment_server_info(before + server, found)) {
      list.found.splice(list.found.end(), found);
    } else {
      (names_a_host(server) ? list.unknown : list.malformed).push_back(server);
    }
  }
  return list;
}

}  // namespace coppice
