#include "planner_service/planner_service.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace coppice {

namespace {

constexpr WallTime beat = 0.1;       // seconds between looks at what has changed
constexpr WallTime agent_lease = 5;  // seconds without a status: the agent counts as lost
// The same where others fall silent with it: that looks like a network in pieces, or a machine that is too
// busy, and the record is worth the wait.
constexpr WallTime longest_split = 30;
constexpr WallTime absence = 2;      // seconds without a status that are no chance
constexpr WallTime longest_nap = 1;  // seconds between two steps: while it sleeps longer nobody is silent
// One that is lost may only be cut off, or paused, and come back: for so long a run does not end without it,
// unless it said that it was told to stop.
constexpr WallTime longest_cut = 60;
constexpr WallTime least_meeting = 10;
constexpr WallTime meeting_of_each = 0.2;
constexpr WallTime longest_wait_for_tracks = 3;  // once all stand
constexpr double slowest = 1e-6;                 // metres a second: who is slower stands
constexpr WallTime longest_wait_for_forest = 3;
constexpr double least_new_way = 0.2;  // of the diagonal of what the robot reaches, from one goal to the next
constexpr WallTime goal_draws = 1;     // seconds between two where the first found no goal
constexpr double same_beginning = 0.01;                // fleet seconds
constexpr double largest_clock_error = 3600;           // fleet seconds
constexpr std::size_t most_track_points = 20'000'000;  // of a robot: eleven days
constexpr std::size_t most_root_nodes = 1'000'000;     // of a robot, for the picture
constexpr std::size_t most_trees = 1'000'000;          // that are counted
constexpr std::size_t most_brokers = 1000;             // that a run has seen: each start is another one
// A picture with more edges than that shows nothing but ink.
constexpr std::size_t most_picture_edges = 100'000;

/// Names a map by its content (FNV-1a), so that two runs on one domain cannot mix up their trees.
std::string content_id(const OccupancyMap& map) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](std::uint8_t byte) { hash = (hash ^ byte) * 0x100000001b3u; };
  for (const char c :
       fmt::format("{} {} {} {} {}", map.width, map.height, map.resolution, map.origin.x(), map.origin.y())) {
    add(static_cast<std::uint8_t>(c));
  }
  for (const std::uint8_t cell : map.blocked) add(cell);
  return fmt::format("{:016x}", hash);
}

}  // namespace

/// By the record: stands at the end within the tolerance of the goal.
bool PlannerService::at_goal(const Robot& robot, const std::optional<TrackPoint>& last) const {
  return !robot.began_anew && last && stands(*last) &&
         (last->position - robot.task.goal).norm() <= robot.task.goal_tolerance;
}

/// What odometry says of a robot that is elsewhere is never quite zero.
bool PlannerService::stands(const TrackPoint& point) const {
  return settings_.margin > 0 || point.velocity.norm() <= slowest;
}

bool PlannerService::Robot::done(WallTime now) const {
  const bool gone = lost && (!status || was_told_to_stop() || now - last_heard > longest_cut);
  return gone || began_anew || arrived() || (status && has_no_way(status->phase));
}

PlannerService::PlannerService(Scenario scenario, const ServiceSettings& settings, WallTime now,
                               TrackRecord record)
    : scenario_(std::move(scenario)),
      settings_(settings),
      map_id_(content_id(scenario_.map)),
      random_(scenario_.seed),
      clock_{now, settings.time_scale},
      record_(std::move(record)),
      begun_(now),
      wait_for_tracks_(longest_wait_for_tracks),
      last_step_(now) {
  for (const RobotTask& task : scenario_.robots) {
    const double braking = task.max_speed / task.max_acceleration / settings.time_scale;
    wait_for_tracks_ = std::max(wait_for_tracks_, longest_wait_for_tracks + braking);
    Robot robot;
    robot.task = task;
    robot.last_heard = now;
    robot.index = order_.size();
    order_.push_back(&robots_.emplace(task.name, std::move(robot)).first->second);
  }
}

