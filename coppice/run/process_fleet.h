// Child processes that never outlive this process, however it ends.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace coppice {

/// How often a caller looks whether a child has ended.
inline constexpr std::chrono::milliseconds poll_period{10};

class ProcessFleet {
 public:
  /// Output and errors of children with Output::log go to `log_folder`/NAME.log. The folder must exist.
  explicit ProcessFleet(std::filesystem::path log_folder);
  /// Ends and reaps all children that still run.
  ~ProcessFleet();
  ProcessFleet(const ProcessFleet&) = delete;
  ProcessFleet& operator=(const ProcessFleet&) = delete;

  enum class Output { terminal, log };

  /// Starts `command` (program and arguments). The kernel ends the child when this process ends. `niceness`
  /// is added to this process's. Returns the process id. Throws std::runtime_error if the program cannot be
  /// started.
  pid_t start(const std::string& name, const std::vector<std::string>& command, Output output,
              int niceness = 0);

  /// Starts a child again that has ended. Appends to its log.
  void start_again(const std::string& name);

  struct Ended {
    std::string name;
    int exit_code = 0;    ///< 128 + signal if a signal ended it
    std::string log_end;  ///< the end of its log
  };
  /// Returns a child that has ended since the last call, if there is one. Does not wait.
  std::optional<Ended> reap();

  /// Sends SIGTERM to the child, if it still runs.
  void terminate(const std::string& name);
  /// Sends SIGTERM to all children except `but`, and SIGKILL to those that still run after `grace`. Returns
  /// all children that have ended meanwhile, also `but`.
  std::vector<Ended> terminate_all(std::chrono::milliseconds grace, const std::string& but = {});

 private:
  struct Start {
    std::vector<std::string> command;
    Output output;
    int niceness;
  };
  struct Child {
    std::string name;
    pid_t pid;
  };
  int open_log(const std::string& name) const;
  std::string end_of_log(const std::string& name) const;

  std::filesystem::path log_folder_;
  std::map<std::string, Start> starts_;
  std::vector<Child> running_;
};

}  // namespace coppice
