#include "monitor/view/fleet_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "messages/silence.h"

namespace coppice {

namespace {

constexpr std::size_t most_seen = 10'000;         // names beyond that are forged
constexpr std::size_t most_root_nodes = 200'000;  // per robot
constexpr WallTime share_period = 1;              // seconds over which a share is computed, at least
constexpr std::uint32_t missed_period = 20;       // control periods over which a share is computed, at least
constexpr WallTime longest_delay = 5;             // seconds that a state may take; more is another clock
// Processes start one after the other, and the last ones of a large fleet late.
constexpr WallTime longest_start = 10;  // seconds from a robot's mission to its first state

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The least distance between two robots, minus both radii.
std::optional<double> separation(const std::vector<SeenRobot>& robots, double time) {
  struct Body {
    Point2 place;
    double radius;
  };
  std::vector<Body> bodies;
  double largest = 0;
  for (const SeenRobot& robot : robots) {
    if (!robot.state) continue;
    const double radius = robot.mission ? own_radius(*robot.mission) : robot.state->radius;
    bodies.push_back({position_at(*robot.state, time), radius});
    largest = std::max(largest, radius);
  }
  if (bodies.size() < 2) return std::nullopt;
  std::ranges::sort(bodies, {}, [](const Body& body) { return body.place.x(); });
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (bodies[j].place.x() - bodies[i].place.x() > least + 2 * largest) break;
      least =
          std::min(least, (bodies[j].place - bodies[i].place).norm() - bodies[i].radius - bodies[j].radius);
    }
  }
  return least;
}

}  // namespace

void ProcessorShare::on(double processor_seconds, WallTime at) {
  if (processor_seconds <= 0) return;  // a simulation, in which no robot has a process of its own
  const bool of_another_process = processor_seconds < seconds_then_;
  if (since_ && !of_another_process && at - *since_ < share_period) return;
  if (since_ && !of_another_process) of_one_core = (processor_seconds - seconds_then_) / (at - *since_);
  since_ = at;
  seconds_then_ = processor_seconds;
}

void MissedShare::on(std::uint32_t periods, std::uint32_t missed) {
  const bool of_another_process = periods < periods_then_ || missed < missed_then_;
  if (!of_another_process && periods - periods_then_ < missed_period) return;
  of_all = of_another_process
               ? 0
               : static_cast<double>(missed - missed_then_) / static_cast<double>(periods - periods_then_);
  periods_then_ = periods;
  missed_then_ = missed;
}

Point2 position_at(const RobotState& state, double time) {
  const double first =
      std::clamp(time, state.promise.stamp, std::max(state.promise.stamp, state.promise.decision_time));
  const double second = std::clamp(time, first, std::max(first, state.promise.expiry));
  return state.promise.position + (first - state.promise.stamp) * state.promise.velocity +
         (second - first) * state.promise.next_velocity;
}

double yaw_at(const RobotState& state, double time) {
  const double first =
      std::clamp(time, state.promise.stamp, std::max(state.promise.stamp, state.promise.decision_time));
  const double second =
      std::clamp(time, first, std::max(first, state.promise.decision_time + control_period));
  return wrapped(state.promise.yaw + (first - state.promise.stamp) * state.promise.angular_velocity +
                 (second - first) * state.promise.next_angular_velocity);
}

Phase phase_of(const SeenRobot& robot) {
  const Phase phase = robot.status ? robot.status->phase : robot.state ? robot.state->phase : Phase::waiting;
  const bool at_goal = robot.status && robot.status->arrival_time > 0;
  return phase == Phase::stopped && at_goal ? Phase::arrived : phase;
}

std::optional<double> way_left(const SeenRobot& robot, double time) {
  if (!robot.state) return std::nullopt;
  return robot.progress.way_left(position_at(*robot.state, time));
}

std::optional<Wait> wait_of(const SeenRobot& robot, double time) {
  if (robot.status && !robot.status->wait_cause.empty())
    return Wait{std::max(0.0, time - robot.status->came_on_at), robot.status->wait_cause};
  const double seconds = robot.progress.waiting(time);
  if (!robot.state || seconds <= 0) return std::nullopt;
  const RobotName& first = robot.state->waits_for;
  return Wait{seconds, first.empty() ? "it stands until there is a joint plan"
                                     : fmt::format("it lets {} go first", first)};
}

bool is_in_service(const SeenRobot& robot) {
  return robot.mission && !robot.mission->cancelled;
}

WallTime last_heard(const SeenRobot& robot) {
  return robot.state ? robot.heard : robot.known_since;
}

