// Part of class Run: missions, and the paths to their goals.
#include "robot_agent/control/run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "coppice/files/scenario.h"
#include "messages/validation.h"
#include "planning/geometry/free_way.h"
#include "planning/geometry/way_out.h"
#include "planning/quantities.h"
#include "planning/trees/suggestions.h"
#include "robot_agent/control/words.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

constexpr WallTime pause_between_improvements = 0.001;
constexpr std::size_t most_vertices = 4'000;  // of the improver's roadmap: some megabytes
constexpr int improvements_a_step = 4;        // bounded pieces of work, some hundred microseconds together
constexpr double worth_swapping = 0.005;      // of what is left to drive

/// A body that stands where the mission begins.
Driver body_at_start(const Mission& mission, double now) {
  const double begin = std::max(0.0, std::ceil(now / control_period) * control_period);
  return {mission.start, begin, mission.radius, limits_of(mission), control_period, mission.start_yaw};
}

/// None: no robot follows the body.
std::optional<Tracking> tracking_of(const AgentProcess& process, const Mission& mission) {
  if (!process.tracking) return std::nullopt;
  const double robots_speed = mission.clock.scale * mission.max_speed / Tracking::share_of_speed;
  return Tracking(*process.tracking, mission.tracking_tolerance, robots_speed);
}

}  // namespace

/// The state that a process before this one saved serves one mission. It is of use in its own run alone.
std::optional<SavedState> Run::take_saved_state(AgentProcess& process, const Mission& mission) {
  std::optional<SavedState> saved = std::exchange(process.saved_state, std::nullopt);
  if (!is_of_run(saved, mission)) saved.reset();
  return saved;
}

Run::Run(AgentProcess& process, Fleet& fleet, const Reservations& others, const Mission& mission,
         const std::optional<SavedState>& saved, WallTime now)
    : process_(process),
      fleet_(fleet),
      mission_(mission),
      tracking_(tracking_of(process, mission)),
      body_(saved ? saved->body : body_at_start(mission, mission.clock.fleet_time(now))),
      round_(process.name),
      reserver_(process.name, mission.clock.run(), others) {
  const double fleet_now = mission_.clock.fleet_time(now);
  begin(mission, fleet_now);
  begun_at_ = now;
  if (saved) {
    go_on_from(*saved, fleet_now);
  } else if (fleet_.is_under_way(fleet_now)) {
    join_in_mid_run({}, fleet_now);
  }
  set_out(fleet_now);
}

void Run::go_on_from(const SavedState& saved, double now) {
  track_ = TrackLog(saved.track, saved.first_index);
  if (tracking_ && !track_.empty()) last_seen_ = track_.last().time;
  counter_ = StateCounter(saved.sequence);
  timing_.first = false;
  round_.forget(saved.round_epoch);
  join_in_mid_run(saved.silent, now);
  const AgentStatus& before = saved.status;
  if (before.mission != mission_.number) return;
  status_.mission_time = before.mission_time;
  status_.path_time = before.path_time;
  status_.plan_seconds = before.plan_seconds;
  status_.improve_seconds = before.improve_seconds;
  if (before.phase == Phase::arrived || before.phase == Phase::stopped)
    status_.arrival_time = before.arrival_time;
  status_.driven_length = saved.driven_length;
  status_.waits = before.waits;
}

/// The robot stands until it has heard of the others: they may be anywhere by now.
void Run::join_in_mid_run(std::span<const Heard> silent, double now) {
  fleet_.begin_anew(silent, now);
  connectivity_.join(now + listening_time());
  reserver_.begin_anew(fleet_, body_.time(), now);
}

void Run::take_up(const Mission& mission, WallTime now) {
  const double fleet_now = mission.clock.fleet_time(now);
  begin(mission, fleet_now);
  begun_at_ = now;
  set_out(fleet_now);
}

/// All that belongs to a mission begins anew.
void Run::begin(const Mission& mission, double now) {
  const bool is_newest = process_.newest_map && process_.newest_map->map_id == mission.map_id;
  if (const auto map = is_newest ? process_.newest_map : map_; map != map_) {
    task_ = Impossible{};  // its finder, the joint planner and the improver look at the old map
    round_ = CoordinationRound(process_.name);
    improver_.reset();
    map_ = map;
  }
  status_ = AgentStatus{.robot = process_.name,
                        .mission = mission.number,
                        .reason = {},
                        .mission_time = now,
                        .run = mission.clock.run(),
                        .came_on_at = now};
  mission_ = mission;
  // A robot without a goal of its own stays where it stands, or where it has room beside that.
  if (mission.goal == mission.start)
    mission_.goal = room_near(mission.start, mission.radius).value_or(mission.goal);
  startup_since_ = now;
  came_to_ = body_.position();
  times_stranded_ = 0;
  round_.forget_failures();
}

