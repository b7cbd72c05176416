#include "planner_service/run/planner_service.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "planner_service/timing.h"

namespace coppice {

namespace {

constexpr double whole_map = 1e6;                      // metres
constexpr double slowest = 1e-6;                       // metres a second: a slower robot stands
constexpr double largest_clock_error = 3600;           // fleet seconds
constexpr std::size_t most_track_points = 20'000'000;  // of a robot, that the report needs: eleven days

/// Names a map, and the margin that is kept on it, by its content (FNV-1a), so that two runs on one domain
/// cannot mix up their trees.
std::string content_id(const OccupancyMap& map, double margin) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](std::uint8_t byte) { hash = (hash ^ byte) * 0x100000001b3u; };
  for (const char c : fmt::format("{} {} {} {} {} {}", map.width, map.height, map.resolution, map.origin.x(),
                                  map.origin.y(), margin)) {
    add(static_cast<std::uint8_t>(c));
  }
  for (const std::uint8_t cell : map.blocked) add(cell);
  return fmt::format("{:016x}", hash);
}

NextGoal next_goal(const RosGoal& goal, YAxis y_axis) {
  NextGoal next{turned(goal.position, y_axis)};
  if (goal.yaw) next.yaw = y_axis == YAxis::up ? *goal.yaw : -*goal.yaw;
  return next;
}

}  // namespace

PlannerService::PlannerService(Scenario scenario, const ServiceSettings& settings, WallTime now,
                               TrackRecord tracks)
    : scenario_(std::move(scenario)),
      settings_(settings),
      map_id_(content_id(scenario_.map, scenario_.margin)),
      robots_(scenario_.robots),
      liveliness_(robots_.size(), now),
      tracks_(std::move(tracks)),
      counted_(scenario_.robots),
      goals_(scenario_),
      orders_(names_of(scenario_)),
      intake_(now),
      phase_(WaitingForTrees{now}) {
  for (RobotRecord& robot : robots_) {
    if (const RobotPose* const start = pose_of(settings_.starts, robot.task.name))
      robot.begins_at(start->position, start->yaw, goals_.field());
  }
  if (!settings_.waits_for_goals) return;
  roadmap_ = std::make_unique<const VoronoiRoadmap>(goals_.field());
  counting_field_ = std::make_unique<const ClearanceField>(scenario_.map);
}

std::optional<RunId> PlannerService::run() const {
  const FleetClock* const clock = clock_of(phase_);
  return clock == nullptr ? std::nullopt : std::optional(clock->run());
}

void PlannerService::interrupt() {
  map_due_ = false;
  coppice::interrupt(phase_);
}

bool PlannerService::finished() const {
  return std::holds_alternative<Finished>(phase_) || std::holds_alternative<NeverBegan>(phase_);
}

void PlannerService::on(const Arrival& arrival) {
  const auto* const order = std::get_if<OrderMessage>(arrival.message.get());
  const bool is_outdated =
      order != nullptr && !orders_.knows(order->id) && !intake_.takes(*order, arrival.at, arrival.sent);
  if (is_outdated) return;
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, arrival.at); }) receive(m, arrival.at);
      },
      *arrival.message);
}

/// Null: the message is not of the present run.
template <class M>
RobotRecord* PlannerService::find_in_run(const M& message) {
  const std::optional<RunId> present = run();
  return present && is_of_run(message, *present) ? robots_.find(message.robot) : nullptr;
}

/// Null: the message is not of the robot's present mission.
template <class M>
RobotRecord* PlannerService::find_in_mission(const M& message) {
  RobotRecord* const robot = find_in_run(message);
  return robot != nullptr && message.mission == robot->mission ? robot : nullptr;
}

void PlannerService::receive(const AgentStatus& status, WallTime now) {
  RobotRecord* const known = robots_.find(status.robot);
  if (known == nullptr) return;
  liveliness_.heard(known->index, now);
  known->trees_received = status.trees_received;
  if (std::holds_alternative<WaitingForTrees>(phase_)) step_at_once();
  if (RobotRecord* const robot = find_in_mission(status)) robot->update(status, has_ended(phase_));
}

