// Chooses which of the messages of a robot's agent are worth a line of the log: missions, paths, arrivals,
// waits and their causes, and control periods that the process missed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "messages/messages.h"

namespace coppice {

class EventLog {
 public:
  struct Line {
    bool is_warning = false;
    std::string text{};
    bool operator==(const Line&) const = default;
  };

  explicit EventLog(RobotName robot) : robot_(std::move(robot)) {}

  void heard(const Message& message);
  std::vector<Line> said(const Message& message, WallTime now);

 private:
  void say_path(const PathMessage& path, std::vector<Line>& lines);
  void say_status(const AgentStatus& status, WallTime now, std::vector<Line>& lines);
  void say_mission(const AgentStatus& status, std::vector<Line>& lines) const;
  void say_phase(const AgentStatus& status, std::vector<Line>& lines) const;
  void say_wait(const AgentStatus& status, double fleet_now, std::vector<Line>& lines);
  void say_missed_periods(const AgentLoad& load, WallTime now, std::vector<Line>& lines);

  /// A wait that the log has told of.
  struct Wait {
    double since;  ///< fleet time
    std::string cause;
    double told_at;  ///< fleet time
    bool warned = false;
  };
  /// When the count of missed periods began, and what the load was then.
  struct Count {
    WallTime since;
    AgentLoad load;
  };

  RobotName robot_;
  std::optional<Mission> mission_{};  ///< the last one that was heard
  std::optional<AgentStatus> last_{};
  double path_length_ = 0;  ///< metres, of the path that was told last; 0: none of this mission
  std::optional<Wait> wait_{};
  std::optional<Count> count_{};
  std::optional<WallTime> warned_of_periods_at_{};
};

}  // namespace coppice
