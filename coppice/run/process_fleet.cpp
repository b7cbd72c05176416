#include "coppice/run/process_fleet.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "runtime/process.h"

namespace coppice {

namespace {

constexpr std::chrono::milliseconds last_grace{2000};
constexpr std::streamoff shown_length = 300;  // characters

using Clock = std::chrono::steady_clock;

/// `log`: descriptor of the log; -1: output goes where this process's goes.
[[noreturn]] void become(const std::vector<std::string>& command, int log, int niceness, pid_t parent) {
  // The child dies with the parent. It has its own process group, so that Ctrl-C in the terminal reaches only
  // the parent.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // the parent had gone before prctl took effect
  setpgid(0, 0);
  // Other programs may rely on the default.
  std::signal(SIGPIPE, SIG_DFL);
  nice(niceness);  // if refused, the child runs with normal priority
  if (log >= 0) {
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
  }
  std::vector<char*> arguments;
  for (const std::string& argument : command)
    arguments.push_back(const_cast<char*>(argument.c_str()));  // NOLINT
  arguments.push_back(nullptr);
  execv(arguments.front(), arguments.data());
  _exit(127);
}

}  // namespace

ProcessFleet::ProcessFleet(std::filesystem::path log_folder) : log_folder_(std::move(log_folder)) {
  std::signal(SIGCHLD, SIG_DFL);  // an inherited SIG_IGN would hide the ends of children
}

ProcessFleet::~ProcessFleet() {
  terminate_all(last_grace);
}

pid_t ProcessFleet::start(const std::string& name, const std::vector<std::string>& command, Output output,
                          int niceness) {
  if (access(command.front().c_str(), X_OK) != 0) {
    throw std::runtime_error(
        fmt::format("{}: {} cannot be started: {}", name, command.front(), std::strerror(errno)));
  }
  const int log = output == Output::log ? open_log(name) : -1;
  const pid_t parent = getpid();
  // Stop signals to the child are blocked until it can handle them (install_stop_signals).
  const sigset_t stop = stop_signals();
  sigset_t before;
  sigprocmask(SIG_BLOCK, &stop, &before);
  const pid_t pid = fork();
  if (pid != 0) sigprocmask(SIG_SETMASK, &before, nullptr);
  if (pid != 0 && log >= 0) close(log);
  if (pid < 0) throw std::runtime_error(fmt::format("{}: no new process: {}", name, std::strerror(errno)));
  if (pid == 0) become(command, log, niceness, parent);
  running_.push_back({name, pid});
  starts_.insert_or_assign(name, Start{command, output, niceness});
  return pid;
}

/// Opened before the child starts: a reader of the log never sees what an earlier run left there.
int ProcessFleet::open_log(const std::string& name) const {
  const std::filesystem::path file = log_folder_ / (name + ".log");
  const int mode = starts_.contains(name) ? O_APPEND : O_TRUNC;
  const int log = open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | mode, 0644);
  if (log < 0)
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
  return log;
}

void ProcessFleet::start_again(const std::string& name) {
  const Start again = starts_.at(name);
  start(name, again.command, again.output, again.niceness);
}

std::optional<ProcessFleet::Ended> ProcessFleet::reap() {
  for (auto child = running_.begin(); child != running_.end(); ++child) {
    int status = 0;
    if (waitpid(child->pid, &status, WNOHANG) != child->pid) continue;
    Ended ended{child->name, WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                end_of_log(child->name)};
    running_.erase(child);
    return ended;
  }
  return std::nullopt;
}

void ProcessFleet::terminate(const std::string& name) {
  for (const Child& child : running_) {
    if (child.name == name) kill(child.pid, SIGTERM);
  }
}

std::vector<ProcessFleet::Ended> ProcessFleet::terminate_all(std::chrono::milliseconds grace,
                                                             const std::string& but) {
  const auto stays = [&](const Child& child) { return child.name == but; };
  std::vector<Ended> gone;
  const auto end_them = [&](int signal, Clock::time_point latest) {
    for (const Child& child : running_) {
      if (!stays(child)) kill(child.pid, signal);
    }
    while (!std::ranges::all_of(running_, stays) && Clock::now() < latest) {
      if (auto ended = reap()) {
        gone.push_back(std::move(*ended));
      } else {
        std::this_thread::sleep_for(poll_period);
      }
    }
  };
  end_them(SIGTERM, Clock::now() + grace);
  end_them(SIGKILL, Clock::time_point::max());
  return gone;
}

std::string ProcessFleet::end_of_log(const std::string& name) const {
  std::ifstream log(log_folder_ / (name + ".log"), std::ios::ate);
  log.seekg(std::max<std::streamoff>(0, log.tellg() - shown_length));
  return {std::istreambuf_iterator<char>(log), {}};
}

}  // namespace coppice