void PlannerService::on(const Arrival& arrival) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, arrival.at); }) receive(m, arrival.at);
      },
      *arrival.message);
}

/// Agents outlive the services that they drove for, and tell a new one what they said last.
bool PlannerService::is_of_this_run(WallTime run) const {
  return missions_published_ && run == clock_.epoch;
}

void PlannerService::receive(const AgentStatus& status, WallTime now) {
  const auto known = robots_.find(status.robot);
  if (known == robots_.end()) return;
  known->second.last_heard = now;
  known->second.lost = false;
  known->second.trees_received = status.trees_received;
  if (!missions_published_) next_wake_ = begun_;
  if (!is_of_this_run(status.run) || status.mission != known->second.mission) return;
  count_periods(known->second, status.load);
  AgentStatus latest = status;
  // Others whose missions are cancelled at the end may give it hope again for a moment.
  if (ended_ && latest.reason.empty() && known->second.status) latest.reason = known->second.status->reason;
  known->second.status = std::move(latest);
  // An agent that was started anew tells less of its first path.
  const auto& first = known->second.first_status;
  const bool tells_less = first && first->path_time > 0 && status.path_time != first->path_time;
  if (status.mission == 1 && !tells_less) known->second.first_status = status;
}

/// An agent's process counts from its own beginning, which may be before this run or, started anew, in it.
void PlannerService::count_periods(Robot& robot, const AgentLoad& load) {
  if (!robot.status && robot.periods == 0) {
    robot.periods_before = load.periods;
    robot.missed_before = load.periods_missed;
  }
  const std::uint32_t known = robot.periods_before + robot.periods;
  if (load.periods < known) {
    robot.periods_before = load.periods - robot.periods;
    robot.missed_before = load.periods_missed - robot.periods_missed;
  }
  robot.periods = load.periods - robot.periods_before;
  robot.periods_missed = load.periods_missed - robot.missed_before;
}

double PlannerService::share_of_periods_missed() const {
  double periods = 0;
  double missed = 0;
  for (const auto& [name, robot] : robots_) {
    periods += robot.periods;
    missed += robot.periods_missed;
  }
  return periods > 0 ? missed / periods : 0;
}

void PlannerService::receive(const BrokerStatus& status, WallTime) {
  if (brokers_.size() >= most_brokers && !brokers_.contains(status.broker)) return;
  brokers_[status.broker] = status;
  if (!forest_size_ && status.covered_map == map_id_) forest_size_ = status.trees_published;
  if (!missions_published_) next_wake_ = begun_;
}

/// One that begins elsewhere than the one before is how a robot that was pushed off its path comes back to
/// its goal: the report has the path from the start.
void PlannerService::receive(const PathMessage& path, WallTime) {
  const auto known = robots_.find(path.robot);
  if (known == robots_.end() || !is_of_this_run(path.run) || path.mission != known->second.mission) return;
  Path& last = known->second.path;
  const bool from_the_start = last.empty() || path.waypoints.empty() || path.waypoints[0] == last[0];
  if (from_the_start) last = path.waypoints;
}

void PlannerService::receive(const TrackMessage& batch, WallTime now) {
  const auto known = robots_.find(batch.robot);
  if (known == robots_.end() || !is_of_this_run(batch.run)) return;
  const std::size_t robot = known->second.index;
  // The report looks at each second between the first and the last: agents whose clocks are that far off are
  // nothing that it could tell of.
  const double fleet_now = clock_.fleet_time(now);
  const bool fits = batch.points.empty() || (batch.points.front().time >= -largest_clock_error &&
                                             batch.points.back().time <= fleet_now + largest_clock_error);
  if (!fits || record_.size(robot) + batch.points.size() > most_track_points) return;
  if (batch.first_index == 0 && !batch.points.empty())
    watch_beginning(known->second, batch.points.front().time);
  if (known->second.began_anew) return;
  for (std::size_t i = 0; i < batch.points.size(); ++i) {
    // Reliable delivery brings each once and in order; a repetition, and what goes back in time, is passed
    // over; a gap stays visible in the count.
    const auto last = record_.last(robot);
    if (batch.first_index + i < record_.size(robot) || (last && batch.points[i].time < last->time)) continue;
    record_.append(robot, {batch.points[i].time, batch.points[i].position, batch.points[i].velocity});
  }
}