WallTime unheard_for(const SeenRobot& robot, WallTime now) {
  return std::max(0.0, now - last_heard(robot));
}

bool is_lost(const SeenRobot& robot, WallTime now) {
  return is_in_service(robot) && unheard_for(robot, now) > (robot.state ? lost_after : longest_start);
}

std::string sentence_of(const SeenRobot& robot, double time, WallTime now) {
  if (is_lost(robot, now)) return "it is not heard: its agent has ended, hangs, or cannot be reached";
  const Phase phase = phase_of(robot);
  if (robot.status && (has_no_way(phase) || phase == Phase::waiting) && !robot.status->reason.empty())
    return robot.status->reason;
  if (phase == Phase::planning) return "it looks for a path";
  const auto wait = wait_of(robot, time);
  return wait ? fmt::format("{}, for {:.0f} s", wait->cause, wait->seconds) : std::string();
}

std::optional<double> time_left(const SeenRobot& robot, double time, WallTime now) {
  constexpr double usual_share = 0.9;  // of the largest speed, on a way with corners
  const auto way = way_left(robot, time);
  const bool goes =
      phase_of(robot) == Phase::driving && robot.state && robot.state->max_speed > 0 && !is_lost(robot, now);
  return way && goes ? std::optional(*way / (usual_share * robot.state->max_speed)) : std::nullopt;
}

void FleetView::on(const std::shared_ptr<const Message>& message, WallTime at) {
  if (const auto* tree = std::get_if<InactiveTreesMessage>(message.get())) {
    const bool of_this_map = !map_ || map_->map_id == tree->map_id;
    if (of_this_map && tree_ids_.insert(tree->id).second) trees_.push_back(message);
    return;
  }
  if (const auto* trees = std::get_if<ActiveTreesMessage>(message.get())) {
    if (!map_ || map_->map_id == trees->map_id) active_trees_ = message;
    return;
  }
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, at); }) receive(m, at);
      },
      *message);
}

void FleetView::begin_anew() {
  ++run_;
  heard_ = 0;
  index_ = {};
  robots_.clear();
  active_trees_.reset();
  ahead_ = 0;
}

void FleetView::receive(const MapMessage& map, WallTime) {
  if (map_ && map_->map_id == map.map_id) return;
  const bool another = map_.has_value();
  map_ = map;
  const std::size_t stay = std::erase_if(
      trees_, [&](const auto& tree) { return std::get<InactiveTreesMessage>(*tree).map_id != map.map_id; });
  if (!another && stay == 0) return;
  tree_ids_.clear();
  for (const auto& tree : trees_) tree_ids_.insert(std::get<InactiveTreesMessage>(*tree).id);
  begin_anew();
}

/// Null if there are so many names that some must be forged.
SeenRobot* FleetView::robot(const RobotName& name, WallTime at) {
  if (robots_.size() >= most_seen && !index_.find(name)) return nullptr;
  const auto [number, fresh] = index_.insert(name);
  if (fresh) robots_.push_back({.name = name, .known_since = at});
  return &robots_[number];
}

/// True while any robot of the current run is heard. Messages of an earlier run then do not end it.
bool FleetView::is_under_way(WallTime now) const {
  return std::ranges::any_of(robots_, [&](const SeenRobot& seen) {
    const bool is_over = seen.mission && seen.mission->cancelled;
    return seen.state && !is_over && !is_lost(seen.heard, now);
  });
}

void FleetView::receive(const Mission& mission, WallTime at) {
  // The mission is of an earlier run, or the clock was set back, or a recording is replayed from another
  // time.
  if (clock_ && mission.clock.epoch < clock_->epoch && (mission.cancelled || is_under_way(at))) return;
  if (clock_ && *clock_ != mission.clock) begin_anew();
  clock_ = mission.clock;
  SeenRobot* const seen = robot(mission.robot, at);
  if (seen == nullptr || (seen->mission && seen->mission->number > mission.number)) return;
  if (seen->mission && seen->mission->number != mission.number) {
    if (seen->path_mission != mission.number) {  // else the path came before its mission
      seen->path.clear();
      seen->progress.follow({});
      ++seen->path_revision;
    }
    seen->progress.begin_mission();
    seen->root_nodes.clear();
  }
  seen->mission = mission;
}

void FleetView::receive(const RootNodes& batch, WallTime) {
  if (is_stale(batch)) return;
  const auto known = index_.find(batch.robot);
  if (!known) return;
  SeenRobot& seen = robots_[*known];
  const bool of_this_mission = seen.mission && seen.mission->number == batch.mission;
  if (!of_this_mission || batch.first_index > seen.root_nodes.size()) return;
  for (std::size_t k = seen.root_nodes.size() - batch.first_index;
       k < batch.nodes.size() && seen.root_nodes.size() < most_root_nodes; ++k)
    seen.root_nodes.push_back(batch.nodes[k]);
}

