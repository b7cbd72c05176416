// Part of class PlannerService: it carries out the orders of the fleet's order book as missions.
//
// A goal must leave room for the goals of all other robots. A robot that has nothing to do steps aside if its
// place is wanted.
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "messages/silence.h"
#include "planner_service/run/planner_service.h"
#include "planner_service/timing.h"
#include "planning/assignment.h"
#include "planning/geometry/line_of_sight.h"

namespace coppice {

namespace {

constexpr double no_way = 1e9;  // metres: longer than any way

}  // namespace

/// Empty: the fleet may be able to carry it out.
std::string PlannerService::why_never(const OrderMessage& order) {
  if (std::string problem = orders_.problem_with(order); !problem.empty()) return problem;
  if (order.action != Action::go) return {};
  if (!no_orders_.empty()) return no_orders_;
  if (roadmap_ == nullptr) return "this run takes no orders: start the fleet with coppice serve";
  // The robots that reach all places so far.
  std::vector<const RobotRecord*> able;
  for (const RobotRecord& robot : robots_) {
    if (order.robots.empty() || order.robots.front() == robot.task.name) able.push_back(&robot);
  }
  for (std::size_t k = 0; k < order.visits.size(); ++k) {
    const Point2& place = order.visits[k].position;
    const auto cannot = [&](const RobotRecord* robot) { return !can_reach(*robot, place); };
    if (!std::ranges::all_of(able, cannot)) {
      std::erase_if(able, cannot);
      continue;
    }
    const bool is_split =
        order.robots.empty() && k > 0 &&
        std::ranges::any_of(robots_, [&](const auto& robot) { return can_reach(robot, place); });
    if (is_split)
      return fmt::format("no robot reaches all places: none that reaches those before reaches ({:g}, {:g})",
                         place.x(), place.y());
    const std::string who = order.robots.empty() ? "any robot" : order.robots.front();
    return fmt::format("({:g}, {:g}) is in an obstacle, off the map, or where no way leads for {}", place.x(),
                       place.y(), who);
  }
  return {};
}

/// From where it stands, or from its home if it is seen too near to an obstacle: the two are in one part of
/// the map.
bool PlannerService::can_reach(const RobotRecord& robot, const Point2& place) {
  const double radius = driving_radius(robot.task);
  if (!goals_.field().is_free(place, radius)) return false;
  const Point2 here = place_of(robot);
  const Point2& from = goals_.field().is_free(here, radius) ? here : scenario_.robots[robot.index].start;
  return goals_.field().is_free(from, radius) && roadmap_->way(from, place, radius).has_value();
}

/// By robot: whether it reaches all places of an order for any robot. No robot comes into another part of the
/// map.
const std::vector<bool>& PlannerService::able_robots(const OrderMessage& order) {
  const auto [known, is_new] = able_.try_emplace(order.id);
  if (!is_new) return known->second;
  for (const RobotRecord& robot : robots_) {
    known->second.push_back(std::ranges::all_of(
        order.visits, [&](const Visit& visit) { return can_reach(robot, visit.position); }));
  }
  return known->second;
}

/// A fleet that ends takes no orders any more: their senders repeat them, to the next one.
void PlannerService::receive(const OrderMessage& order, WallTime now) {
  if (has_ended(phase_)) return;
  orders_.receive(order, orders_.has_taken(order.id) ? std::string() : why_never(order), now);
  step_at_once();
}

void PlannerService::refuse_outdated_orders(WallTime now) {
  for (const OrderMessage& order : intake_.take_outdated(now)) {
    if (!has_ended(phase_) && !orders_.knows(order.id))
      orders_.receive(
          order,
          "it was given before this fleet began, which cannot tell what became of it: give it again "
          "with another id",
          now);
  }
}

Point2 PlannerService::place_of(const RobotRecord& robot) const {
  const auto last = tracks_.last(robot.index);
  return last ? last->position : robot.task.start;
}

/// Until the last step. After a restart of the service the agents are not heard until they have discovered
/// it.
WallTime PlannerService::silence_of(std::size_t robot) const {
  const WallTime now = liveliness_.last_step();
  const bool listens = now >= std::get<Running>(phase_).run.rediscovered_by;
  return listens ? liveliness_.silence(robot, now) : 0;
}

std::vector<RobotAtWork> PlannerService::robots_at_work() const {
  std::vector<RobotAtWork> all;
  for (const RobotRecord& robot : robots_) {
    const WallTime silence = silence_of(robot.index);
    RobotAtWork own{.mission = robot.mission,
                    .halted = robot.halted(),
                    .lost = liveliness_.is_lost(robot.index),
                    .silent = silence > lost_after,
                    .is_out_of_reach = silence > service_timing.agent_lease,
                    .took_up = robot.status.has_value(),
                    .out_of_service = robot.track_lost()};
    if (robot.status && robot.status->arrival_time > 0 && is_at_goal(robot, tracks_.last(robot.index)))
      own.arrived_at = robot.status->arrival_time;
    if (robot.status && robot.status->phase == Phase::no_path) own.no_way = robot.status->reason;
    all.push_back(std::move(own));
  }
  return all;
}

/// What was said of orders goes out before their missions (order_book.h).
void PlannerService::serve_orders(std::vector<Message>& out, WallTime now) {
  refuse_outdated_orders(now);
  const std::vector<RobotAtWork> robots = robots_at_work();
  orders_.follow(robots, clock_of(phase_)->fleet_time(now), now);
  std::vector<Message> missions;
  for (const OrderBook::Withdrawal& withdrawn : orders_.withdraw(robots))
    send(robots_[withdrawn.robot], {place_of(robots_[withdrawn.robot])}, missions);
  give_out_open_orders(robots);
  for (const DueOrder& due : orders_.due(robots)) carry_out(due, missions, now);
  for (const std::size_t robot : orders_.take_robots_to_stop()) stop_on_the_way(robot, missions, now);
  std::ranges::move(orders_.take_news(), std::back_inserter(out));
  std::ranges::move(missions, std::back_inserter(out));
}

/// Whether the service cannot send the robot away for now.
bool PlannerService::must_stay(std::size_t robot) const {
  return liveliness_.is_lost(robot) || silence_of(robot) > service_timing.absence ||
         robots_[robot].track_lost() || orders_.halt_of(robot) != Halt::none;
}

/// The places that robots keep: by their orders, or because they must stay.
std::vector<PlannerService::KeptPlace> PlannerService::kept_places() const {
  std::vector<KeptPlace> all;
  for (const RobotRecord& robot : robots_) {
    const OrderStatus* const order = orders_.order_of(robot.index);
    if (order == nullptr && !must_stay(robot.index)) continue;
    const Point2 place = order != nullptr ? order->order.visits[order->visited].position : place_of(robot);
    all.push_back({place, driving_radius(robot.task), robot.task.name});
  }
  return all;
}

/// Orders for any robot whose places can be had: as many as robots are free, the most urgent first. The
/// others wait, and tie up no robot. An order behind others hears of what these wait for when it is its turn:
/// a long queue is not told anew whenever one of them goes on.
std::vector<const OrderMessage*> PlannerService::open_orders_for(std::span<const std::size_t> free) {
  const std::vector<const OrderMessage*> open = orders_.open_orders();
  if (open.empty()) {
    able_.clear();
    return {};
  }
  if (able_.size() > 2 * open.size() + robots_.size())
    std::erase_if(able_, [&](const auto& entry) {
      return std::ranges::find(open, entry.first, &OrderMessage::id) == open.end();
    });
  std::vector<const OrderMessage*> chosen;
  std::vector<const OrderMessage*> waiting;  // those that are told why
  std::vector<KeptPlace> kept = kept_places();
  double radius = std::numeric_limits<double>::infinity();
  for (const std::size_t robot : free) radius = std::min(radius, driving_radius(robots_[robot].task));
  const auto wait = [&](const OrderMessage* order, const std::string& reason) {
    const Point2& place = order->visits.front().position;
    const bool is_behind =
        waiting.size() >= robots_.size() || std::ranges::any_of(waiting, [&](const OrderMessage* other) {
          return other->visits.front().position == place;
        });
    if (!is_behind) waiting.push_back(order);
    orders_.wait(order->id, is_behind ? "other orders are before it" : reason);
  };
  for (const OrderMessage* const order : open) {
    if (chosen.size() == free.size()) {
      wait(order, "no robot is free");
      continue;
    }
    const std::vector<bool>& able = able_robots(*order);
    if (std::ranges::none_of(free, [&](std::size_t robot) { return able[robot]; })) {
      orders_.wait(order->id, "no robot that reaches all its places is free");
      continue;
    }
    const Point2& place = order->visits.front().position;
    const auto keeper = std::ranges::find_if(
        kept, [&](const KeptPlace& k) { return (k.place - place).norm() < radius + k.radius; });
    if (keeper != kept.end()) {
      wait(order, fmt::format("it waits until {} has left", keeper->by));
      continue;
    }
    chosen.push_back(order);
    kept.push_back({place, radius, "the robot of order " + order->id});
  }
  return chosen;
}

/// Orders for any robot go to the free robots that have the shortest ways in all.
void PlannerService::give_out_open_orders(std::span<const RobotAtWork> robots) {
  const std::vector<std::size_t> free = orders_.free_robots(robots);
  const std::vector<const OrderMessage*> open = open_orders_for(free);
  if (open.empty()) return;
  Eigen::MatrixXd ways(open.size(), free.size());
  for (std::size_t k = 0; k < open.size(); ++k) {
    const Point2& place = open[k]->visits.front().position;
    for (std::size_t r = 0; r < free.size(); ++r) {
      const RobotRecord& robot = robots_[free[r]];
      const double radius = driving_radius(robot.task);
      const auto way =
          able_robots(*open[k])[free[r]] ? roadmap_->way(place_of(robot), place, radius) : std::nullopt;
      ways(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(r)) =
          way ? length_of(optimise_line_of_sight(goals_.field(), *way, radius)) : no_way;
    }
  }
  const auto given = least_sum_assignment(ways);
  for (std::size_t k = 0; k < open.size(); ++k) {
    if (!given[k]) continue;
    const bool has_way = ways(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(*given[k])) < no_way;
    if (has_way) orders_.assign(open[k]->id, free[*given[k]]);
  }
}

/// Sends the robot to its next place, unless another robot needs that place now.
void PlannerService::carry_out(const DueOrder& due, std::vector<Message>& missions, WallTime now) {
  RobotRecord& robot = robots_[due.robot];
  if (const auto other = goals_.in_the_way(due.robot, due.visit.position, rooms())) {
    const OrderStatus* const its_order = orders_.order_of(*other);
    const bool is_busy = its_order != nullptr && its_order->state == OrderState::under_way;
    if (is_busy || !step_aside(*other, due.robot, due.visit.position, missions, now))
      return orders_.wait(due.id, fmt::format("it waits until {} has left", robots_[*other].task.name));
  }
  const NextGoal goal{due.visit.position, due.visit.has_yaw ? std::optional(due.visit.yaw) : std::nullopt};
  if (const auto problem = goals_.request(due.robot, goal, rooms())) return orders_.wait(due.id, *problem);
  goals_.take_request(due.robot);
  orders_.begin(due.id, robot.mission + 1, now);
  send(robot, goal, missions);
}

/// A robot leaves its place to another one: it goes home, or anywhere else. False: it cannot.
bool PlannerService::step_aside(std::size_t robot, std::size_t for_robot, const Point2& place,
                                std::vector<Message>& missions, WallTime now) {
  if (must_stay(robot)) return false;
  std::vector<RoomOfRobot> rooms = this->rooms();
  const double apart = driving_radius(robots_[robot].task) + driving_radius(robots_[for_robot].task);
  const Point2& home = scenario_.robots[robot].start;
  const bool home_is_free = (home - place).norm() >= apart && !goals_.in_the_way(robot, home, rooms);
  rooms[for_robot].stays_at = place;
  const auto goal = home_is_free ? std::optional(home) : goals_.draw(robot, rooms, now);
  if (goal) send(robots_[robot], {*goal}, missions);
  return goal.has_value();
}

/// The robot comes to rest where it can brake, or somewhere else if that place is another robot's.
void PlannerService::stop_on_the_way(std::size_t robot, std::vector<Message>& missions, WallTime now) {
  RobotRecord& record = robots_[robot];
  if (orders_.order_of(robot) != nullptr || record.arrived()) return;
  const auto last = tracks_.last(robot);
  if (!last) return;
  const Point2 rest = rest_of(*last, record.task);
  const auto refused = goals_.request(robot, {rest}, rooms());
  const auto goal = refused ? goals_.draw(robot, rooms(), now) : std::optional(rest);
  goals_.take_request(robot);
  if (goal) send(record, {*goal}, missions);
}

}  // namespace coppice