/// An agent that was started anew tells its track again, from its journal. One without begins another,
/// elsewhere: that is not where its robot was, and it must not drive on.
void PlannerService::watch_beginning(Robot& robot, double begins) {
  if (!robot.track_begins) robot.track_begins = begins;
  if (robot.began_anew || std::abs(begins - *robot.track_begins) < same_beginning) return;
  robot.began_anew = true;
  says_missions_again_ = true;
  next_wake_ = begun_;
}

void PlannerService::receive(const RootNodes& batch, WallTime) {
  const auto known = robots_.find(batch.robot);
  if (known == robots_.end() || !is_of_this_run(batch.run) || batch.mission != known->second.mission) return;
  auto& nodes = known->second.root_nodes;
  if (batch.first_index == nodes.size() && nodes.size() < most_root_nodes)
    nodes.insert(nodes.end(), batch.nodes.begin(), batch.nodes.end());
}

void PlannerService::receive(const InactiveTreeMessage& tree, WallTime) {
  if (tree.map_id != map_id_ || trees_seen_.size() >= most_trees) return;
  if (!trees_seen_.insert(tree.tree).second) return;
  for (const InactiveTreeMessage::Node& node : tree.nodes) {
    if (node.parent < 0 || shared_edges_.size() >= most_picture_edges) continue;
    shared_edges_.push_back({tree.nodes[static_cast<std::size_t>(node.parent)].position, node.position, -1});
  }
}

MapMessage PlannerService::map() const {
  MapMessage message{map_id_, scenario_.map, {}};
  if (settings_.planner != PlannerKind::ma_rrdt_star) return message;
  for (const RobotTask& task : scenario_.robots) {
    const double radius = task.radius + settings_.margin;
    if (std::ranges::count(message.radii, radius) == 0) message.radii.push_back(radius);
  }
  return message;
}

Mission PlannerService::mission_of(const Robot& robot) const {
  return {.robot = robot.task.name,
          .number = robot.mission,
          .fleet_size = static_cast<std::uint32_t>(robots_.size()),
          .map_id = map_id_,
          .start = robot.task.start,
          .goal = robot.task.goal,
          .radius = robot.task.radius,
          .max_speed = robot.task.max_speed,
          .max_acceleration = robot.task.max_acceleration,
          .goal_tolerance = robot.task.goal_tolerance,
          .seed = scenario_.seed * 1'000'003ull + robot.index + 7919ull * (robot.mission - 1),
          .planner = settings_.planner,
          .plan_budget = settings_.plan_budget,
          .cancelled = ended_ || robot.began_anew,
          .clock = clock_};
}

void PlannerService::publish_missions(std::vector<Message>& out) const {
  for (const Robot* robot : order_) out.emplace_back(mission_of(*robot));
}

/// A new mission for everybody who has fulfilled the one before.
void PlannerService::give_new_goals(std::vector<Message>& out, WallTime now) {
  for (Robot* robot : order_) {
    robot->next_draw = std::min(robot->next_draw, now + goal_draws);  // the clock may have been set back
    if (!robot->arrived() || now < robot->next_draw) continue;
    if (const auto goal = draw_goal(*robot)) {
      begin_next_mission(*robot, robot->task.goal, *goal);
      out.emplace_back(mission_of(*robot));
    } else {
      goes_without_goal(*robot, now);
    }
  }
}

void PlannerService::goes_without_goal(Robot& robot, WallTime now) {
  robot.next_draw = now + goal_draws;
  if (!robot.without_goal.empty()) return;
  const std::size_t places = part_of(robot).size();
  robot.without_goal =
      places < 2 ? "gets no new goal: it can go nowhere else"
                 : fmt::format("gets no new goal: other robots take all {} places that it can go to", places);
}

