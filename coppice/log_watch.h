// Passes on what processes warn of in their logs, so that it is seen where the run was started.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "messages/fleet_clock.h"

namespace coppice {

/// A line of a log as set_up_logging (runtime/process.h) makes it, without its time and name, if it warns or
/// reports an error: "warning: ..."; none: any other line.
std::optional<std::string> warning_in(std::string_view line);

class LogWatch {
 public:
  /// Watches the logs of the processes of these names: NAME.log in `folder`. `kept`: the folder outlives the
  /// run.
  LogWatch(std::filesystem::path folder, const std::vector<std::string>& names, bool kept);

  /// What was logged since the last call, each line with the process's name before it. Of many lines in a
  /// short time the first, and how many more there are.
  std::vector<std::string> news(WallTime now);

 private:
  struct Log {
    std::uintmax_t read = 0;  ///< bytes
    std::string rest{};       ///< of a line that is not whole yet
    int passed = 0;           ///< lines, in this window
  };

  void read(const std::string& name, Log& log, std::vector<std::string>& lines);
  void begin_window(WallTime now, std::vector<std::string>& lines);

  std::filesystem::path folder_;
  bool kept_;
  std::map<std::string, Log> logs_;
  WallTime window_begins_ = 0;
  int passed_ = 0;     ///< in this window, of all
  int held_back_ = 0;  ///< likewise
};

}  // namespace coppice
