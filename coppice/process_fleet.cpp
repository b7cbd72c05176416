#include "coppice/process_fleet.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "coppice/shared_memory.h"

namespace coppice {

namespace {

constexpr std::chrono::milliseconds last_grace{2000};
constexpr std::chrono::milliseconds poll_period{10};
constexpr std::size_t last_words_length = 300;  // characters

[[noreturn]] void become(const std::vector<std::string>& command, const std::string& log, pid_t parent) {
  // The child's own: dies with the parent, is not ended by the terminal's Ctrl-C before the parent decides.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // the parent was gone before the wish was known
  setpgid(0, 0);
  if (!log.empty()) {
    const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file >= 0) {
      dup2(file, STDOUT_FILENO);
      dup2(file, STDERR_FILENO);
    }
  }
  std::vector<char*> arguments;
  for (const std::string& argument : command)
    arguments.push_back(const_cast<char*>(argument.c_str()));  // NOLINT
  arguments.push_back(nullptr);
  execv(arguments.front(), arguments.data());
  _exit(127);
}

/// A program that is not run: the rest of this process waits until `lifeline`, whose other end this fleet and
/// its children hold, is closed by the last of them, however they ended; then it clears up. The locks of the
/// last may be let go a moment after its end of the lifeline; those of other containers stay.
[[noreturn]] void clear_up_after(int lifeline) {
  setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_IGN);
  char nothing = 0;
  while (read(lifeline, &nothing, 1) < 0 && errno == EINTR) continue;
  const auto end = std::chrono::steady_clock::now() + last_grace;
  while (remove_stale_shared_memory() > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(poll_period);
  _exit(0);
}

}  // namespace

ProcessFleet::ProcessFleet(std::filesystem::path log_folder) : log_folder_(std::move(log_folder)) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error(fmt::format("no new pipe: {}", std::strerror(errno)));
  caretaker_ = fork();
  if (caretaker_ == 0) {
    close(ends[1]);
    clear_up_after(ends[0]);
  }
  close(ends[0]);
  lifeline_ = ends[1];
  if (caretaker_ < 0) {
    close(lifeline_);
    throw std::runtime_error(fmt::format("no new process: {}", std::strerror(errno)));
  }
}

ProcessFleet::~ProcessFleet() {
  terminate_all(last_grace);
  close(lifeline_);
  waitpid(caretaker_, nullptr, 0);
}

void ProcessFleet::start(const std::string& name, const std::vector<std::string>& command, Output output) {
  if (access(command.front().c_str(), X_OK) != 0) {
    throw std::runtime_error(
        fmt::format("{}: {} cannot be started: {}", name, command.front(), std::strerror(errno)));
  }
  const std::string log = output == Output::log ? (log_folder_ / (name + ".log")).string() : std::string();
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error(fmt::format("{}: no new process: {}", name, std::strerror(errno)));
  if (pid == 0) become(command, log, parent);
  running_.push_back({name, pid});
}

std::optional<ProcessFleet::Ended> ProcessFleet::reap() {
  for (auto child = running_.begin(); child != running_.end(); ++child) {
    int status = 0;
    if (waitpid(child->pid, &status, WNOHANG) != child->pid) continue;
    Ended ended{child->name, WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                last_words_of(child->name)};
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

void ProcessFleet::terminate_all(std::chrono::milliseconds grace) {
  for (const Child& child : running_) kill(child.pid, SIGTERM);
  const auto end = std::chrono::steady_clock::now() + grace;
  while (!running_.empty() && std::chrono::steady_clock::now() < end) {
    if (!reap()) std::this_thread::sleep_for(poll_period);
  }
  for (const Child& child : running_) {
    kill(child.pid, SIGKILL);
    waitpid(child.pid, nullptr, 0);
  }
  running_.clear();
}

std::string ProcessFleet::last_words_of(const std::string& name) const {
  std::ifstream log(log_folder_ / (name + ".log"));
  const std::string all{std::istreambuf_iterator<char>(log), {}};
  return all.size() > last_words_length ? all.substr(all.size() - last_words_length) : all;
}

}  // namespace coppice