std::vector<std::string> PlannerService::robots_without_goal() const {
  std::vector<std::string> lines;
  for (const Robot* robot : order_) {
    if (!robot->without_goal.empty()) lines.push_back(robot->task.name + " " + robot->without_goal);
  }
  return lines;
}

std::optional<std::string> PlannerService::on(const RosGoal& goal) {
  const auto known = robots_.find(goal.robot);
  if (known == robots_.end()) return "it is for no robot of this run";
  const Point2 place = turned(goal.position, scenario_.map.y_axis);
  auto problem = problem_with(goal);
  if (!problem) problem = problem_with_goal(known->second, place);
  goals_refused_ += problem.has_value();
  if (!problem) {
    known->second.wanted = place;
    next_wake_ = begun_;
  }
  return problem;
}

std::optional<std::string> PlannerService::problem_with_goal(const Robot& robot, const Point2& goal) {
  if (ended_) return "the run has ended";
  const double radius = robot.task.radius + settings_.margin;
  if (!field().is_free(goal, radius)) return "it is in an obstacle, or not on the map";
  for (const auto& [name, other] : robots_) {
    const double apart = radius + other.task.radius + settings_.margin;
    if (name != robot.task.name && (other.wanted.value_or(other.task.goal) - goal).norm() < apart)
      return "it is where another robot goes, " + name;
  }
  return std::nullopt;
}

const ClearanceField& PlannerService::field() {
  if (!field_) field_.emplace(scenario_.map);
  return *field_;
}

/// One that is still under way goes there from where it is.
void PlannerService::give_wanted_goals(std::vector<Message>& out) {
  for (Robot* robot : order_) {
    const auto goal = std::exchange(robot->wanted, std::nullopt);
    if (!goal) continue;
    const auto last = record_.last(robot->index);
    const Point2 here = last ? last->position : robot->task.start;
    begin_next_mission(*robot, robot->arrived() ? robot->task.goal : here, *goal);
    out.emplace_back(mission_of(*robot));
  }
}

void PlannerService::begin_next_mission(Robot& robot, const Point2& start, const Point2& goal) {
  robot.replaced += !robot.arrived();
  const AgentStatus done = robot.status.value_or(AgentStatus{});
  robot.earlier_nodes.valid += done.nodes_valid;
  robot.earlier_nodes.invalid += done.nodes_invalid;
  robot.earlier_grafts += done.trees_grafted;
  ++robot.mission;
  robot.task.start = start;
  robot.task.goal = goal;
  robot.without_goal.clear();
  robot.next_draw = 0;
  robot.status.reset();
  robot.path.clear();
  robot.root_nodes.clear();
}

bool PlannerService::recall(std::span<const Message> kept, WallTime now) {
  for (const Message& message : kept) {
    if (const auto* mission = std::get_if<Mission>(&message)) {
      if (!take_up(*mission, now)) return false;
    } else {
      on(arrival_of(message, now));
      reckon_with_silence_before(message, now);
    }
  }
  says_missions_again_ = missions_published_;
  meets_until_ = now + meeting();
  // Not the goals that were drawn already.
  std::uint64_t drawn = 0;
  for (const auto& [name, robot] : robots_) drawn += robot.mission - 1;
  random_ = Random(scenario_.seed + drawn);
  return true;
}

/// Until agents have found a service that begins anew.
WallTime PlannerService::meeting() const {
  return least_meeting + meeting_of_each * static_cast<double>(robots_.size());
}

/// Who fell silent long before this service began anew is not waited for from the beginning.
void PlannerService::reckon_with_silence_before(const Message& kept, WallTime now) {
  const auto* const status = std::get_if<AgentStatus>(&kept);
  const auto* const track = std::get_if<TrackMessage>(&kept);
  if (status == nullptr && track == nullptr) return;
  const auto known = robots_.find(status != nullptr ? status->robot : track->robot);
  if (known == robots_.end()) return;
  const auto last = record_.last(known->second.index);
  if (!last || !missions_published_) return;
  known->second.last_heard =
      std::clamp(clock_.wall_time(last->time), now - std::max(0.0, longest_cut - meeting()), now);
}