void Run::set_out(double now) {
  if (mission_.cancelled) {
    // No other process has the end of the track, however long ago that was driven.
    round_.leave();
    return enter(Stopped{std::max(body_.time(), now)});
  }
  if (const auto out = way_off_the_wall()) return enter(DrivingOut{*out});
  if (const char* const problem = problem_with_task()) {
    status_.path_time = now;
    status_.reason = problem;
    return enter(Impossible{});
  }
  look_for_a_path();
}

/// As the service reckons (files/robot_starts.h).
std::optional<Point2> Run::room_near(const Point2& place, double radius) const {
  const double most = start_tolerance(mission_.goal_tolerance, mission_.radius) +
                      mission_.tracking_tolerance + map_->field.inflation();
  return way_out(map_->field, place, radius, most);
}

/// None: the robot has room where it is, or too little.
std::optional<Point2> Run::way_off_the_wall() const {
  if (map_->field.is_free(body_.position(), body_.radius() - driving_rounding)) return std::nullopt;
  return room_near(body_.position(), driving_radius(body_.radius(), body_.limits()));
}

/// Null if the map leaves room for start and goal, and the mission for a robot that follows.
const char* Run::problem_with_task() const {
  if (tracking_ && tracking_->tolerance() == 0)
    return "no path: its robot may not be off it at all: start the planner service with --drive ros";
  if (!map_->field.is_free(body_.position(), body_.radius() - driving_rounding))
    return "no path: the start is inside of an obstacle, or not on the map";
  if (!map_->field.is_free(mission_.goal, mission_.radius))
    return "no path: the goal is inside of an obstacle, or not on the map";
  return nullptr;
}

/// The robot's last wait cause tells why it is not at its goal. The others may have been stopped before it.
void Run::stop() {
  if (stopped()) return;
  if (is_under_way() && status_.reason.empty() && !status_.wait_cause.empty())
    status_.reason = bounded(fmt::format("since {:.1f} s: {}", status_.came_on_at, status_.wait_cause));
  round_.leave();
  enter(Stopped{body_.time()});
}

void Run::stop(const std::string& reason) {
  if (status_.reason.empty()) status_.reason = reason;
  stop();
}

void Run::hear(std::shared_ptr<const JointPlanMessage> plan) {
  // A plan of an earlier run is of robots elsewhere: its leader's writer still sends it to late readers.
  if (!is_of_run(*plan, mission_.clock.run())) return;
  if (const auto leader = fleet_.find(plan->round.leader); leader && !leader->failed)
    fleet_.learn_from(*plan, leader->clock_offset - leader->clock_error);
  if (takes_part()) round_.hear(std::move(plan));
}

void Run::hear(const InactiveTreesMessage& trees) {
  auto* const planning = std::get_if<Planning>(&task_);
  if (planning != nullptr && map_->map_id == trees.map_id) planning->finder->take(trees);
}

/// The track of a robot that follows the body is where it was seen, once a control period.
void Run::see(const OdometrySample& robot) {
  if (!tracking_) return;
  const FleetClock& clock = mission_.clock;
  const double time = clock.fleet_time(robot.at);
  const double since = time - body_.time();
  const bool turns = is_differential(body_.limits());
  tracking_->see(robot, body_.position() + since * body_.velocity(),
                 turns ? body_.yaw() + since * body_.angular_velocity() : robot.yaw);
  if (time < last_seen_ + control_period) return;
  last_seen_ = time;
  if (records(time))
    track_.add({time, robot.position, robot.velocity / clock.scale, robot.yaw,
                robot.angular_velocity / clock.scale});
}

