#include "monitor/view/live_stream.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "planning/geometry/packed_cells.h"

namespace coppice {

namespace {

constexpr double frame_period = 1.0 / 20;  // seconds
constexpr double beat_period = 1.0 / 4;
constexpr double figures_period = 1.0 / 2;
constexpr std::size_t most_figures = 30 * 60 * 2;  // half an hour of points

std::uint32_t count(std::size_t n) {
  return static_cast<std::uint32_t>(n);
}

live::Map map_of(const MapMessage& message) {
  const OccupancyMap& map = message.map;
  live::Map out;
  out.set_id(message.map_id);
  out.set_width(static_cast<std::uint32_t>(map.width));
  out.set_height(static_cast<std::uint32_t>(map.height));
  out.set_resolution(map.resolution);
  out.set_origin_x(map.origin.x());
  out.set_origin_y(map.origin.y());
  out.set_y_up(map.y_axis == YAxis::up);
  out.set_occupancy(packed_cells<std::string>(map.blocked));
  return out;
}

live::Roster::Robot robot_of(const SeenRobot& robot) {
  live::Roster::Robot out;
  out.set_name(robot.name);
  if (robot.mission) {
    const Mission& mission = *robot.mission;
    out.set_radius(own_radius(mission));
    for (const Point2& corner : mission.footprint) {
      out.add_footprint(static_cast<float>(corner.x()));
      out.add_footprint(static_cast<float>(corner.y()));
    }
    out.set_max_speed(mission.max_speed);
    out.set_max_acceleration(mission.max_acceleration);
    out.set_start_x(mission.start.x());
    out.set_start_y(mission.start.y());
    out.set_goal_x(mission.goal.x());
    out.set_goal_y(mission.goal.y());
    out.set_goal_tolerance(mission.goal_tolerance);
    out.set_mission(mission.number);
  } else if (robot.state) {
    out.set_radius(robot.state->radius);
    out.set_max_speed(robot.state->max_speed);
    out.set_max_acceleration(robot.state->max_acceleration);
  }
  return out;
}

live::Statuses::Status status_of(std::size_t number, const SeenRobot& robot, double time) {
  const AgentStatus& status = *robot.status;
  live::Statuses::Status out;
  out.set_robot(count(number));
  out.set_phase(static_cast<live::Phase>(phase_of(robot)));
  out.set_reason(status.reason);
  out.set_plan_seconds(status.plan_seconds);
  out.set_arrival_time(status.arrival_time);
  out.set_driven_length(status.driven_length);
  out.set_path_length(length_of(robot.path));
  out.set_nodes_valid(status.nodes_valid);
  out.set_nodes_invalid(status.nodes_invalid);
  out.set_trees_received(status.trees_received);
  out.set_trees_grafted(status.trees_grafted);
  out.set_rejected(status.rejected);
  out.set_periods(status.load.periods);
  out.set_periods_missed(status.load.periods_missed);
  out.set_state_age_p50(status.load.state_age_p50);
  out.set_state_age_p99(status.load.state_age_p99);
  out.set_state_age_max(status.load.state_age_max);
  out.set_processor_share(robot.processor.of_one_core);
  out.set_missions_fulfilled(robot.missions_fulfilled);
  out.set_missed_share(robot.missed.of_all);
  out.set_wait_cause(wait_of(robot, time).value_or(Wait{}).cause);
  out.set_waited(sum_of(status.waits));
  return out;
}

live::Figures::Point point_of(const FleetFigures& figures) {
  live::Figures::Point out;
  out.set_time(figures.time);
  out.set_robots(count(figures.robots));
  out.set_planned(count(figures.planned));
  out.set_arrived(count(figures.arrived));
  out.set_missions(count(figures.missions));
  out.set_trees_published(count(figures.trees_published));
  out.set_trees_grafted(count(figures.trees_grafted));
  if (figures.separation) out.set_separation(static_cast<float>(*figures.separation));
  out.set_state_age_p50(static_cast<float>(figures.state_age_p50));
  out.set_state_age_p99(static_cast<float>(figures.state_age_p99));
  out.set_processors(static_cast<float>(figures.processors));
  out.set_periods_missed(static_cast<float>(figures.missed_share));
  return out;
}

Point2 velocity_at(const RobotState& state, double time) {
  if (time < state.promise.decision_time) return state.promise.velocity;
  return time < state.promise.expiry ? state.promise.next_velocity : Point2(Point2::Zero());
}

void add_unheard(live::Frame& frame, WallTime silence) {
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  for (auto* list : {frame.mutable_x(), frame.mutable_y(), frame.mutable_age(), frame.mutable_to_go(),
                     frame.mutable_yaw()})
    list->Add(unknown);
  for (auto* list :
       {frame.mutable_vx(), frame.mutable_vy(), frame.mutable_decision_time(), frame.mutable_next_vx(),
        frame.mutable_next_vy(), frame.mutable_expiry(), frame.mutable_waiting(), frame.mutable_idle()})
    list->Add(0);
  frame.add_silence(static_cast<float>(silence));
  frame.mutable_phase()->push_back(static_cast<char>(Phase::waiting));
  frame.mutable_stage()->push_back(static_cast<char>(Stage::free));
  frame.add_waits_for(-1);
}

void add_robot(live::Frame& frame, const FleetView& view, const SeenRobot& robot, const Point2& origin,
               double time, WallTime silence) {
  const auto as_float = [](double x) { return static_cast<float>(x); };
  const RobotState& state = *robot.state;
  const Point2 place = position_at(state, time) - origin;
  const Point2 velocity = velocity_at(state, time);
  const auto leader = state.waits_for.empty() ? std::nullopt : view.find(state.waits_for);
  frame.add_x(as_float(place.x()));
  frame.add_y(as_float(place.y()));
  frame.add_vx(as_float(velocity.x()));
  frame.add_vy(as_float(velocity.y()));
  frame.mutable_phase()->push_back(static_cast<char>(phase_of(robot)));
  frame.mutable_stage()->push_back(static_cast<char>(state.stage));
  frame.add_waits_for(leader ? static_cast<std::int32_t>(*leader) : -1);
  frame.add_decision_time(as_float(std::max(0.0, state.promise.decision_time - time)));
  frame.add_next_vx(as_float(state.promise.next_velocity.x()));
  frame.add_next_vy(as_float(state.promise.next_velocity.y()));
  frame.add_expiry(as_float(std::max(0.0, state.promise.expiry - time)));
  frame.add_age(as_float(std::max(0.0, time - state.promise.stamp)));
  frame.add_to_go(as_float(way_left(robot, time).value_or(std::numeric_limits<double>::quiet_NaN())));
  frame.add_waiting(as_float(wait_of(robot, time).value_or(Wait{}).seconds));
  frame.add_idle(as_float(robot.progress.without_progress(time)));
  const bool turns = state.max_angular_speed > 0;
  frame.add_yaw(as_float(turns ? yaw_at(state, time) : std::numeric_limits<double>::quiet_NaN()));
  frame.add_silence(as_float(silence));
}

live::Life life_of(const FleetView& view, bool replayed, WallTime now) {
  const Life state = view.life(now);
  live::Life life;
  life.set_state(static_cast<live::Life::State>(state));
  if (state == Life::silent) life.set_heard(view.heard());
  life.set_robots(count(view.robots().size()));
  const auto has_arrived = [](const SeenRobot& robot) { return phase_of(robot) == Phase::arrived; };
  life.set_arrived(static_cast<std::uint32_t>(std::ranges::count_if(view.robots(), has_arrived)));
  life.set_replayed(replayed);
  return life;
}

/// Makes the next edition, if the message has changed.
void renew(Edition& edition, const live::ToPage& message) {
  Payload bytes = encoded(message);
  if (edition.bytes && *edition.bytes == *bytes) return;
  edition = {edition.number + 1, std::move(bytes)};
}

}  // namespace

Payload encoded(const live::ToPage& message) {
  return std::make_shared<const std::string>(message.SerializeAsString());
}

live::Frame frame_of(const FleetView& view, const Point2& origin, WallTime now) {
  const double time = view.fleet_time(now).value_or(0);
  live::Frame frame;
  frame.set_time(time);
  for (const SeenRobot& robot : view.robots()) {
    if (robot.state) {
      add_robot(frame, view, robot, origin, time, unheard_for(robot, now));
    } else {
      add_unheard(frame, unheard_for(robot, now));
    }
  }
  return frame;
}

LiveStream::LiveStream(std::string source, bool recorded, bool controlled)
    : frame_rhythm_(frame_period), slow_rhythm_(beat_period), figures_rhythm_(figures_period) {
  live::ToPage message;
  live::Begin& begin = *message.mutable_begin();
  begin.set_version(COPPICE_VERSION);
  begin.set_source(std::move(source));
  begin.set_recorded(recorded);
  begin.set_controlled(controlled);
  begin_ = encoded(message);
}

void LiveStream::begin_anew() {
  ++run_;
  run_of_view_.reset();
  forget();
}

void LiveStream::forget() {
  robots_ = 0;
  map_id_.clear();
  map_.bytes.reset();
  roster_.bytes.reset();
  frame_.bytes.reset();
  alarms_.bytes.reset();
  statuses_.clear();
  figures_.clear();
  figures_dropped_ = 0;
}

void LiveStream::show(const live::Playback& playback) {
  live::ToPage message;
  *message.mutable_playback() = playback;
  renew(playback_, message);
}

void LiveStream::look(const FleetView& view, WallTime now, WallTime present, const AlarmBoard& alarms) {
  at_ = now;
  if (run_of_view_ && *run_of_view_ != view.run()) begin_anew();
  run_of_view_ = view.run();
  const Point2 origin = view.map() ? view.map()->map.origin : Point2::Zero();
  if (origin != origin_) begin_anew();
  origin_ = origin;
  look_at_map(view);
  const bool is_due = slow_rhythm_.due(present);
  slow_tick_ += is_due;
  // A frame has an entry for each robot of the roster, so with a new robot both are made at once.
  const bool other_robots = robots_ != view.robots().size();
  if (is_due || other_robots) look_at_roster(view);
  if (is_due) {
    look_at_statuses(view);
    look_at_alarms(view, alarms);
    live::ToPage beat;
    beat.mutable_beat()->set_at(present);
    renew(beat_, beat);
  }
  if (figures_rhythm_.due(now) && !view.robots().empty()) look_at_figures(view);
  const bool frame_is_due = frame_rhythm_.due(present) || other_robots;
  if (!frame_is_due || view.robots().empty()) return;
  live::ToPage message;
  *message.mutable_frame() = frame_of(view, origin_, now);
  *message.mutable_frame()->mutable_life() = life_of(view, replayed_, now);
  renew(frame_, message);
}

void LiveStream::look_at_map(const FleetView& view) {
  if (!view.map() || view.map()->map_id == map_id_) return;
  map_id_ = view.map()->map_id;
  live::ToPage message;
  *message.mutable_map() = map_of(*view.map());
  renew(map_, message);
}

void LiveStream::look_at_roster(const FleetView& view) {
  robots_ = view.robots().size();
  if (robots_ == 0) return;
  live::ToPage message;
  for (const SeenRobot& robot : view.robots()) *message.mutable_roster()->add_robots() = robot_of(robot);
  renew(roster_, message);
}

void LiveStream::look_at_statuses(const FleetView& view) {
  const double time = view.fleet_time(at_).value_or(0);
  statuses_.resize(view.robots().size());
  for (std::size_t k = 0; k < statuses_.size(); ++k) {
    if (!view.robots()[k].status) continue;
    live::Statuses::Status status = status_of(k, view.robots()[k], time);
    RobotStatus& known = statuses_[k];
    if (known.changed > 0 && known.status.SerializeAsString() == status.SerializeAsString()) continue;
    known = {slow_tick_, std::move(status)};
  }
}

void LiveStream::look_at_alarms(const FleetView& view, const AlarmBoard& board) {
  live::ToPage message;
  live::Alarms& all = *message.mutable_alarms();
  for (const Alarm& alarm : board.alarms()) {
    live::Alarms::Alarm& one = *all.add_alarms();
    one.set_kind(std::string(alarm_names.at(static_cast<std::size_t>(alarm.kind))));
    const auto robot = alarm.robot.empty() ? std::nullopt : view.find(alarm.robot);
    one.set_robot(robot ? static_cast<std::int32_t>(*robot) : -1);
    one.set_since(alarm.since);
    one.set_text(alarm.text);
  }
  renew(alarms_, message);
}

void LiveStream::look_at_figures(const FleetView& view) {
  figures_.push_back(point_of(view.figures(at_)));
  if (figures_.size() <= most_figures) return;
  figures_.pop_front();
  ++figures_dropped_;
}

}  // namespace coppice