void PlannerService::receive(const BrokerStatus& status, WallTime) {
  if (!forest_.add(status)) return;
  auto* const waiting = std::get_if<WaitingForTrees>(&phase_);
  if (waiting == nullptr) return;
  if (!waiting->trees && status.covered_map == map_id_) waiting->trees = status.trees_published;
  step_at_once();
}

void PlannerService::receive(const PathMessage& path, WallTime) {
  if (RobotRecord* const robot = find_in_mission(path)) robot->update(path);
}

/// A robot that still brakes is where it is now.
void PlannerService::complete(TrackMessage rest, WallTime now) {
  const FleetClock* const clock = clock_of(phase_);
  if (clock == nullptr) return;
  const double fleet_now = clock->fleet_time(now);
  std::erase_if(rest.points, [&](const TrackMessage::Point& point) { return point.time > fleet_now; });
  receive(rest, now);
}

bool PlannerService::was_never_seen(const RobotRecord& robot) const {
  return std::holds_alternative<NoTrack>(robot.track) && !tracks_.last(robot.index);
}

void PlannerService::receive(const TrackMessage& batch, WallTime now) {
  RobotRecord* const known = find_in_run(batch);
  if (known == nullptr) return;
  const std::size_t robot = known->index;
  // The report looks at each second between the first point and the last. A clock that is wrong by more than
  // `largest_clock_error` would make that too many.
  const double fleet_now = clock_of(phase_)->fleet_time(now);
  const bool fits = batch.points.empty() || (batch.points.front().time >= -largest_clock_error &&
                                             batch.points.back().time <= fleet_now + largest_clock_error);
  if (!fits || tracks_.held(robot) + batch.points.size() > most_track_points) return;
  if (settings_.waits_for_goals && !batch.points.empty() && was_never_seen(*known)) {
    known->stands_at(batch.points.front().position, batch.points.front().yaw, goals_.field());
    if (known->task.stands_at) counted_.drive_out.insert(robot);
  }
  if (batch.first_index == 0 && !batch.points.empty() && known->track_begins(batch.points.front().time)) {
    if (BegunRun* const run = run_of(phase_)) run->missions_due = true;  // that of this robot as cancelled
    step_at_once();
  }
  if (known->track_lost()) return;
  if (batch.first_index > known->next_point) known->points_missing += batch.first_index - known->next_point;
  for (std::uint32_t i = 0; i < batch.points.size(); ++i) {
    // Reliable delivery brings each point in order. A restarted agent repeats points, which are skipped like
    // points that go back in time. A service that was away for long finds a gap.
    if (batch.first_index + i < known->next_point) continue;
    known->next_point = batch.first_index + i + 1;
    const TrackMessage::Point& point = batch.points[i];
    const auto last = tracks_.last(robot);
    if (last && point.time < last->time) continue;
    // A snapshot begins with the last point that was counted.
    if (last && point.time < counted_until_) ++known->points_missing;
    tracks_.append(robot, {point.time, point.position, point.velocity, point.yaw, point.angular_velocity});
  }
}

void PlannerService::receive(const RootNodes& batch, WallTime) {
  if (RobotRecord* const robot = find_in_mission(batch)) robot->add(batch);
}

void PlannerService::receive(const InactiveTreesMessage& trees, WallTime) {
  if (trees.map_id == map_id_) forest_.add(trees);
}

MapMessage PlannerService::map() const {
  MapMessage message{
      .map_id = map_id_, .map = scenario_.map, .trees = settings_.trees, .margin = scenario_.margin};
  if (!grows_ahead()) return message;
  for (const RobotTask& task : scenario_.robots) {
    const double radius = driving_radius(task);
    if (std::ranges::count(message.radii, radius) == 0) message.radii.push_back(radius);
  }
  return message;
}

