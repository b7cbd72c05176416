// The knowledge of the planner service about one robot: its task, what its agent last said, and what the
// report counts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <variant>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/motion/separation.h"
#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"
#include "planner_service/orders/goal_source.h"
#include "planning/trees/ma_rrdt_star.h"

namespace coppice {

/// Whether a robot is within the tolerances of its goal.
bool is_on_goal(const RobotTask& task, const TrackPoint& point);

/// Where a robot comes to rest if it brakes now.
Point2 rest_of(const TrackPoint& last, const RobotTask& robot);

/// The control periods of an agent in this run. Its process counts them from its own start, which is before
/// the run or, after a restart, within it.
class ControlPeriods {
 public:
  /// `first_status`: of a mission.
  void count(const AgentLoad& load, bool first_status);
  std::uint32_t all() const { return all_; }
  std::uint32_t missed() const { return missed_; }
  std::uint32_t all_before() const { return all_before_; }
  std::uint32_t missed_before() const { return missed_before_; }
  /// Goes on after a service before this one.
  static ControlPeriods counted_before(std::uint32_t all, std::uint32_t missed, std::uint32_t all_before,
                                       std::uint32_t missed_before) {
    ControlPeriods periods;
    periods.all_ = all;
    periods.missed_ = missed;
    periods.all_before_ = all_before;
    periods.missed_before_ = missed_before;
    return periods;
  }

 private:
  std::uint32_t all_ = 0;
  std::uint32_t missed_ = 0;
  std::uint32_t all_before_ = 0;  ///< that the process counts and that are not of this run
  std::uint32_t missed_before_ = 0;
};

/// No point of the track has arrived.
struct NoTrack {};
struct TrackBegan {
  double at = 0;  ///< fleet time of its first point
};
/// The agent restarted without its saved state and began a second track. It does not know where the robot
/// was, so the robot must stop.
struct TrackLost {};
using TrackBeginning = std::variant<NoTrack, TrackBegan, TrackLost>;

struct RobotRecord {
  RobotTask task;         ///< with the latest goal
  std::size_t index = 0;  ///< in the order of the scenario
  std::uint32_t mission = 1;
  std::uint32_t replaced_missions = 0;          ///< that a new goal ended before they were fulfilled
  std::optional<std::uint32_t> trees_received;  ///< none: no status of the agent has arrived
  std::optional<AgentStatus> status;            ///< the last one of this mission
  std::optional<AgentStatus> first_status;      ///< the last one of the first mission
  ControlPeriods periods;
  SampleCounts earlier_nodes;  ///< of the missions before this one
  std::uint32_t earlier_grafts = 0;
  TrackBeginning track;
  std::uint32_t next_point = 0;      ///< index of the one after the last that came, among all of its track
  std::uint32_t points_missing = 0;  ///< that never came, or too late to be counted
  Path path;
  std::vector<RootNodes::Node> root_nodes;

  bool arrived() const { return has_phase(Phase::arrived); }
  bool has_no_way() const { return status && coppice::has_no_way(status->phase); }
  bool halted() const { return has_phase(Phase::halted); }
  /// The agent confirmed that its mission is cancelled.
  bool stopped() const { return has_phase(Phase::stopped); }
  bool track_lost() const { return std::holds_alternative<TrackLost>(track); }
  /// `at_goal`: this mission counts too.
  std::uint32_t missions_fulfilled(bool at_goal) const { return mission - 1 - replaced_missions + at_goal; }

  /// Takes up a status of this mission.
  void update(const AgentStatus& latest, bool run_has_ended);
  /// Takes up a path of this mission.
  void update(const PathMessage& latest);
  /// Takes up nodes of this mission.
  void add(const RootNodes& batch);
  /// The agent sends its track from the beginning. True if this loses the track.
  bool track_begins(double at);
  void begin_next_mission(const Point2& start, const NextGoal& goal);
  /// Takes up a mission that a service before this one has begun, and counted.
  void go_on_with(std::uint32_t number, const Point2& start, const NextGoal& goal);
  // `field`: with the margin that robots keep.
  /// It begins there, and stays there until its next mission.
  void begins_at(const Point2& place, double yaw, const ClearanceField& field);
  /// It is seen for the first time. A robot that was to stay at its start stays there.
  void stands_at(const Point2& place, double yaw, const ClearanceField& field);
  /// A service before this one sent it there, in this mission.
  void began_as(const Mission& saved, const ClearanceField& field);

 private:
  bool has_phase(Phase phase) const { return status && status->phase == phase; }
};

/// The robots in the order of the scenario, and by name.
class RobotRecords {
 public:
  explicit RobotRecords(const std::vector<RobotTask>& tasks);

  RobotRecord* find(const RobotName& name);
  const RobotRecord& at(const RobotName& name) const { return records_[index_.at(name)]; }
  RobotRecord& operator[](std::size_t index) { return records_[index]; }
  const RobotRecord& operator[](std::size_t index) const { return records_[index]; }
  std::size_t size() const { return records_.size(); }
  auto begin() { return records_.begin(); }
  auto end() { return records_.end(); }
  auto begin() const { return records_.begin(); }
  auto end() const { return records_.end(); }

 private:
  std::vector<RobotRecord> records_;
  std::map<RobotName, std::size_t> index_;
};

/// The share of all control periods of a run that were missed.
double share_of_periods_missed(const RobotRecords& robots);

}  // namespace coppice