/// The reference has decided what it does while a command takes effect. A drive with a lag follows a command
/// that leads by the lag times the acceleration.
DriveCommand Run::command(WallTime now) {
  if (!tracking_) return {};
  const double scale = mission_.clock.scale;
  const Promise next = body_.promise();
  const bool is_next = mission_.clock.fleet_time(now + Tracking::lead) >= next.decision_time;
  const double ahead = Tracking::usual_lag * scale / control_period;
  const Point2 faster_by = ahead * (next.next_velocity - next.velocity);
  const double turns_faster_by = ahead * (next.next_angular_velocity - next.angular_velocity);
  const Twist reference{
      scale * ((is_next ? next.next_velocity : next.velocity) + faster_by),
      scale * ((is_next ? next.next_angular_velocity : next.angular_velocity) + turns_faster_by)};
  const double faster = scale / Tracking::share_of_speed;
  const double harder = scale * scale / Tracking::share_of_acceleration;
  const Limits limits{.max_speed = faster * mission_.max_speed,
                      .max_acceleration = harder * mission_.max_acceleration,
                      .max_angular_speed = faster * mission_.max_angular_speed,
                      .max_angular_acceleration = harder * mission_.max_angular_acceleration};
  return tracking_->command(reference, limits, rest_of_its_robot(), now);
}

/// Where the robot that follows the body is to rest while the body stands.
Rest Run::rest_of_its_robot() const {
  constexpr double anywhere = std::numeric_limits<double>::infinity();
  constexpr double while_arriving = 0.8;  // of where it has arrived
  constexpr double in_the_end = 1.4;      // the same: noise must not make it turn away
  const bool is_there = (body_.position() - mission_.goal).norm() <= arrives_within(mission_);
  if (is_under_way() && !(is_there && driving())) return {anywhere, anywhere};
  const double share = is_under_way() ? while_arriving : in_the_end;
  return {share * arrives_within(mission_), share * yaw_arrives_within()};
}

double Run::yaw_arrives_within() const {
  return mission_.goal_yaw_tolerance > 0 ? mission_.goal_yaw_tolerance / 2 : std::numbers::pi;
}

/// The robot that follows the body is where the body is, and heads as it does.
bool Run::its_robot_is_there(double now) {
  return tracking_->rests_within(arrives_within(mission_), yaw_arrives_within(),
                                 mission_.clock.wall_time(now));
}

void Run::step(WallTime now, std::vector<Outgoing>& out) {
  control(mission_.clock.fleet_time(now), out);
  // Numbers of reservations grow with fleet time, which is below 0 where the clock is behind. A process that
  // has said no state yet may be killed, and the next one would use its numbers again.
  if (!timing_.first) reserve(mission_.clock.fleet_time(now), out);
  if (std::holds_alternative<Planning>(task_)) {
    plan(now, out);
  } else if (Route* const route = route_of(task_); route != nullptr && route->improvement) {
    improve(*route, now, out);
  }
}

WallTime Run::next_wake(WallTime now) const {
  const WallTime next_control =
      mission_.clock.wall_time(body_.time() + periods_to_next_control() * control_period);
  if (const auto* planning = std::get_if<Planning>(&task_))
    return std::min(next_control, now + (planning->found ? 0 : planning->finder->pause()));
  const Route* const route = route_of(task_);
  return route != nullptr && route->improvement ? std::min(next_control, now + pause_between_improvements)
                                                : next_control;
}

PathImprover<ClearanceField>& Run::improver() {
  if (!improver_ || improver_radius_ != mission_.radius) {
    improver_radius_ = mission_.radius;
    improver_ = std::make_unique<PathImprover<ClearanceField>>(
        map_->field, suggested_epsilon(map_->field, improver_radius_), Random(mission_.seed + 1),
        most_vertices);
  }
  return *improver_;
}

/// Back along the trail to where the robot last saw its path, and on along the path; empty if there is no
/// room for that.
Path Run::way_back_to_the_path(const Route& route) const {
  Path way = trail_.back();
  const Path rest = route.follower.rest();
  way.insert(way.end(), rest.begin(), rest.end());
  for (std::size_t k = 1; k < way.size(); ++k) {
    if (!way_free(map_->field, way[k - 1], way[k], body_.radius())) return {};
  }
  return way;
}

/// From where the robot is to the mission's goal. `known`: a path that is there already, perhaps a long one.
void Run::look_for_a_path(Path known) {
  trail_.begin(body_.position());
  task_ = Impossible{};  // the finder before this one looks at an improver that may be replaced
  auto finder =
      std::make_unique<PathFinder>(map_->field, improver(), mission_, body_.position(), std::move(known));
  for (const auto& [id, trees] : process_.trees.messages()) {
    if (trees.map_id == map_->map_id) finder->take(trees);
  }
  enter(Planning{std::move(finder)});
}