bool PlannerService::grows_ahead() const {
  return settings_.planner == PlannerKind::ma_rrdt_star && settings_.forest == ForestStart::ahead;
}

Mission PlannerService::mission_of(const RobotRecord& robot) const {
  return {.robot = robot.task.name,
          .number = robot.mission,
          .fleet_size = static_cast<std::uint32_t>(robots_.size()),
          .map_id = map_id_,
          .start = body_begins_at(robot.task),
          .goal = robot.task.goal,
          .radius = reference_radius(robot.task),
          .max_speed = robot.task.max_speed,
          .max_acceleration = robot.task.max_acceleration,
          .goal_tolerance = robot.task.goal_tolerance,
          .seed = scenario_.seed * 1'000'003ull + robot.index + 7919ull * (robot.mission - 1),
          .planner = settings_.planner,
          .trees = settings_.trees,
          .plan_budget = settings_.plan_budget,
          .cancelled = has_ended(phase_) || robot.track_lost(),
          .clock = *clock_of(phase_),
          .max_angular_speed = robot.task.max_angular_speed,
          .max_angular_acceleration = robot.task.max_angular_acceleration,
          .start_yaw = robot.task.start_yaw,
          .goal_yaw = robot.task.goal_yaw,
          .goal_yaw_tolerance = robot.task.goal_yaw_tolerance,
          .tracking_tolerance = robot.task.tracking_tolerance,
          .footprint = robot.task.footprint,
          .coordination = settings_.coordination,
          .starts_where_it_stands =
              settings_.waits_for_goals && !settings_.starts_are_given && !tracks_.last(robot.index)};
}

void PlannerService::publish_missions(std::vector<Message>& out) const {
  for (const RobotRecord& robot : robots_) out.emplace_back(mission_of(robot));
  if (!settings_.plan.empty() && !has_ended(phase_)) out.emplace_back(given_plan());
}

/// The plan as that of a first round of the whole fleet.
JointPlanMessage PlannerService::given_plan() const {
  JointPlanMessage message{.round = {.epoch = 1,
                                     .leader = service_as_leader,
                                     .centre = scenario_.robots[0].start,
                                     .reach = whole_map},
                           .members = {},
                           .run = clock_of(phase_)->run()};
  for (std::size_t k = 0; k < settings_.plan.size(); ++k) {
    const RobotTask& robot = scenario_.robots[k];
    message.members.push_back({.robot = robot.name,
                               .radius = reference_radius(robot),
                               .trajectory = shifted(settings_.plan[k], service_timing.plans_begin)});
  }
  return message;
}

std::vector<Message> PlannerService::step(WallTime now) {
  std::vector<Message> out;
  if (std::exchange(map_due_, false)) out.emplace_back(map());
  if (const auto* const waiting = std::get_if<WaitingForTrees>(&phase_)) begin_when_ready(*waiting, now);
  if (BegunRun* const run = run_of(phase_); run != nullptr && std::exchange(run->missions_due, false)) {
    publish_missions(out);
    orders_.publish_again();
  }
  if (!has_ended(phase_)) {
    std::vector<AgentStage> stages;
    for (const RobotRecord& robot : robots_) stages.push_back(stage_of(robot));
    liveliness_.step(stages, now);
  }
  if (std::holds_alternative<Running>(phase_)) continue_run(out, now);
  if (const auto* const collecting = std::get_if<CollectingTracks>(&phase_))
    finish_when_complete(*collecting, now);
  next_wake_ = now + service_timing.step_interval;
  return out;
}

void PlannerService::begin_when_ready(const WaitingForTrees& waiting, WallTime now) {
  if (waiting.interrupted) {
    phase_ = NeverBegan{waiting.since};
  } else if (!grows_ahead() || (waiting.trees && every_agent_has(*waiting.trees)) ||
             now - waiting.since >= service_timing.longest_wait_for_trees) {
    phase_ = Running{.run = {.clock = {now, settings_.time_scale}}};
  }
}

