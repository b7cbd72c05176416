// Processes as a test sees them from outside: it starts them in the background, finds them by their parent,
// and checks afterwards whether they have ended.
#pragma once

#include <algorithm>
#include <cctype>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace coppice::test {

/// A command in the background, in its own process group. It is killed and reaped if it still runs at the
/// end. Its temporary folders, which it leaves when it is killed, lie in the folder of its log.
class Background {
 public:
  /// Standard output and error go to `log`. Standard input is the file of number `input`, by default this
  /// process's.
  Background(std::vector<std::string> command, const std::filesystem::path& log, int input = STDIN_FILENO) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    if (input != STDIN_FILENO) posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    command.insert(command.begin(), {"/usr/bin/env", "TMPDIR=" + log.parent_path().string()});
    std::vector<char*> arguments;
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    const int error = posix_spawn(&pid_, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::runtime_error(command[2] + " cannot be started");
  }
  ~Background() {
    if (reaped_) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  pid_t pid() const { return pid_; }
  void send(int signal) const { kill(pid_, signal); }
  /// Exit code, or 128 + the signal that ended the process.
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    reaped_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
  bool reaped_ = false;
};

struct ProcessInfo {
  pid_t pid = 0;
  pid_t parent = 0;
  char state = '?';
  std::string name;  ///< at most 15 characters
};

inline std::vector<ProcessInfo> processes() {
  std::vector<ProcessInfo> all;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    if (!std::isdigit(static_cast<unsigned char>(entry.path().filename().string().front()))) continue;
    std::ifstream file(entry.path() / "stat");
    std::string line;
    if (!std::getline(file, line)) continue;  // it has ended in the meantime
    const std::size_t open = line.find('(');
    const std::size_t close = line.rfind(')');
    ProcessInfo info{.pid = std::stoi(line), .name = line.substr(open + 1, close - open - 1)};
    std::istringstream(line.substr(close + 1)) >> info.state >> info.parent;
    all.push_back(info);
  }
  return all;
}

inline std::vector<ProcessInfo> children_of(pid_t parent) {
  std::vector<ProcessInfo> all = processes();
  std::erase_if(all, [&](const ProcessInfo& process) { return process.parent != parent; });
  return all;
}

/// Whether the process is gone, or has ended and is not reaped yet.
inline bool has_ended(pid_t pid) {
  const std::vector<ProcessInfo> all = processes();
  return std::none_of(all.begin(), all.end(),
                      [&](const ProcessInfo& process) { return process.pid == pid && process.state != 'Z'; });
}

/// Whether `condition` became true within the time.
template <class Condition>
bool within(std::chrono::milliseconds time, Condition condition) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

/// Files of Fast DDS in shared memory: there should be none.
inline std::set<std::string> shared_memory() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    const std::string name = entry.path().filename().string();
    if (name.find("fastrtps_") != std::string::npos) names.insert(name);
  }
  return names;
}

}  // namespace coppice::test