/// The next step takes what a step has found: so its time counts what the search took.
void Run::plan(WallTime now, std::vector<Outgoing>& out) {
  auto& planning = std::get<Planning>(task_);
  if (planning.found) return take_result(*std::move(planning.found), std::move(planning.finder), now, out);
  planning.found = planning.finder->step();
  if (const auto batch = planning.finder->take_root_nodes()) out.emplace_back(*batch);
}

void Run::take_result(PathFinder::Result result, std::unique_ptr<PathFinder> finder, WallTime now,
                      std::vector<Outgoing>& out) {
  status_.nodes_valid = finder->counts().valid;
  status_.nodes_invalid = finder->counts().invalid;
  status_.trees_grafted = finder->grafted_trees();
  if (status_.path_time == 0) {
    status_.path_time = mission_.clock.fleet_time(now);
    status_.plan_seconds = now - begun_at_;
  }
  if (const auto* failure = std::get_if<NoPath>(&result)) {
    status_.reason = failure->reason;
    return enter(Impossible{});
  }
  progress_.pause_stall_clock(mission_.clock.fleet_time(now));
  Route route{PathFollower(std::get<Path>(result), mission_.radius), std::move(finder), now};
  follow(route, std::get<Path>(result), out);
  enter(Driving{std::move(route)});
  // The robot may have taken up its part of a joint plan meanwhile.
  if (!leads_elsewhere()) take_reserved_path(out);
}

/// At the beginning of a run all robots look for their first paths at once, on few processors perhaps.
bool Run::others_still_search(const Route& route, WallTime now) const {
  return mission_.number == 1 && now - route.found_at < Timing::others_search && now >= route.found_at;
}

void Run::follow(Route& route, const Path& path, std::vector<Outgoing>& out) {
  out.emplace_back(PathMessage{process_.name, mission_.number, path, status_.run});
  route.follower = PathFollower(path, mission_.radius);
  progress_.begin_path();
}

/// Pulls the first path taut, before the robot has come far along it. Then looks for a shorter path while the
/// budget lasts and no robot needs the processor for its first path. Swaps to a path that the robot sees its
/// way onto, and that leaves less to drive.
void Run::improve(Route& route, WallTime now, std::vector<Outgoing>& out) {
  PathFinder& finder = *route.improvement;
  if (!finder.is_taut()) {
    if (!others_still_search(route, now)) follow(route, finder.pull_taut(), out);
    return;
  }
  const bool over =
      now > route.found_at + mission_.plan_budget || !driving() || round_.stage() != Stage::free;
  bool going = !over;
  if (going && !fleet_.somebody_plans()) {
    for (int k = 0; k < improvements_a_step && going; ++k) going = finder.improve();
    const Path& path = finder.path();
    if (length_of(path) < (1 - worth_swapping) * length_of(route.follower.path())) {
      PathFollower candidate(path, mission_.radius);
      if (candidate.look_from(body_.position(), map_->field, body_.limits()) &&
          candidate.remaining(body_.position()) <
              (1 - worth_swapping) * route.follower.remaining(body_.position())) {
        follow(route, path, out);
        status_.improve_seconds = now - route.found_at;
        status_changed_ = true;
      }
    }
  }
  if (!going) route.improvement.reset();
}

void Run::send_track(bool all, std::vector<Outgoing>& out) {
  if (!track_.empty() && (all || track_.fills_a_batch()))
    track_.send(process_.name, status_.mission, status_.run, out);
}

void Run::end_track() {
  if (!tracking_) track_.add(point_of(body_));
}

std::optional<TrackMessage> Run::rest_of_track() const {
  if (tracking_) return std::nullopt;
  TrackMessage rest = track_.rest(process_.name, status_.mission, status_.run);
  Driver body = body_;
  while (!body.stands()) {
    rest.points.push_back(point_of(body));
    body.advance();
  }
  rest.points.push_back(point_of(body));
  return rest;
}

bool Run::take_status_change() {
  auto* const stopped = std::get_if<Stopped>(&task_);
  const bool has_come_to_stand = stopped != nullptr && !track_.empty() && track_.last().velocity.isZero(0);
  if (has_come_to_stand && !std::exchange(stopped->has_said_that_it_stands, true)) status_changed_ = true;
  return std::exchange(status_changed_, false);
}

AgentStatus Run::status(WallTime now) {
  status_.phase = phase();
  const double fleet_now = mission_.clock.fleet_time(now);
  status_.wait_cause = stands_still(fleet_now) ? bounded(wait_cause(fleet_now)) : std::string();
  status_.way_left = way_left();
  status_.track_points = track_.sent();
  return status_;
}

}  // namespace coppice
