#include "coppice/run/local_fleets.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "coppice/files/input_error.h"
#include "dds/discovery.h"
#include "files/text_file.h"

namespace coppice {

namespace {

namespace fs = std::filesystem;

constexpr int last_domain = 232;
constexpr int ports_of_domain = domain_port(1) - domain_port(0);
/// Later participants would use the next domain's multicast port.
constexpr int participants_of_domain = (domain_port(1) - participant_port(0, 0)) / 2;

/// UDP sockets by port.
using Sockets = std::map<int, std::vector<std::uint64_t>>;

/// A table with a heading: the second column is address:port in hexadecimal digits, the tenth the socket.
Sockets sockets_in(std::string_view table) {
  Sockets sockets;
  std::istringstream lines{std::string(table)};
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::vector<std::string> columns;
    for (std::string word; words >> word;) columns.push_back(word);
    const auto colon = columns.size() < 10 ? std::string::npos : columns[1].find(':');
    if (colon == std::string::npos) continue;
    const std::string& port_text = columns[1];
    int port = 0;
    std::uint64_t socket = 0;
    std::from_chars(port_text.data() + colon + 1, port_text.data() + port_text.size(), port, 16);
    std::from_chars(columns[9].data(), columns[9].data() + columns[9].size(), socket);
    sockets[port].push_back(socket);
  }
  return sockets;
}

std::string program_of(const LocalProcess& process) {
  return process.arguments.empty() ? "" : fs::path(process.arguments[0]).filename().string();
}

bool is_agent(const LocalProcess& process) {
  return program_of(process) == "robot_agent";
}

/// Whether the process publishes a fleet's messages.
bool is_of_fleet(const LocalProcess& process) {
  const std::string program = program_of(process);
  const bool replays =
      program == "coppice" && process.arguments.size() > 1 && process.arguments[1] == "replay";
  return is_agent(process) || program == "tree_broker" || program == "planner_service" || replays;
}

/// The value of an option; none if it was not given.
std::optional<std::string> option_of(const LocalProcess& process, const std::string& name) {
  const auto& arguments = process.arguments;
  for (std::size_t k = 1; k < arguments.size(); ++k) {
    if (arguments[k] == name && k + 1 < arguments.size()) return arguments[k + 1];
    if (arguments[k].starts_with(name + "=")) return arguments[k].substr(name.size() + 1);
  }
  return std::nullopt;
}

/// The domain that the process has joined: the first one on whose multicast port it listens. Multicast ports
/// of later domains may be its own unicast ports.
std::optional<int> domain_of(const LocalProcess& process, const Sockets& sockets) {
  for (int domain = 0; domain <= last_domain; ++domain) {
    const auto at_port = sockets.find(domain_port(domain));
    if (at_port == sockets.end()) continue;
    const auto is_its = [&](std::uint64_t socket) { return process.sockets.contains(socket); };
    if (std::ranges::any_of(at_port->second, is_its)) return domain;
  }
  return std::nullopt;
}

/// Whether a participant has its pair of ports in the domain.
bool has_participant(const Sockets& sockets, int domain) {
  for (int k = 0; k < participants_of_domain; ++k) {
    if (sockets.contains(participant_port(domain, k)) && sockets.contains(participant_port(domain, k) + 1))
      return true;
  }
  return false;
}

/// Whether the only socket at the domain's port may belong to one of many participants of an earlier domain.
bool is_overflow(const Sockets& sockets, int domain) {
  if (sockets.at(domain_port(domain)).size() > 1) return false;
  for (int before = domain - 1; before >= 0; --before) {
    const auto at_port = sockets.find(domain_port(before));
    const int needed =
        (domain - before) * ports_of_domain / 2 - (participant_port(0, 0) - domain_port(0)) / 2;
    if (at_port != sockets.end() && std::cmp_greater(at_port->second.size(), needed)) return true;
  }
  return false;
}

/// Sockets at the domain's port that belong to none of the processes.
bool has_strangers(const Sockets& sockets, int domain, std::span<const LocalProcess> processes) {
  const auto at_port = sockets.find(domain_port(domain));
  if (at_port == sockets.end()) return false;
  return std::ranges::any_of(at_port->second, [&](std::uint64_t socket) {
    return std::ranges::none_of(
        processes, [&](const LocalProcess& process) { return process.sockets.contains(socket); });
  });
}

void add(LocalFleet& fleet, const LocalProcess& process) {
  fleet.is_seen = true;
  is_agent(process) ? ++fleet.agents : ++fleet.others;
  const std::string discovery = option_of(process, "--discovery").value_or(process.servers);
  if (!discovery.empty()) fleet.discovery = discovery;
  fleet.is_secured = fleet.is_secured || option_of(process, "--security").has_value();
}

std::string command_for(const std::string& command, const LocalFleet& fleet) {
  std::vector<std::string> options{"--domain", std::to_string(fleet.domain)};
  if (!fleet.discovery.empty()) options.insert(options.end(), {"--discovery", fleet.discovery});
  return command + " " + shell_words(options) + (fleet.is_secured ? " --security KEYS/observer" : "");
}

/// Reads the links in /proc/PID/fd: "socket:[12345]".
std::set<std::uint64_t> sockets_of(const fs::path& process) {
  std::set<std::uint64_t> sockets;
  std::error_code problem;
  for (fs::directory_iterator file(process / "fd", problem); !problem && file != fs::directory_iterator();
       file.increment(problem)) {
    std::error_code gone;
    const std::string target = fs::read_symlink(file->path(), gone).string();
    constexpr std::string_view mark = "socket:[";
    std::uint64_t socket = 0;
    if (!gone && target.starts_with(mark) &&
        std::from_chars(target.data() + mark.size(), target.data() + target.size(), socket).ec == std::errc())
      sockets.insert(socket);
  }
  return sockets;
}

/// Empty if the file cannot be read, or is gone.
std::string contents_of(const fs::path& file) {
  try {
    return read_file(file);
  } catch (const InputError&) {
    return {};
  }
}

std::vector<std::string> texts_in(const fs::path& file) {
  std::vector<std::string> all;
  std::istringstream texts(contents_of(file));
  for (std::string text; std::getline(texts, text, '\0');) all.push_back(text);
  return all;
}

std::string servers_of(const fs::path& process) {
  constexpr std::string_view mark = "ROS_DISCOVERY_SERVER=";
  for (const std::string& variable : texts_in(process / "environ")) {
    if (variable.starts_with(mark)) return variable.substr(mark.size());
  }
  return {};
}

std::vector<LocalProcess> local_processes() {
  std::vector<LocalProcess> processes;
  std::error_code problem;
  for (fs::directory_iterator entry("/proc", problem); !problem && entry != fs::directory_iterator();
       entry.increment(problem)) {
    const std::string name = entry->path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    LocalProcess process{texts_in(entry->path() / "cmdline"), sockets_of(entry->path())};
    if (is_of_fleet(process)) process.servers = servers_of(entry->path());
    processes.push_back(std::move(process));
  }
  return processes;
}

}  // namespace

