// What an operator should look at now: robots that are not heard or have failed, missed control periods, a
// service that is not heard. Page, API and metrics show the same list.
//
// A state machine without a clock. Each kind of alarm is one rule in alarms.cpp, which says in words what is
// wrong; the board remembers since when.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "monitor/view/fleet_view.h"

namespace coppice {

enum class AlarmKind : unsigned char {
  robot_silent,
  robot_failed,
  periods_missed,
  service_silent,
  orders_refused,  ///< by the service, for want of room on its disk
};
/// As API and metrics name them.
inline constexpr std::array<std::string_view, 5> alarm_names{"robot_silent", "robot_failed", "periods_missed",
                                                             "service_silent", "orders_refused"};

struct Alarm {
  AlarmKind kind = AlarmKind::robot_silent;
  RobotName robot{};   ///< empty: the alarm is of the whole fleet
  WallTime since = 0;  ///< wall clock
  std::string text{};  ///< what is wrong, in a sentence that stays the same while the alarm lasts
  bool operator==(const Alarm&) const = default;
};

class AlarmBoard {
 public:
  void look(const FleetView& view, WallTime now);

  /// Those of the fleet, and then those of robots by kind.
  const std::vector<Alarm>& alarms() const { return alarms_; }
  std::size_t count(AlarmKind kind) const;

 private:
  using Name = std::pair<AlarmKind, RobotName>;

  std::vector<Alarm> alarms_;
  std::map<Name, WallTime> since_;
};

}  // namespace coppice