bool PlannerService::take_up(const Mission& mission, WallTime now) {
  const auto known = robots_.find(mission.robot);
  if (known == robots_.end() || mission.map_id != map_id_ || mission.fleet_size != robots_.size())
    return false;
  Robot& robot = known->second;
  if (mission.number == robot.mission + 1) begin_next_mission(robot, mission.start, mission.goal);
  const RobotTask& task = robot.task;
  const bool same_task = mission.number == robot.mission && mission.start == task.start &&
                         mission.goal == task.goal && mission.radius == task.radius &&
                         mission.max_speed == task.max_speed;
  if (!same_task || mission.clock.scale != settings_.time_scale || mission.planner != settings_.planner)
    return false;
  clock_ = mission.clock;
  missions_published_ = true;
  // One whose agent does not know where it was is stopped while the others go on.
  if (mission.cancelled && !robot.began_anew) ended_ = now;
  return true;
}

/// What it reaches from its goal, where it is. Few robots reach different parts: each is filled once.
const ReachablePart& PlannerService::part_of(const Robot& robot) {
  const double radius = robot.task.radius + settings_.margin;
  const auto known = std::ranges::find_if(parts_, [&](const ReachablePart& part) {
    return part.radius() == radius && part.contains(robot.task.goal);
  });
  if (known != parts_.end()) return *known;
  return parts_.emplace_back(ReachablePart::around(field(), radius, robot.task.goal));
}

/// Where others want to go, and where those stand that go nowhere any more.
std::vector<KeepOut> PlannerService::taken_by_others(const Robot& robot, double spare) const {
  std::vector<KeepOut> taken;
  for (const Robot* other : order_) {
    if (other == &robot) continue;
    const double apart = other->task.radius + robot.task.radius + 2 * settings_.margin + spare;
    taken.push_back({other->task.goal, apart});
    if (goes_on(*other)) continue;
    if (const auto last = record_.last(other->index)) taken.push_back({last->position, apart});
  }
  return taken;
}

/// Some way off, a cell beside all others if there is room for that; none if they leave no room.
std::optional<Point2> PlannerService::draw_goal(const Robot& robot) {
  const ReachablePart& part = part_of(robot);
  if (part.empty()) return std::nullopt;
  const double least_way = least_new_way * (part.box().upper - part.box().lower).norm();
  for (const double spare : {scenario_.map.resolution, 0.0}) {
    const auto goal = draw_place(part, robot.task.goal, least_way, taken_by_others(robot, spare), random_);
    if (goal) return goal;
  }
  return std::nullopt;
}

/// False: where it is it stays, unless another needs the room.
bool PlannerService::goes_on(const Robot& robot) {
  return !robot.lost && !robot.began_anew && !(robot.status && has_no_way(robot.status->phase));
}

bool PlannerService::goals_go_on(WallTime now) const {
  return missions_published_ && !interrupted_ && clock_.fleet_time(now) < settings_.lifelong;
}

bool PlannerService::everybody_has_the_forest() const {
  return forest_size_ && std::ranges::all_of(robots_, [&](const auto& entry) {
           return entry.second.trees_received >= *forest_size_;  // none is less than any number
         });
}

/// Robots that come to a forest plan in a fraction of the time; but without a broker they plan too.
bool PlannerService::time_for_missions(WallTime now) const {
  return everybody_has_the_forest() || settings_.planner != PlannerKind::ma_rrdt_star ||
         now - begun_ >= longest_wait_for_forest;
}