std::vector<LocalFleet> fleets_among(std::string_view table, std::span<const LocalProcess> processes) {
  const Sockets sockets = sockets_in(table);
  std::map<int, LocalFleet> fleets;
  for (const LocalProcess& process : processes) {
    if (!is_of_fleet(process)) continue;
    if (const auto domain = domain_of(process, sockets)) add(fleets[*domain], process);
  }
  for (int domain = 0; domain <= last_domain; ++domain) {
    if (fleets.contains(domain) || !has_strangers(sockets, domain, processes)) continue;
    if (has_participant(sockets, domain) && !is_overflow(sockets, domain)) fleets[domain];
  }
  std::vector<LocalFleet> all;
  for (auto& [domain, fleet] : fleets) {
    fleet.domain = domain;
    all.push_back(fleet);
  }
  return all;
}

std::string in_words(const LocalFleet& fleet) {
  if (!fleet.is_seen) return fmt::format("domain {}: DDS programs of another user", fleet.domain);
  const auto counted = [](int count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
  };
  return fmt::format("domain {}: {}, {}{}", fleet.domain, counted(fleet.agents, "robot agent"),
                     counted(fleet.others, "other role"), fleet.is_secured ? ", with --security" : "");
}

std::string choose_fleet(DdsSettings& network, std::span<const LocalFleet> fleets,
                         const std::string& command) {
  // Programs that cannot be inspected need not be a fleet.
  const bool some_are_seen = std::ranges::any_of(fleets, &LocalFleet::is_seen);
  std::vector<LocalFleet> choice;
  std::ranges::copy_if(fleets, std::back_inserter(choice),
                       [&](const LocalFleet& fleet) { return fleet.is_seen || !some_are_seen; });
  if (choice.empty())
    return fmt::format("no fleet is alive on this machine: waits on domain {} (--domain)", network.domain);
  if (choice.size() > 1) {
    std::string list = fmt::format("{} fleets are alive on this machine, choose one:", choice.size());
    for (const LocalFleet& fleet : choice)
      list += fmt::format("\n  {}   # {}", command_for(command, fleet), in_words(fleet));
    throw InputError(list);
  }
  const LocalFleet& fleet = choice.front();
  if (fleet.is_secured && network.security.empty())
    throw InputError(fmt::format("the fleet on domain {} is secured, expected the observer's credentials: {}",
                                 fleet.domain, command_for(command, fleet)));
  network.domain = fleet.domain;
  if (network.discovery.empty()) network.discovery = fleet.discovery;
  return "takes the fleet that is alive on this machine, " + in_words(fleet);
}

std::vector<LocalFleet> local_fleets() {
  return fleets_among(contents_of("/proc/net/udp"), local_processes());
}

std::string shell_words(std::span<const std::string> words) {
  std::vector<std::string> quoted;
  for (const std::string& word : words) {
    const auto is_plain = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
             std::string_view("_./:=,+-@%").find(c) != std::string_view::npos;
    };
    if (!word.empty() && std::ranges::all_of(word, is_plain)) {
      quoted.push_back(word);
      continue;
    }
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    quoted.push_back(text + "'");
  }
  return fmt::format("{}", fmt::join(quoted, " "));
}

}  // namespace coppice