bool PlannerService::every_agent_has(std::uint32_t trees) const {
  return std::ranges::all_of(robots_, [&](const RobotRecord& robot) {
    return robot.trees_received >= trees;  // no status is less than any number
  });
}

void PlannerService::continue_run(std::vector<Message>& out, WallTime now) {
  assign_requested_goals(out, now);
  serve_orders(out, now);
  assign_drawn_goals(out, now);
  count_tracks(now);
  if (const auto end = end_of_run(now)) {
    phase_ = CollectingTracks{std::get<Running>(phase_).run, *end, now};
    orders_.close("the fleet has ended", now);
    std::ranges::move(orders_.take_news(), std::back_inserter(out));
    publish_missions(out);  // as cancelled
  }
}

std::optional<RunEnd> PlannerService::end_of_run(WallTime now) const {
  if (was_interrupted(phase_)) return RunEnd::interrupted;
  if (settings_.waits_for_goals) return std::nullopt;
  if (clock_of(phase_)->fleet_time(now) > settings_.timeout) return RunEnd::timed_out;
  const bool all =
      std::ranges::all_of(robots_, [&](const RobotRecord& robot) { return is_done(robot, now); });
  return all ? std::optional(RunEnd::all_done) : std::nullopt;
}

void PlannerService::finish_when_complete(const CollectingTracks& collecting, WallTime now) {
  double braking = 0;  // wall seconds
  for (const RobotTask& task : scenario_.robots)
    braking = std::max(braking, braking_time(limits_of(task)) / settings_.time_scale);
  const WallTime patience = service_timing.longest_wait_for_tracks + braking;
  const WallTime from = std::max(collecting.since, collecting.run.rediscovered_by);
  if (tracks_complete() || now > from + patience) phase_ = Finished{collecting.run.clock, collecting.end};
}

/// After the end every agent says in its last status how many points its track has. The robot stands at the
/// last of them.
bool PlannerService::tracks_complete() const {
  return std::ranges::all_of(robots_, [&](const RobotRecord& robot) {
    if (liveliness_.is_lost(robot.index) || robot.track_lost() || !robot.status) return true;
    const auto last = tracks_.last(robot.index);
    return robot.stopped() && robot.next_point >= robot.status->track_points && (!last || stands(*last));
  });
}

std::vector<RoomOfRobot> PlannerService::rooms() const {
  std::vector<RoomOfRobot> rooms;
  for (const RobotRecord& robot : robots_) {
    rooms.push_back({&robot.task, std::nullopt});
    if (drives_on(robot)) continue;
    if (const auto last = tracks_.last(robot.index)) rooms.back().stays_at = last->position;
  }
  return rooms;
}

std::optional<std::string> PlannerService::on(const RosGoal& goal) {
  const RobotRecord* const robot = robots_.find(goal.robot);
  if (robot == nullptr) return "it is for no robot of this run";
  auto problem = problem_with(goal, settings_.map_frame);
  if (!problem && has_ended(phase_)) problem = "the run has ended";
  if (!problem) problem = goals_.request(robot->index, next_goal(goal, scenario_.map.y_axis), rooms());
  if (problem) {
    ++goals_refused_;
  } else {
    step_at_once();
  }
  return problem;
}

/// A robot that is under way drives to the requested goal from its position.
void PlannerService::assign_requested_goals(std::vector<Message>& out, WallTime now) {
  for (RobotRecord& robot : robots_) {
    const auto goal = goals_.take_request(robot.index);
    if (!goal) continue;
    orders_.take_robot(robot.index, "a goal over ROS has replaced it", now);
    send(robot, *goal, out);
  }
}

void PlannerService::send(RobotRecord& robot, const NextGoal& goal, std::vector<Message>& out) {
  begin_next_mission(robot, robot.arrived() ? robot.task.goal : place_of(robot), goal);
  out.emplace_back(mission_of(robot));
}

