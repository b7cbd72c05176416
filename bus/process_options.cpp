#include "bus/process_options.h"

#include <regex>
#include <vector>

namespace coppice {

CLI::Validator a_discovery() {
  const auto problem = [](const std::string& text) -> std::string {
    static const std::regex known("multicast|static|[^:;]+:[0-9]{1,5}(;[^:;]+:[0-9]{1,5})*");
    if (std::regex_match(text, known)) return {};
    return text + " is no way to find others, expected multicast, static or HOST:PORT;...";
  };
  return {problem, "multicast|static|HOST:PORT"};
}

void add_process_options(CLI::App& app, ProcessOptions& options) {
  app.add_option("--domain", options.network.domain, "DDS domain")->check(CLI::Range(0, 232));
  app.add_option("--discovery", options.network.discovery,
                 "multicast, static, or discovery servers: HOST:PORT, several with ; between them")
      ->check(a_discovery());
  app.add_option("--security", options.network.security,
                 "turns DDS-Security on: folder with this role's credentials");
  app.add_option("--datagram", options.network.largest_datagram,
                 "largest UDP datagram, bytes: the default fits every network")
      ->check(CLI::Range(datagram_for_networks, datagram_for_one_host));
  app.add_option("--state", options.state,
                 "folder in which it keeps what it needs to go on if it is started anew");
  app.add_option("--alive", options.alive,
                 "file that is touched every second while all is well: for health checks");
  app.add_option("--log-level", options.log_level, "trace, debug, info, warning, error or off")
      ->check(CLI::IsMember(
          std::vector<std::string>{"trace", "debug", "info", "warning", "error", "critical", "off"}));
  app.add_flag("--log-json", options.log_json, "log lines of JSON");
}

}  // namespace coppice
