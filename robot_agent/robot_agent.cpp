#include "robot_agent/robot_agent.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "messages/validation.h"
#include "motion/free_way.h"
#include "planning/quantities.h"
#include "planning/suggestions.h"
#include "robot_agent/limits.h"
#include "robot_agent/words.h"

namespace coppice {

namespace {

constexpr double period = control_period;
constexpr WallTime status_interval = 0.5;    // seconds: at least this often, for liveliness
constexpr std::size_t track_batch = 10;  // points, half a second of fleet time: what a death loses
constexpr std::size_t longest_batch = 10'000;
constexpr WallTime pause_between_improvements = 0.001;
constexpr std::size_t most_places = 4'000;  // of its roadmap: some megabytes
constexpr int improvements_a_step = 4;      // bounded pieces of work, some hundred microseconds together
constexpr double worth_swapping = 0.005;    // of what is left to drive
constexpr std::size_t most_tree_nodes = 4'000'000;  // as many as a broker grows

bool is_of_run(const std::optional<SavedState>& memory, const Mission& mission) {
  return memory && memory->mission.clock == mission.clock && memory->mission.map_id == mission.map_id;
}

}  // namespace

void RobotAgent::expect(std::span<const Arrival> arrivals) const {
  for (const Arrival& arrival : arrivals) __builtin_prefetch(arrival.message.get());
  for (const Arrival& arrival : arrivals) {
    if (const auto* state = std::get_if<RobotState>(arrival.message.get())) fleet_.expect(state->robot);
  }
}

/// States wait for the next control step; everything else is looked at when it comes.
void RobotAgent::on(Arrival arrival) {
  ++load_.samples_received;
  if (const auto* state = std::get_if<RobotState>(arrival.message.get())) {
    ++load_.states_received;
    const auto position = body_ && takes_part() ? std::optional(body_->position()) : std::nullopt;
    if (fleet_.hear({std::move(arrival.message), state}, arrival.at)) round_.hear(*state, position);
    return;
  }
  if (const auto* plan = std::get_if<JointPlanMessage>(arrival.message.get())) {
    // One of the run before, which its leader's writer still tells who comes late, is of robots elsewhere.
    if (mission_ && takes_part() && plan->run == mission_->clock.epoch)
      round_.hear({std::move(arrival.message), plan});
  } else {
    std::visit(
        [&](const auto& m) {
          if constexpr (requires { receive(m, WallTime{}); }) receive(m, arrival.at);
        },
        *arrival.message);
  }
  next_wake_ = std::min(next_wake_, arrival.at);
}

/// In rounds: else nothing would ever lead it out of one, and who waits for that stands, too.
bool RobotAgent::takes_part() const {
  return status_.phase != Phase::stopped && !((is_new_ || is_isolated_) && status_.phase == Phase::no_path);
}

void RobotAgent::note(const BusCounts& counts, WallTime now) {
  rejected_by_bus_ = static_cast<std::uint32_t>(counts.rejected);
  if (counts.agents > load_.agents_matched) load_.matched_at = now;
  load_.agents_matched = static_cast<std::uint32_t>(counts.agents);
  load_.bytes_sent = counts.bytes_sent;
  load_.bytes_received = counts.bytes_received;
  load_.processor_seconds = counts.processor_seconds;
}

void RobotAgent::receive(const MapMessage& message, WallTime) {
  if (map_ && map_->map_id == message.map_id) return;
  map_ = grounds_->of(message);
  forget_trees([&](const InactiveTreeMessage& tree) { return tree.map_id != map_->map_id; });
  const std::size_t before = trees_.size();
  forget_trees([&](const InactiveTreeMessage& tree) { return !is_free(tree, map_->field); });
  impossible_ += static_cast<std::uint32_t>(before - trees_.size());
}

void RobotAgent::forget_trees(const std::function<bool(const InactiveTreeMessage&)>& which) {
  std::erase_if(trees_, which);
  tree_nodes_ = 0;
  tree_ids_.clear();
  for (const InactiveTreeMessage& tree : trees_) {
    tree_nodes_ += tree.nodes.size();
    tree_ids_.insert(tree.tree);
  }
  status_.trees_received = static_cast<std::uint32_t>(trees_.size());
}

/// Fleet time so far from now that its fractions are lost is not one to live by.
void RobotAgent::receive(const Mission& mission, WallTime arrived) {
  if (!is_sane(mission.clock.fleet_time(arrived))) {
    ++impossible_;
    return;
  }
  const bool of_another_run = fleet_.run() && *fleet_.run() != mission.clock;
  if (of_another_run && passes_over(mission, fleet_.run()->epoch, fleet_.own_mission())) return;
  if (of_another_run) begin_run();
  if (!run_heard_at_) run_heard_at_ = arrived;
  fleet_.hear(mission.robot == name_ ? as_reference(mission) : mission, arrived);
}

/// For a body that a robot follows.
Mission RobotAgent::as_reference(Mission mission) const {
  if (!tracking_) return mission;
  mission.radius += tracking_->tolerance();
  mission.max_speed *= Tracking::share_of_speed;
  return mission;
}

/// Fleet time begins anew, and robots stand where their missions say. Map and trees stay.
void RobotAgent::begin_run() {
  RobotAgent fresh(name_, grounds_);
  fresh.map_ = map_;
  fresh.trees_ = std::move(trees_);
  fresh.tree_ids_ = std::move(tree_ids_);
  fresh.tree_nodes_ = tree_nodes_;
  fresh.impossible_ = impossible_;
  fresh.rejected_by_bus_ = rejected_by_bus_;
  fresh.load_ = load_;
  fresh.ages_ = ages_;
  fresh.memory_ = std::move(memory_);
  if (tracking_) fresh.lead(tracking_->settings());
  fresh.retired_ = retired_;
  fresh.status_.trees_received = status_.trees_received;
  *this = std::move(fresh);
}

/// A tree may come again, from a broker that has taken over.
void RobotAgent::receive(const InactiveTreeMessage& tree, WallTime) {
  if (map_ && tree.map_id != map_->map_id) return;
  if (tree_ids_.contains(tree.tree)) return;
  if (tree_nodes_ + tree.nodes.size() > most_tree_nodes || (map_ && !is_free(tree, map_->field))) {
    ++impossible_;
    return;
  }
  tree_ids_.insert(tree.tree);
  tree_nodes_ += tree.nodes.size();
  trees_.push_back(tree);
  ++status_.trees_received;
  if (status_.phase == Phase::waiting) status_changed_ = true;  // the service waits for that
  const bool is_of_mission = ground_ && ground_->map_id == tree.map_id;
  if (is_of_mission && finder_ && status_.phase == Phase::planning) finder_->take(tree);
}

/// The newest map, or the one that it drives on: other maps may be heard of meanwhile. Null: it is not there.
std::shared_ptr<MapContext> RobotAgent::ground_of(const Mission& mission) const {
  if (map_ && map_->map_id == mission.map_id) return map_;
  return ground_ && ground_->map_id == mission.map_id ? ground_ : nullptr;
}

/// Takes up the mission once its map is there; a cancelled one ends what was going on, without a map too.
void RobotAgent::begin_mission(WallTime now) {
  if (retired_) return;
  const auto& own = fleet_.own_mission();
  if (!own) return;
  const Mission& mission = *own;
  if (mission_ && mission_->number == mission.number && !mission.cancelled) return;  // nearly always
  if (mission.cancelled && !is_of_run(memory_, mission)) return stop();
  if (!ground_of(mission)) return;
  take_up(mission, now);
  if (mission.cancelled) {  // but nobody else has the end of its track, however long ago it was driven
    stop();
    stopped_at_ = std::max(stopped_at_, mission.clock.fleet_time(now));
    return;
  }
  if (const char* const problem = problem_with_task()) {
    follower_.reset();
    finder_.reset();
    status_.path_time = mission.clock.fleet_time(now);
    status_.reason = problem;
    return enter(Phase::no_path);
  }
  look_for_a_path();
  enter(Phase::planning);
}

void RobotAgent::take_up(const Mission& mission, WallTime now) {
  if (const auto ground = ground_of(mission); ground_ != ground) {
    finder_.reset();  // it, and a joint planner, look at the old one
    round_ = CoordinationRound(name_);
    improver_.reset();
    ground_ = ground;
  }
  const double fleet_now = mission.clock.fleet_time(now);
  status_ = AgentStatus{.robot = name_,
                        .mission = mission.number,
                        .reason = {},
                        .mission_time = fleet_now,
                        .trees_received = static_cast<std::uint32_t>(trees_.size()),
                        .track_points = status_.track_points,
                        .run = mission.clock.epoch,
                        .came_on_at = fleet_now};
  mission_ = mission;
  stopped_at_ = std::numeric_limits<double>::infinity();
  said_that_it_stands_ = false;
  mission_wall_ = now;
  startup_since_ = fleet_now;
  if (!body_) place_body(mission, fleet_now);
  came_to_ = body_->position();
  found_.reset();
  times_stranded_ = 0;
  gave_up_ = false;
  round_.forget_failures();
  lets_others_finish_ = true;
}

/// Of the mission, on this map; null if there is none.
const char* RobotAgent::problem_with_task() const {
  const ClearanceField& field = ground_->field;
  if (!field.is_free(body_->position(), body_->radius() - driving_rounding))
    return "no path: the start is inside of an obstacle, or not on the map";
  if (!field.is_free(mission_->goal, mission_->radius))
    return "no path: the goal is inside of an obstacle, or not on the map";
  return nullptr;
}

void RobotAgent::place_body(const Mission& mission, double fleet_now) {
  const auto memory = std::exchange(memory_, std::nullopt);
  if (is_of_run(memory, mission)) return go_on_from(*memory, fleet_now);
  const double begin = std::max(0.0, std::ceil(fleet_now / period) * period);
  body_.emplace(mission.start, begin, mission.radius, limits_of(mission), period);
  if (fleet_.is_under_way(fleet_now)) join_late({}, fleet_now);
}

/// As after a pause, but that it knows nobody yet: it stands until it has heard of the others.
void RobotAgent::join_late(std::span<const Heard> silent, double fleet_now) {
  is_new_ = true;
  fleet_.begin_anew(silent, fleet_now);
  listen_anew(fleet_now);
}

void RobotAgent::go_on_from(const SavedState& memory, double fleet_now) {
  body_ = memory.body;
  track_ = tracking_ ? memory.seen : memory.track;
  if (tracking_ && !track_.empty()) last_seen_ = track_.back().time;
  sequence_ = memory.sequence;
  last_heartbeat_ = sequence_ / heartbeat_interval;
  first_control_ = false;
  round_.forget(memory.round_epoch);
  join_late(memory.silent, fleet_now);
  has_left_round_ = memory.stage != Stage::free;
  const AgentStatus& before = memory.status;
  if (before.mission == mission_->number) {
    status_.mission_time = before.mission_time;
    status_.path_time = before.path_time;
    status_.plan_seconds = before.plan_seconds;
    status_.improve_seconds = before.improve_seconds;
    if (before.phase == Phase::arrived || before.phase == Phase::stopped)
      status_.arrival_time = before.arrival_time;
    status_.driven_length = memory.driven_length;
  }
}

/// Brakes; nothing, where it has no mission. What it said to wait for is why it is not there: of the others
/// some may have been stopped before it.
void RobotAgent::stop() {
  if (!mission_ || status_.phase == Phase::stopped) return;
  if (is_under_way() && status_.reason.empty() && !status_.wait_cause.empty())
    status_.reason = bounded(fmt::format("since {:.1f} s: {}", status_.came_on_at, status_.wait_cause));
  follower_.reset();
  finder_.reset();
  stopped_at_ = body_->time();
  round_.leave();
  enter(Phase::stopped);
}

PathImprover<ClearanceField>& RobotAgent::improver() {
  if (!improver_ || improver_radius_ != mission_->radius) {
    improver_radius_ = mission_->radius;
    improver_ = std::make_unique<PathImprover<ClearanceField>>(
        ground_->field, suggested_epsilon(ground_->field, improver_radius_), Random(mission_->seed + 1),
        most_places);
  }
  return *improver_;
}

/// Back as it came, to where it last saw the path, and on along that; empty if it cannot drive so.
Path RobotAgent::way_back_to_the_path() const {
  Path way = trail_.back();
  const Path rest = follower_->rest();
  way.insert(way.end(), rest.begin(), rest.end());
  for (std::size_t k = 1; k < way.size(); ++k) {
    if (!way_free(ground_->field, way[k - 1], way[k], body_->radius())) return {};
  }
  return way;
}

/// From where it is to the mission's goal.
void RobotAgent::look_for_a_path(Path known) {
  follower_.reset();
  trail_.begin(body_->position());
  finder_ = std::make_unique<PathFinder>(ground_->field, improver(), *mission_, body_->position(),
                                         std::move(known));
  for (const InactiveTreeMessage& tree : trees_) {
    if (tree.map_id == ground_->map_id) finder_->take(tree);
  }
}

std::vector<Outgoing> RobotAgent::step(WallTime now) {
  std::vector<Outgoing> out;
  begin_mission(now);
  if (body_) control(mission_->clock.fleet_time(now), out);
  if (status_.phase == Phase::planning) {
    plan(now, out);
  } else if (finder_) {
    improve(now, out);
  }
  report(now, out);
  next_wake_ = next_status_;
  if (body_) {
    const double next_control = body_->time() + periods_to_next_control() * period;
    next_wake_ = std::min(next_wake_, mission_->clock.wall_time(next_control));
  }
  if (finder_) {
    const bool planning = status_.phase == Phase::planning;
    const double pause = found_ ? 0 : planning ? finder_->pause() : pause_between_improvements;
    next_wake_ = std::min(next_wake_, now + pause);
  }
  return out;
}

/// What a step finds is taken up by the next one: its time then counts what the finding took.
void RobotAgent::plan(WallTime now, std::vector<Outgoing>& out) {
  if (found_) {
    take_up(*std::exchange(found_, std::nullopt), now, out);
    return;
  }
  found_ = finder_->step();
  if (const auto batch = finder_->take_root_nodes(); batch) out.emplace_back(*batch);
}

void RobotAgent::take_up(const PathFinder::Result& result, WallTime now, std::vector<Outgoing>& out) {
  status_.nodes_valid = finder_->counts().valid;
  status_.nodes_invalid = finder_->counts().invalid;
  status_.trees_grafted = finder_->grafted_trees();
  if (status_.path_time == 0) {
    status_.path_time = mission_->clock.fleet_time(now);
    status_.plan_seconds = now - mission_wall_;
  }
  if (const auto* failure = std::get_if<NoPath>(&result)) {
    status_.reason = failure->reason;
    finder_.reset();
    enter(Phase::no_path);
  } else {
    first_path_wall_ = now;
    last_gain_time_ = mission_->clock.fleet_time(now);
    follow(std::get<Path>(result), out);
    enter(Phase::driving);
  }
}

void RobotAgent::follow(const Path& path, std::vector<Outgoing>& out) {
  out.emplace_back(PathMessage{name_, mission_->number, path, status_.run});
  follower_.emplace(path, mission_->radius);
  last_gain_ = 0;
}

/// Pulls the first path taut, before the robot has come far along it. Then looks for a shorter path while the
/// budget lasts and nobody needs the processor for its first one, and swaps to it where the robot sees its
/// way onto it and has less left to drive.
void RobotAgent::improve(WallTime now, std::vector<Outgoing>& out) {
  if (!finder_->is_taut()) return follow(finder_->pull_taut(), out);
  const bool over = now > first_path_wall_ + mission_->plan_budget || status_.phase != Phase::driving ||
                    round_.stage() != Stage::free;
  bool going = !over;
  if (going && !fleet_.somebody_plans()) {
    for (int k = 0; k < improvements_a_step && going; ++k) going = finder_->improve();
    const Path& path = finder_->path();
    if (length_of(path) < (1 - worth_swapping) * length_of(follower_->path())) {
      PathFollower candidate(path, mission_->radius);
      candidate.preferred_velocity(body_->position(), ground_->field, body_->limits(), period);
      if (!candidate.lost() && candidate.remaining(body_->position()) <
                                   (1 - worth_swapping) * follower_->remaining(body_->position())) {
        follow(path, out);
        status_.improve_seconds = now - first_path_wall_;
        status_changed_ = true;
      }
    }
  }
  if (!going) finder_.reset();
}

/// In pieces that a message holds, if it is all of a long one.
void RobotAgent::say_track(std::vector<Outgoing>& out) {
  for (std::size_t from = 0; from < track_.size(); from += longest_batch) {
    const std::size_t to = std::min(track_.size(), from + longest_batch);
    TrackMessage batch{name_, status_.mission, status_.track_points, {}, status_.run};
    batch.points.assign(track_.begin() + static_cast<std::ptrdiff_t>(from),
                        track_.begin() + static_cast<std::ptrdiff_t>(to));
    status_.track_points += static_cast<std::uint32_t>(batch.points.size());
    out.emplace_back(std::move(batch));
  }
  track_.clear();
}

/// Track points go out in batches, and all of them with a change of phase, so that the record is complete.
/// Not with each heartbeat, which is of the wall's clock: of a slow fleet that would be points one by one, and
/// each message is kept for who comes late.
void RobotAgent::report(WallTime now, std::vector<Outgoing>& out) {
  const bool has_come_to_stand =
      status_.phase == Phase::stopped && !track_.empty() && track_.back().velocity.isZero(0);
  if (has_come_to_stand && !std::exchange(said_that_it_stands_, true)) status_changed_ = true;
  if (!track_.empty() && (status_changed_ || track_.size() >= track_batch)) say_track(out);
  next_status_ = std::min(next_status_, now + status_interval);  // the clock may have been set back
  if (!status_changed_ && now < next_status_) return;
  if (status_.phase == Phase::waiting && !retired_) status_.reason = bounded(why_it_has_no_mission(now));
  if (mission_) status_.wait_cause = bounded(wait_cause(mission_->clock.fleet_time(now)));
  status_.way_left = way_left();
  status_.rejected = rejected_by_bus_ + impossible_;
  load_.state_age_p50 = ages_.at_share(0.5);
  load_.state_age_p99 = ages_.at_share(0.99);
  load_.state_age_max = ages_.most();
  status_.load = load_;
  out.emplace_back(status_);
  status_changed_ = false;
  next_status_ = now + status_interval;
}

/// Its track is where it was seen, once a control period.
void RobotAgent::on(const OdometrySample& robot) {
  if (!tracking_ || !body_) return;
  const FleetClock& clock = mission_->clock;
  const double time = clock.fleet_time(robot.at);
  tracking_->see(robot, body_->position() + (time - body_->time()) * body_->velocity());
  if (time < last_seen_ + period) return;
  last_seen_ = time;
  if (records(time)) track_.push_back({time, robot.position, robot.velocity / clock.scale});
}

Point2 RobotAgent::command(WallTime now) const {
  if (!tracking_ || !body_) return Point2::Zero();
  const double scale = mission_->clock.scale;
  const double max_speed = scale * mission_->max_speed / Tracking::share_of_speed;
  return tracking_->command(scale * body_->velocity(), max_speed, now);
}

void RobotAgent::retire() {
  retired_ = true;
  if (mission_ && status_.reason.empty()) status_.reason = "the agent was told to stop";
  stop();
}

std::vector<Outgoing> RobotAgent::last_words(WallTime now) {
  std::vector<Outgoing> out;
  if (body_ && !tracking_) track_.push_back({body_->time(), body_->position(), body_->velocity()});
  status_changed_ = true;
  report(now, out);
  return out;
}

}  // namespace coppice