void PlannerService::assign_drawn_goals(std::vector<Message>& out, WallTime now) {
  if (was_interrupted(phase_) || clock_of(phase_)->fleet_time(now) >= settings_.lifelong) return;
  for (RobotRecord& robot : robots_) {
    if (!goals_.may_draw(robot.index, now) || !robot.arrived()) continue;
    if (const auto goal = goals_.draw(robot.index, rooms(), now)) {
      send(robot, {*goal}, out);
    }
  }
}

void PlannerService::begin_next_mission(RobotRecord& robot, const Point2& start, const NextGoal& goal) {
  robot.begin_next_mission(start, goal);
  goals_.clear_shortage(robot.index);
}

std::vector<std::string> PlannerService::robots_without_goal() const {
  std::vector<std::string> lines;
  for (const RobotRecord& robot : robots_) {
    const std::string& shortage = goals_.shortage_of(robot.index);
    if (!shortage.empty()) lines.push_back(robot.task.name + " " + shortage);
  }
  return lines;
}

/// By the track: the robot stands within the tolerances of its goal.
bool PlannerService::is_at_goal(const RobotRecord& robot, const std::optional<TrackPoint>& last) const {
  return !robot.track_lost() && last && stands(*last) && is_on_goal(robot.task, *last);
}

/// The odometry of a robot that a motor controller drives never says quite zero.
bool PlannerService::stands(const TrackPoint& point) const {
  return settings_.robots_elsewhere || point.velocity.norm() <= slowest;
}

/// False: the robot stays where it is, unless another one needs the room.
bool PlannerService::drives_on(const RobotRecord& robot) const {
  return !liveliness_.is_lost(robot.index) && !robot.track_lost() && !robot.has_no_way();
}

/// The run does not wait for it. A lost robot may only be cut off or paused, so the run waits for it for
/// `longest_cut_off`, unless it is told to stop.
bool PlannerService::is_done(const RobotRecord& robot, WallTime now) const {
  const bool gone = liveliness_.is_lost(robot.index) &&
                    (stage_of(robot) != AgentStage::active ||
                     liveliness_.silence(robot.index, now) > service_timing.longest_cut_off);
  return gone || robot.track_lost() || robot.arrived() || (robot.has_no_way() && !robot.halted());
}

AgentStage PlannerService::stage_of(const RobotRecord& robot) const {
  if (!robot.status) return AgentStage::expected;
  return robot.stopped() ? AgentStage::stopped : AgentStage::active;
}

bool PlannerService::everybody_arrived() const {
  return std::ranges::all_of(
      robots_, [&](const RobotRecord& robot) { return is_at_goal(robot, tracks_.last(robot.index)); });
}

Progress PlannerService::progress(WallTime now) const {
  const FleetClock* const clock = clock_of(phase_);
  Progress progress{.robots = static_cast<int>(robots_.size()),
                    .elapsed = clock != nullptr ? clock->fleet_time(now) : 0};
  for (const RobotRecord& robot : robots_) {
    progress.planned += !robot.path.empty();
    progress.arrived += robot.status && robot.status->arrival_time > 0;
    progress.missions += static_cast<int>(robot.missions_fulfilled(robot.arrived()));
    if (robot.status) progress.nodes += robot.status->nodes_valid;
  }
  progress.nodes += forest_.nodes().valid;
  progress.periods_missed = share_of_periods_missed(robots_);
  return progress;
}

TrackParts PlannerService::tracks() const {
  return [this](const std::function<void(const TrackPart&)>& fn) {
    tracks_.for_each_stretch([&](double from, double until) { fn(part_of_tracks(from, until)); },
                             counted_until_);
  };
}

TrackPart PlannerService::part_of_tracks(double from, double until) const {
  TrackPart part{from, until, {}};
  for (const RobotRecord& robot : robots_)
    part.tracks.push_back({robot.task.name, {robot.task.radius, tracks_.around(robot.index, from, until)}});
  return part;
}

}  // namespace coppice
