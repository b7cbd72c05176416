#include "monitor/view/fleet_table.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

namespace coppice {

namespace {

constexpr std::array<std::string_view, 8> phases{"waiting", "planning", "driving", "arrived",
                                                 "no path", "stopped",  "gave up", "halted"};
constexpr std::size_t longest_shown_name = 16;

/// The letters of a name and the number after them: r2 comes before r10.
std::tuple<std::string_view, std::size_t, std::string_view> natural(std::string_view name) {
  std::size_t digits = 0;
  while (digits < name.size() &&
         std::isdigit(static_cast<unsigned char>(name[name.size() - 1 - digits])) != 0)
    ++digits;
  std::string_view number = name.substr(name.size() - digits);
  while (number.size() > 1 && number.front() == '0') number.remove_prefix(1);
  return {name.substr(0, name.size() - digits), number.size(), number};
}

/// The order of the phases in the table: the most interesting first.
int rank(Phase phase) {
  switch (phase) {
    case Phase::no_path:
    case Phase::gave_up:
    case Phase::halted:
      return 0;
    case Phase::waiting:
      return 1;
    case Phase::planning:
      return 2;
    case Phase::driving:
      return 3;
    case Phase::arrived:
      return 4;
    case Phase::stopped:
      return 5;
  }
  return 6;
}

struct Row {
  const SeenRobot* robot;
  std::optional<double> age;  ///< age of its state, fleet seconds
  std::optional<double> to_go;
  std::optional<Wait> wait;
};

Row row_of(const SeenRobot& robot, std::optional<double> time) {
  Row row{&robot, {}, {}, {}};
  if (time) row.wait = wait_of(robot, *time);
  if (!robot.state) return row;
  if (!time) return row;
  row.age = std::max(0.0, *time - robot.state->promise.stamp);
  row.to_go = way_left(robot, *time);
  return row;
}

bool is_before(const Row& a, const Row& b, RobotOrder order) {
  const auto by_name = [&] { return sorts_before(a.robot->name, b.robot->name); };
  const auto first_by = [&](auto of_a, auto of_b) { return of_a != of_b ? of_a < of_b : by_name(); };
  switch (order) {
    case RobotOrder::name:
      return by_name();
    case RobotOrder::phase:
      return first_by(rank(phase_of(*a.robot)), rank(phase_of(*b.robot)));
    case RobotOrder::to_goal:
      return first_by(-a.to_go.value_or(-1), -b.to_go.value_or(-1));
    case RobotOrder::age:
      return first_by(-a.age.value_or(-1), -b.age.value_or(-1));
    case RobotOrder::missed:
      return first_by(-a.robot->missed.of_all, -b.robot->missed.of_all);
  }
  return by_name();
}

std::string number(std::optional<double> value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::string percent(double share) {
  return share < 0 ? "-" : fmt::format("{:.1f}%", 100 * share);
}

// What a robot waits for has the length of a sentence, and so comes last.
constexpr std::string_view columns = "{:<16} {:<9} {:>7} {:>9} {:>9} {:>6} {:>9} {:>9} {:>6} {:>7} {:>7}  {}";

std::string line_of(const Row& row) {
  const SeenRobot& robot = *row.robot;
  std::optional<double> x;
  std::optional<double> y;
  std::optional<double> speed;
  if (robot.state) {
    x = robot.state->promise.position.x();
    y = robot.state->promise.position.y();
    speed = robot.state->promise.velocity.norm();
  }
  const std::optional<double> driven =
      robot.status ? std::optional(robot.status->driven_length) : std::nullopt;
  return fmt::format(columns, robot.name.substr(0, longest_shown_name), name_of(phase_of(robot)),
                     robot.mission ? std::to_string(robot.mission->number) : "-", number(x, 1), number(y, 1),
                     number(speed, 1), number(row.to_go, 1), number(driven, 1), number(row.age, 2),
                     percent(robot.processor.of_one_core), percent(robot.missed.of_all),
                     row.wait ? fmt::format("{:.0f} s: {}", row.wait->seconds, row.wait->cause) : "-");
}

std::vector<std::string> summary_of(const FleetView& view, WallTime now) {
  if (view.robots().empty()) return {"no robot has been heard yet"};
  const FleetFigures f = view.figures(now);
  std::vector<std::string> lines{
      fmt::format("fleet time {:.1f} s   {} robots, {} with a path, {} arrived, {} missions fulfilled",
                  f.time, f.robots, f.planned, f.arrived, f.missions),
      fmt::format("trees: {} published, grafted {} times   least separation now {} m", f.trees_published,
                  f.trees_grafted, number(f.separation, 2)),
      fmt::format("age of states {:.2f} s (median robot), {:.2f} s (worst, p99)   {} cores   {} of control "
                  "periods missed",
                  f.state_age_p50, f.state_age_p99,
                  f.processors < 0 ? "-" : fmt::format("{:.2f}", f.processors), percent(f.missed_share))};
  for (const auto& [id, broker] : view.brokers())
    lines.push_back(fmt::format("broker {:016x} {}   nodes: {} valid, {} invalid   {} active trees   {}", id,
                                broker.status.leads ? "leads" : "stands by", broker.status.nodes_valid,
                                broker.status.nodes_invalid, broker.status.trees_active,
                                percent(broker.processor.of_one_core)));
  return lines;
}

}  // namespace

bool sorts_before(const RobotName& a, const RobotName& b) {
  return natural(a) < natural(b);
}

std::string_view name_of(Phase phase) {
  return phases.at(static_cast<std::size_t>(phase));
}

std::optional<RobotOrder> robot_order(std::string_view name) {
  const auto found = std::ranges::find(robot_orders, name);
  if (found == robot_orders.end()) return std::nullopt;
  return static_cast<RobotOrder>(found - robot_orders.begin());
}

FleetTable fleet_table(const FleetView& view, RobotOrder order, WallTime now) {
  FleetTable table{summary_of(view, now),
                   fmt::format(columns, "ROBOT", "PHASE", "MISSION", "X", "Y", "SPEED", "TO GO", "DRIVEN",
                               "AGE", "CPU", "MISSED", "WAITS"),
                   {}};
  std::vector<Row> rows;
  for (const SeenRobot& robot : view.robots()) rows.push_back(row_of(robot, view.fleet_time(now)));
  std::ranges::stable_sort(rows, [&](const Row& a, const Row& b) { return is_before(a, b, order); });
  for (const Row& row : rows) table.rows.push_back(line_of(row));
  return table;
}

}  // namespace coppice
