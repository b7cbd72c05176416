// Part of class PlannerService: it carries out the orders of the fleet's order book as missions.
//
// A goal must leave room for the goals of all other robots. A robot that has nothing to do steps aside if its
// place is wanted.
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "planner_service/planner_service.h"
#include "planning/assignment.h"
#include "planning/line_of_sight.h"

namespace coppice {

namespace {

constexpr double no_way = 1e9;  // metres: longer than any way

}  // namespace

/// Empty: the fleet may be able to carry it out.
std::string PlannerService::why_never(const OrderMessage& order) {
  if (std::string problem = orders_.problem_with(order); !problem.empty()) return problem;
  if (order.action != Action::go) return {};
  if (roadmap_ == nullptr) return "this run takes no orders: start the fleet with coppice serve";
  if (has_ended(phase_)) return "the run has ended";
  for (std::size_t k = 0; k < order.visits.size(); ++k) {
    const Point2& place = order.visits[k].position;
    const auto may_go = [&](const RobotRecord& robot) {
      const bool is_meant = order.robots.empty() || order.robots.front() == robot.task.name;
      return is_meant && can_reach(robot.task, place);
    };
    if (std::ranges::any_of(robots_, may_go)) continue;
    const std::string who = order.robots.empty() ? "any robot" : order.robots.front();
    return fmt::format("({:g}, {:g}) is in an obstacle, off the map, or where no way leads for {}", place.x(),
                       place.y(), who);
  }
  return {};
}

/// From its home: the robot may be anywhere by now.
bool PlannerService::can_reach(const RobotTask& robot, const Point2& place) {
  const double radius = driving_radius(robot);
  const auto home = std::ranges::find(scenario_.robots, robot.name, &RobotTask::name);
  return goals_.field().is_free(place, radius) && roadmap_->way(home->start, place, radius).has_value();
}

void PlannerService::receive(const OrderMessage& order, WallTime now) {
  if (!orders_.knows(order.id)) orders_.receive(order, why_never(order), now);
  step_at_once();
}

Point2 PlannerService::place_of(const RobotRecord& robot) const {
  const auto last = tracks_.last(robot.index);
  return last ? last->position : robot.task.start;
}

std::vector<RobotAtWork> PlannerService::robots_at_work() const {
  std::vector<RobotAtWork> all;
  for (const RobotRecord& robot : robots_) {
    RobotAtWork own{.mission = robot.mission,
                    .halted = robot.halted(),
                    .lost = liveliness_.is_lost(robot.index),
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
  const std::vector<RobotAtWork> robots = robots_at_work();
  orders_.follow(robots, clock_of(phase_)->fleet_time(now), now);
  give_out_open_orders(robots);
  std::vector<Message> missions;
  for (const DueOrder& due : orders_.due(robots)) carry_out(due, missions, now);
  for (const std::size_t robot : orders_.take_robots_to_stop()) stop_on_the_way(robot, missions, now);
  std::ranges::move(orders_.take_news(), std::back_inserter(out));
  std::ranges::move(missions, std::back_inserter(out));
}

/// Whether the service cannot send the robot away for now.
bool PlannerService::must_stay(std::size_t robot) const {
  return liveliness_.is_lost(robot) || robots_[robot].track_lost() || orders_.halt_of(robot) != Halt::none;
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
/// others wait, and tie up no robot.
std::vector<const OrderMessage*> PlannerService::open_orders_for(std::span<const std::size_t> free) {
  const std::vector<const OrderMessage*> open = orders_.open_orders();
  if (open.empty()) return {};
  std::vector<const OrderMessage*> chosen;
  std::vector<KeptPlace> kept = kept_places();
  double radius = std::numeric_limits<double>::infinity();
  for (const std::size_t robot : free) radius = std::min(radius, driving_radius(robots_[robot].task));
  for (const OrderMessage* const order : open) {
    if (chosen.size() == free.size()) {
      orders_.wait(order->id, "no robot is free");
      continue;
    }
    const Point2& place = order->visits.front().position;
    const auto keeper = std::ranges::find_if(
        kept, [&](const KeptPlace& k) { return (k.place - place).norm() < radius + k.radius; });
    if (keeper != kept.end()) {
      orders_.wait(order->id, fmt::format("it waits until {} has left", keeper->by));
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
      const auto way = goals_.field().is_free(place, radius) ? roadmap_->way(place_of(robot), place, radius)
                                                             : std::nullopt;
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
  const Point2 rest =
      last->position + last->velocity * last->velocity.norm() / (2 * record.task.max_acceleration);
  const auto refused = goals_.request(robot, {rest}, rooms());
  const auto goal = refused ? goals_.draw(robot, rooms(), now) : std::optional(rest);
  goals_.take_request(robot);
  if (goal) send(record, {*goal}, missions);
}

}  // namespace coppice
