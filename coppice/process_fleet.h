// Child processes that never outlive this one, however it ends.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace coppice {

class ProcessFleet {
 public:
  /// Standard output and error of quiet children go to `log_folder`/NAME.log; the folder exists.
  explicit ProcessFleet(std::filesystem::path log_folder);
  /// Ends and reaps whatever still runs.
  ~ProcessFleet();
  ProcessFleet(const ProcessFleet&) = delete;
  ProcessFleet& operator=(const ProcessFleet&) = delete;

  enum class Output { terminal, log };

  /// Starts `command` (program and arguments); the kernel ends it when this process is gone. `niceness`:
  /// added to this process's. Returns its process id. Throws std::runtime_error if it cannot be started.
  pid_t start(const std::string& name, const std::vector<std::string>& command, Output output,
              int niceness = 0);

  /// The same again, of a child that has ended; its log goes on.
  void start_again(const std::string& name);

  struct Ended {
    std::string name;
    int exit_code = 0;       ///< 128 + signal if one ended it
    std::string last_words;  ///< the end of its log
  };
  /// A child that has ended since the last call, if there is one; does not wait.
  std::optional<Ended> reap();

  /// Sends SIGTERM to the child, if it still runs.
  void terminate(const std::string& name);
  /// SIGTERM to all but the one of that name, SIGKILL to who is not gone after `grace`. Returns how these
  /// have ended, and that one if it has meanwhile.
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
  std::string last_words_of(const std::string& name) const;

  std::filesystem::path log_folder_;
  std::map<std::string, Start> starts_;
  std::vector<Child> running_;
};

}  // namespace coppice
