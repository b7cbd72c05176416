#include "runtime/process.h"

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>
#include <memory>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace coppice {

namespace {

// A signal handler may touch only this kind of variable. Nothing else in the project is global.
volatile std::sig_atomic_t stop_flag = 0;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

extern "C" void on_stop_signal(int) {
  stop_flag = 1;
}

/// Formats a text as the content of a JSON string, between its quotes.
class JsonText final : public spdlog::custom_flag_formatter {
 public:
  explicit JsonText(spdlog::string_view_t spdlog::details::log_msg::*text) : text_(text) {}
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    for (const char c : message.*text_) {
      if (c == '"' || c == '\\') {
        out.push_back('\\');
        out.push_back(c);
      } else if (static_cast<unsigned char>(c) < 0x20) {
        fmt::format_to(std::back_inserter(out), "\\u{:04x}", static_cast<unsigned>(c));
      } else {
        out.push_back(c);
      }
    }
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JsonText>(text_); }

 private:
  spdlog::string_view_t spdlog::details::log_msg::*text_;
};

std::unique_ptr<spdlog::formatter> json_lines() {
  auto lines = std::make_unique<spdlog::pattern_formatter>();
  lines->add_flag<JsonText>('N', &spdlog::details::log_msg::logger_name);
  lines->add_flag<JsonText>('V', &spdlog::details::log_msg::payload);
  lines->set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","name":"%N","message":"%V"})");
  return lines;
}

constexpr WallTime heartbeat_period = 1;  // seconds

bool touch(const std::string& file) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) return false;
  const bool touched = futimens(descriptor, nullptr) == 0;
  close(descriptor);
  return touched;
}

/// Sends a datagram to the socket that systemd has named (sd_notify(3)), if any.
void tell_systemd(const std::string& state) {
  const char* const name = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name == nullptr || std::strlen(name) >= sizeof address.sun_path) return;
  std::strcpy(address.sun_path, name);
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';  // an abstract socket
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return;
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(name));
  sendto(socket, state.data(), state.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address), size);
  close(socket);
}

}  // namespace

void fill_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    const bool is_open = fcntl(stream, F_GETFD) >= 0;
    if (!is_open) (void)open("/dev/null", O_RDWR);  // takes the lowest free number, which is this stream's
  }
}

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  return signals;
}

void install_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  const sigset_t stop = stop_signals();
  sigprocmask(SIG_UNBLOCK, &stop, nullptr);
}

bool stop_requested() {
  return stop_flag != 0;
}

void give_way() {
  constexpr int behind_agents = 15;  // `coppice run` starts those at 10
  if (::getpriority(PRIO_PROCESS, 0) < behind_agents) ::setpriority(PRIO_PROCESS, 0, behind_agents);
}

Heartbeat::Heartbeat(std::string file) : file_(std::move(file)) {
  if (!file_.empty() && !touch(file_))
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", file_, std::strerror(errno)));
  tell_systemd("READY=1");
}

void Heartbeat::beat(WallTime now) {
  if (now < next_) return;
  next_ = now + heartbeat_period;
  if (!file_.empty()) touch(file_);
  tell_systemd("WATCHDOG=1");
}

void set_up_logging(const std::string& name, const std::string& level, bool as_json) {
  auto logger = spdlog::stderr_color_mt(name);
  if (as_json) {
    logger->set_formatter(json_lines());
  } else {
    logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %n: %v");
  }
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(std::move(logger));
}

int exit_code_of(const std::function<int()>& program) {
  try {
    return program();
  } catch (const std::exception& problem) {
    spdlog::set_level(spdlog::level::err);  // logging may be off
    spdlog::error("{}", problem.what());
    return 2;
  }
}

}  // namespace coppice