std::vector<Message> PlannerService::step(WallTime now) {
  std::vector<Message> out;
  begun_ = std::min(begun_, now);  // the clock may have been set back
  // A run that is to end before it began is nothing that others need to hear of: they may drive for another.
  if (!interrupted_ && !std::exchange(map_published_, true)) out.emplace_back(map());
  if (!interrupted_ && !missions_published_ && time_for_missions(now)) {
    missions_published_ = true;
    clock_.epoch = now;
    publish_missions(out);
  }
  if (std::exchange(says_missions_again_, false)) publish_missions(out);
  watch_liveliness(now);
  if (!ended_ && missions_published_) give_wanted_goals(out);
  if (!ended_ && goals_go_on(now)) give_new_goals(out, now);
  if (!ended_ && run_is_over(now)) {
    ended_ = now;
    if (missions_published_) publish_missions(out);  // as cancelled
  }
  if (ended_) ended_ = std::min(*ended_, now);  // likewise
  meets_until_ = std::min(meets_until_, now + meeting());
  if (ended_) finished_ = tracks_complete() || now > std::max(*ended_, meets_until_) + wait_for_tracks_;
  next_wake_ = now + beat;
  return out;
}

void PlannerService::watch_liveliness(WallTime now) {
  const WallTime slept = now - std::exchange(last_step_, now);
  if (ended_) return;
  int absent = 0;
  for (auto& [name, robot] : robots_) {
    if (slept > longest_nap) robot.last_heard += slept;
    robot.last_heard = std::min(robot.last_heard, now);  // the clock may have been set back
    absent += robot.status && !robot.lost && !robot.was_told_to_stop() && now - robot.last_heard > absence;
  }
  for (auto& [name, robot] : robots_) {
    const bool in_a_piece = absent > 1 && !robot.was_told_to_stop();
    const WallTime lease = !robot.status ? longest_cut : in_a_piece ? longest_split : agent_lease;
    robot.lost = robot.lost || now - robot.last_heard > lease;
  }
}

bool PlannerService::run_is_over(WallTime now) {
  if (settings_.waits_for_goals) return interrupted_;
  timed_out_ = missions_published_ && clock_.fleet_time(now) > settings_.timeout;
  return interrupted_ || timed_out_ ||
         std::ranges::all_of(robots_, [&](const auto& entry) { return entry.second.done(now); });
}

/// After the end every living agent says in its last status how many points there are in all, and the last of
/// them is where its robot has come to stand.
bool PlannerService::tracks_complete() const {
  return std::ranges::all_of(robots_, [&](const auto& entry) {
    const Robot& robot = entry.second;
    if (robot.lost || robot.began_anew || !robot.status) return true;
    const auto last = record_.last(robot.index);
    return robot.status->phase == Phase::stopped && record_.size(robot.index) >= robot.status->track_points &&
           (!last || stands(*last));
  });
}

bool PlannerService::everybody_arrived() const {
  return std::ranges::all_of(
      robots_, [&](const auto& entry) { return at_goal(entry.second, record_.last(entry.second.index)); });
}

Progress PlannerService::progress(WallTime now) const {
  Progress progress{.robots = static_cast<int>(robots_.size()),
                    .elapsed = missions_published_ ? clock_.fleet_time(now) : 0};
  for (const auto& [name, robot] : robots_) {
    progress.planned += !robot.path.empty();
    progress.arrived += robot.status && robot.status->arrival_time > 0;
    progress.missions += static_cast<int>(robot.missions_fulfilled(robot.arrived()));
    if (robot.status) progress.nodes += robot.status->nodes_valid;
  }
  for (const auto& [id, broker] : brokers_) progress.nodes += broker.nodes_valid;
  progress.periods_missed = share_of_periods_missed();
  return progress;
}

TrackParts PlannerService::tracks() const {
  return [this](const std::function<void(const TrackPart&)>& fn) {
    record_.for_each_stretch([&](double from, double until) {
      TrackPart part{from, until, {}};
      for (const Robot* robot : order_)
        part.tracks.push_back(
            {robot->task.name, {robot->task.radius, record_.around(robot->index, from, until)}});
      fn(part);
    });
  };
}

}  // namespace coppice
