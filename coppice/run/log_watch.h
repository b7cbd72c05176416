// Passes on the warnings in the logs of processes to the terminal from which the run was started.
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

/// Returns a warning or an error in a line of a log that set_up_logging (runtime/process.h) has written,
/// without time and name: "warning: ...". Returns nothing for any other line.
std::optional<std::string> warning_in(std::string_view line);

class LogWatch {
 public:
  /// Watches the logs of the named processes: NAME.log in `folder`. `kept`: the folder outlives the run.
  LogWatch(std::filesystem::path folder, const std::vector<std::string>& names, bool kept);

  /// Returns the warnings since the last call, each with the process's name in front. Of many warnings in a
  /// short time it returns only the first ones, and later their number.
  std::vector<std::string> news(WallTime now);
  /// Returns all warnings that are left, in the same way, and the number of those that were held back. Called
  /// once, when all processes have ended.
  std::vector<std::string> last_news(WallTime now);

 private:
  struct Log {
    std::uintmax_t read = 0;  ///< bytes
    std::string rest{};       ///< the beginning of an incomplete line
    int passed = 0;           ///< lines, in this window
  };

  bool read(const std::string& name, Log& log, std::vector<std::string>& lines);
  void tell_held_back(std::vector<std::string>& lines) const;
  void begin_window(WallTime now, std::vector<std::string>& lines);

  std::filesystem::path folder_;
  bool kept_;
  std::map<std::string, Log> logs_;
  WallTime window_begins_ = 0;
  int passed_ = 0;     ///< lines of all processes in this window
  int held_back_ = 0;  ///< lines of all processes in this window
};

}  // namespace coppice
