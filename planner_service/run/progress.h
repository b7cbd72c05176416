// The progress of a run on the terminal.
#pragma once

#include <ostream>
#include <string>

#include "planner_service/run/planner_service.h"

namespace coppice {

/// One line: paths found, robots arrived, elapsed fleet time, and nodes that joined trees in a second of
/// fleet time.
std::string progress_line(const Progress& progress);

/// Shows progress. On a terminal it redraws one line, elsewhere it writes a line each second.
class ProgressDisplay {
 public:
  ProgressDisplay(std::ostream& out, bool terminal) : out_(out), terminal_(terminal) {}
  void show(const Progress& progress, WallTime now);
  /// Shows the last state and ends the line.
  void finish(const Progress& progress);

 private:
  std::ostream& out_;
  bool terminal_;
  WallTime next_ = 0;
};

}  // namespace coppice