void FleetView::receive(const RobotState& state, WallTime at) {
  if (state.passed_on || is_stale(state)) return;
  SeenRobot* const seen = robot(state.robot, at);
  if (seen == nullptr) return;
  // the state is of an earlier run, or late
  if (seen->state && seen->state->promise.stamp > state.promise.stamp) return;
  follow_clock(state, at);
  seen->progress.on(state);
  seen->state = state;
  seen->heard = heard_ = at;
}

void FleetView::receive(const PathMessage& path, WallTime at) {
  if (is_stale(path)) return;
  SeenRobot* const seen = robot(path.robot, at);
  if (seen == nullptr || (seen->mission && seen->mission->number > path.mission)) return;
  seen->path = path.waypoints;
  seen->progress.follow(path.waypoints);
  seen->path_mission = path.mission;
  ++seen->path_revision;
}

void FleetView::receive(const AgentStatus& status, WallTime at) {
  if (is_stale(status)) return;
  SeenRobot* const seen = robot(status.robot, at);
  if (seen == nullptr) return;
  const bool arrives = status.phase == Phase::arrived && status.mission > 0;
  seen->missions_fulfilled = std::max(
      {seen->missions_fulfilled, status.mission - (status.mission > 0), arrives ? status.mission : 0});
  seen->processor.on(status.load.processor_seconds, at);
  seen->missed.on(status.load.periods, status.load.periods_missed);
  seen->status = status;
  heard_ = at;
}

void FleetView::receive(const BrokerStatus& status, WallTime at) {
  SeenBroker& seen = brokers_[status.broker];
  seen.status = status;
  seen.heard = at;
  seen.processor.on(status.processor_seconds, at);
  std::erase_if(brokers_, [&](const auto& entry) { return is_lost(entry.second.heard, at); });
  if (active_trees_ && !brokers_.contains(std::get<ActiveTreesMessage>(*active_trees_).broker))
    active_trees_.reset();
}

std::optional<double> FleetView::fleet_time(WallTime now) const {
  if (!clock_) return std::nullopt;
  return clock_->fleet_time(now) + ahead_;
}

/// A fleet keeps its own time when the clock of its host is set (runtime/process_clock.h), and this process
/// may have started after that, or on a host whose clock is wrong.
void FleetView::follow_clock(const RobotState& state, WallTime at) {
  if (!clock_) return;
  const double ahead = state.promise.stamp - clock_->fleet_time(at);
  if (std::abs(ahead - ahead_) > longest_delay * clock_->scale) ahead_ = ahead;
}

Life FleetView::life(WallTime now) const {
  const auto has_mission = [](const SeenRobot& robot) { return robot.mission.has_value(); };
  if (std::ranges::any_of(robots_, has_mission) && std::ranges::none_of(robots_, is_in_service))
    return Life::ended;
  if (heard_ == 0) return Life::nobody;
  return is_lost(heard_, now) ? Life::silent : Life::alive;
}

FleetFigures FleetView::figures(WallTime now) const {
  FleetFigures all{.time = fleet_time(now).value_or(0),
                   .robots = robots_.size(),
                   .trees_published = trees_.size(),
                   .separation = separation(robots_, fleet_time(now).value_or(0))};
  double processors = 0;
  double missed = 0;
  std::vector<double> ages;
  for (const SeenRobot& robot : robots_) {
    all.planned += !robot.path.empty();
    all.missions += robot.missions_fulfilled;
    missed += robot.missed.of_all / static_cast<double>(robots_.size());
    processors += std::max(0.0, robot.processor.of_one_core);
    all.arrived += phase_of(robot) == Phase::arrived;
    if (!robot.status) continue;
    all.trees_grafted += robot.status->trees_grafted;
    ages.push_back(robot.status->load.state_age_p50);
    all.state_age_p99 = std::max(all.state_age_p99, robot.status->load.state_age_p99);
  }
  for (const auto& [id, broker] : brokers_) processors += std::max(0.0, broker.processor.of_one_core);
  const bool told =
      std::ranges::any_of(robots_, [](const SeenRobot& robot) { return robot.processor.of_one_core >= 0; });
  if (told) all.processors = processors;
  all.missed_share = missed;
  all.state_age_p50 = median(std::move(ages));
  return all;
}

}  // namespace coppice
