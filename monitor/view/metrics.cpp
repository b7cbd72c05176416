#include "monitor/view/metrics.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

namespace coppice {

namespace {

using Families = std::vector<prometheus::MetricFamily>;
using Labels = std::vector<prometheus::ClientMetric::Label>;

constexpr std::array phase_names{"waiting", "planning", "driving", "arrived",
                                 "no_path", "stopped",  "gave_up", "halted"};

prometheus::MetricFamily& add_family(Families& all, std::string name, prometheus::MetricType type,
                                     std::string help) {
  return all.emplace_back(prometheus::MetricFamily{std::move(name), std::move(help), type, {}});
}

void add(prometheus::MetricFamily& family, double value, Labels labels = {}) {
  prometheus::ClientMetric metric;
  metric.label = std::move(labels);
  (family.type == prometheus::MetricType::Counter ? metric.counter.value : metric.gauge.value) = value;
  family.metric.push_back(std::move(metric));
}

void add_gauge(Families& all, std::string name, std::string help, double value) {
  add(add_family(all, std::move(name), prometheus::MetricType::Gauge, std::move(help)), value);
}

void add_counter(Families& all, std::string name, std::string help, double value) {
  add(add_family(all, std::move(name), prometheus::MetricType::Counter, std::move(help)), value);
}

void add_phases(Families& all, const FleetView& view) {
  std::array<std::size_t, phase_names.size()> robots{};
  for (const SeenRobot& robot : view.robots()) {
    ++robots.at(static_cast<std::size_t>(phase_of(robot)));
  }
  auto& family = add_family(all, "coppice_robots_in_phase", prometheus::MetricType::Gauge,
                            "Robots by the phase that they report.");
  for (std::size_t k = 0; k < robots.size(); ++k)
    add(family, static_cast<double>(robots[k]), {{"phase", phase_names[k]}});
}

void add_orders(Families& all, const FleetView& view) {
  const OrderCounts& orders = view.orders();
  auto& open = add_family(all, "coppice_orders", prometheus::MetricType::Gauge,
                          "Orders that have not ended, by state.");
  auto& ended = add_family(all, "coppice_orders_ended_total", prometheus::MetricType::Counter,
                           "Orders that have ended, by state.");
  for (std::size_t k = 0; k < orders.by_state().size(); ++k) {
    std::string state(order_state_names.at(k));
    std::ranges::replace(state, ' ', '_');
    add(is_ended(static_cast<OrderState>(k)) ? ended : open, static_cast<double>(orders.by_state().at(k)),
        {{"state", state}});
  }
  add_counter(all, "coppice_orders_late_total", "Orders that were done after their deadlines.",
              static_cast<double>(orders.late()));
  add_counter(all, "coppice_orders_set_out_total", "Ended orders for which a robot set out.",
              static_cast<double>(orders.set_out()));
  add_counter(all, "coppice_order_waited_seconds_total",
              "Time that these orders waited until their robots set out.", orders.waited());
  add_counter(all, "coppice_order_under_way_seconds_total", "Time from then to their ends.",
              orders.under_way());
  const auto robots = static_cast<double>(view.robots().size());
  const auto busy =
      static_cast<double>(orders.by_state().at(static_cast<std::size_t>(OrderState::under_way)));
  add_gauge(all, "coppice_utilisation", "Share of the robots whose orders are under way.",
            robots > 0 ? busy / robots : 0);
}

void add_fleet(Families& all, const FleetView& view, WallTime now) {
  const FleetFigures figures = view.figures(now);
  const auto number = [](std::size_t n) { return static_cast<double>(n); };
  add_gauge(all, "coppice_fleet_time_seconds", "Fleet time of the current run; 0 before its missions.",
            figures.time);
  const Life life = view.life(now);
  add_gauge(all, "coppice_fleet_alive",
            "1 if a robot was heard in the last seconds and its run has not ended.", life == Life::alive);
  add_gauge(all, "coppice_run_ended", "1 from the end of a run until another one begins.",
            life == Life::ended);
  add_gauge(all, "coppice_robots", "Robots that the monitor has heard in this run.", number(figures.robots));
  add_gauge(all, "coppice_robots_planned", "Robots that have a path.", number(figures.planned));
  add_phases(all, view);
  add_orders(all, view);
  add_counter(all, "coppice_missions_fulfilled_total", "Missions fulfilled by all robots.",
              number(figures.missions));
  add_counter(all, "coppice_trees_published_total", "Disjointed trees that brokers have published.",
              number(figures.trees_published));
  add_counter(all, "coppice_trees_grafted_total", "Grafts of published trees, by all robots.",
              number(figures.trees_grafted));
  if (figures.separation)
    add_gauge(all, "coppice_separation_meters", "Least distance between two robots now, minus both radii.",
              *figures.separation);
  add_gauge(all, "coppice_state_age_median_seconds",
            "Age of the other robots' states when a robot uses them: median of the robots' medians.",
            figures.state_age_p50);
  add_gauge(all, "coppice_state_age_worst_seconds",
            "Age of the other robots' states when a robot uses them: largest 99th percentile of a robot.",
            figures.state_age_p99);
  add_gauge(all, "coppice_control_periods_missed_ratio",
            "Recent share of control periods that were over before their agent decided.",
            figures.missed_share);
}

/// The number of alarms of each kind, and the alarms of robots by themselves. An alarm that is over leaves no
/// series.
void add_alarms(Families& all, const AlarmBoard& board) {
  auto& counts = add_family(all, "coppice_alarms", prometheus::MetricType::Gauge,
                            "Alarms that operators see now, by kind.");
  for (std::size_t k = 0; k < alarm_names.size(); ++k)
    add(counts, static_cast<double>(board.count(static_cast<AlarmKind>(k))),
        {{"kind", std::string(alarm_names.at(k))}});
  auto& of_robots = add_family(all, "coppice_robot_alarm", prometheus::MetricType::Gauge,
                               "1 for each alarm of a robot that lasts.");
  for (const Alarm& alarm : board.alarms()) {
    if (alarm.robot.empty() || of_robots.metric.size() >= most_robots_in_detail) continue;
    add(of_robots, 1,
        {{"robot", alarm.robot},
         {"kind", std::string(alarm_names.at(static_cast<std::size_t>(alarm.kind)))}});
  }
}

/// A state set: a series for each phase, with 1 for the robot's current phase.
void add_phase_of_each(Families& all, std::span<const SeenRobot> robots) {
  auto& family = add_family(all, "coppice_robot_phase", prometheus::MetricType::Gauge,
                            "1 for the phase that the robot is in, 0 for the others.");
  for (const SeenRobot& robot : robots) {
    const auto own = static_cast<std::size_t>(phase_of(robot));
    for (std::size_t k = 0; k < phase_names.size(); ++k)
      add(family, k == own, {{"robot", robot.name}, {"phase", phase_names[k]}});
  }
}

/// A time series for each robot that has a value.
struct OfRobot {
  const char* name;
  prometheus::MetricType type;
  const char* help;
  std::optional<double> (*value)(const SeenRobot& robot, WallTime now);
};

template <auto Value>
std::optional<double> of_status(const SeenRobot& robot, WallTime) {
  if (!robot.status) return std::nullopt;
  return static_cast<double>(Value(*robot.status));
}

std::optional<double> has_arrived(const SeenRobot& robot, WallTime) {
  return robot.status ? std::optional<double>(phase_of(robot) == Phase::arrived) : std::nullopt;
}

/// The value of a robot that has sent its position, at the view's fleet time.
template <auto Value>
std::optional<double> of_progress(const SeenRobot& robot, WallTime now) {
  if (!robot.state || !robot.mission) return std::nullopt;
  return Value(robot, robot.mission->clock.fleet_time(now));
}

const auto& series_of_robots() {
  constexpr auto gauge = prometheus::MetricType::Gauge;
  constexpr auto counter = prometheus::MetricType::Counter;
  using S = const AgentStatus&;
  static const std::array all{
      OfRobot{"coppice_robot_silence_seconds", gauge, "Time since the robot's last state arrived.",
              [](const SeenRobot& robot, WallTime now) {
                return robot.state ? std::optional(std::max(0.0, now - robot.heard)) : std::nullopt;
              }},
      OfRobot{"coppice_robot_speed_meters_per_second", gauge, "Speed in the robot's last state.",
              [](const SeenRobot& robot, WallTime) {
                return robot.state ? std::optional(robot.state->promise.velocity.norm()) : std::nullopt;
              }},
      OfRobot{"coppice_robot_arrived", gauge, "1 if the robot stands at its goal.", has_arrived},
      OfRobot{"coppice_robot_way_to_go_meters", gauge,
              "Distance from the robot along its path to the end of the path.",
              of_progress<[](const SeenRobot& r, double time) { return way_left(r, time); }>},
      OfRobot{"coppice_robot_waiting_seconds", gauge,
              "How long the robot has waited for another robot or for a joint plan, in fleet time; 0: not at "
              "all.",
              of_progress<[](const SeenRobot& r, double time) { return r.progress.waiting(time); }>},
      OfRobot{"coppice_robot_waited_seconds_total", counter,
              "Total time that the robot has waited in this run, in fleet time.",
              of_progress<[](const SeenRobot& r, double time) { return r.progress.waited(time); }>},
      OfRobot{"coppice_robot_without_progress_seconds", gauge,
              "Time since the robot last came nearer to the end of its path, in fleet time; 0 if it has no "
              "goal to reach.",
              of_progress<[](const SeenRobot& r, double time) { return r.progress.without_progress(time); }>},
      OfRobot{"coppice_robot_driven_meters", gauge, "Distance driven in the robot's current mission.",
              of_status<[](S s) { return s.driven_length; }>},
      OfRobot{"coppice_robot_path_meters", gauge, "Length of the robot's path; 0 without one.",
              [](const SeenRobot& robot, WallTime) { return std::optional(length_of(robot.path)); }},
      OfRobot{"coppice_robot_plan_seconds", gauge,
              "Time from the mission to the first path, by the wall clock; 0 before that.",
              of_status<[](S s) { return s.plan_seconds; }>},
      OfRobot{"coppice_robot_missions_fulfilled_total", counter, "Missions that the robot has fulfilled.",
              [](const SeenRobot& robot, WallTime) {
                return std::optional(static_cast<double>(robot.missions_fulfilled));
              }},
      OfRobot{"coppice_robot_state_age_seconds", gauge,
              "Age of the other robots' states when the robot uses them, 99th percentile.",
              of_status<[](S s) { return s.load.state_age_p99; }>},
      OfRobot{"coppice_robot_control_periods_total", counter, "Control periods of the robot's agent.",
              of_status<[](S s) { return s.load.periods; }>},
      OfRobot{"coppice_robot_control_periods_missed_total", counter,
              "Control periods of the robot's agent that were over before it decided.",
              of_status<[](S s) { return s.load.periods_missed; }>},
      OfRobot{"coppice_robot_processor_seconds_total", counter, "Processor time of the robot's agent.",
              of_status<[](S s) { return s.load.processor_seconds; }>},
      OfRobot{"coppice_robot_sent_bytes_total", counter, "Bytes sent by the robot's agent in UDP datagrams.",
              of_status<[](S s) { return s.load.bytes_sent; }>},
      OfRobot{"coppice_robot_received_bytes_total", counter,
              "Bytes received by the robot's agent in UDP datagrams.",
              of_status<[](S s) { return s.load.bytes_received; }>},
      OfRobot{"coppice_robot_rejected_messages_total", counter,
              "Messages that the robot's agent dropped as invalid.",
              of_status<[](S s) { return s.rejected; }>},
  };
  return all;
}

void add_robots(Families& all, const FleetView& view, WallTime now) {
  const auto robots = std::span(view.robots()).first(std::min(view.robots().size(), most_robots_in_detail));
  add_phase_of_each(all, robots);
  for (const OfRobot& series : series_of_robots()) {
    auto& family = add_family(all, series.name, series.type, series.help);
    for (const SeenRobot& robot : robots) {
      if (const auto value = series.value(robot, now)) add(family, *value, {{"robot", robot.name}});
    }
  }
}

void add_brokers(Families& all, const FleetView& view) {
  constexpr auto gauge = prometheus::MetricType::Gauge;
  constexpr auto counter = prometheus::MetricType::Counter;
  add_gauge(all, "coppice_brokers", "Tree brokers that are heard.",
            static_cast<double>(view.brokers().size()));
  Families families;
  families.reserve(4);
  auto& leads = add_family(families, "coppice_broker_leads", gauge,
                           "1 for the broker that grows trees, 0 for a broker on standby.");
  auto& active =
      add_family(families, "coppice_broker_trees_active", gauge, "Trees that the broker still grows.");
  auto& rejected = add_family(families, "coppice_broker_rejected_messages_total", counter,
                              "Messages that the broker dropped as invalid.");
  auto& processor = add_family(families, "coppice_broker_processor_seconds_total", counter,
                               "Processor time of the broker.");
  for (const auto& [id, broker] : view.brokers()) {
    const Labels labels{{"broker", fmt::format("{:x}", id)}};
    add(leads, broker.status.leads, labels);
    add(active, broker.status.trees_active, labels);
    add(rejected, broker.status.rejected, labels);
    add(processor, broker.status.processor_seconds, labels);
  }
  std::ranges::move(families, std::back_inserter(all));
}

void add_monitor(Families& all, const MonitorLoad& load) {
  const auto number = [](std::uint64_t n) { return static_cast<double>(n); };
  add(add_family(all, "coppice_build_info", prometheus::MetricType::Gauge, "The monitor's version."), 1,
      {{"version", COPPICE_VERSION}});
  add_counter(all, "coppice_monitor_messages_total", "Messages that the monitor has received.",
              number(load.messages));
  if (load.has_bus)
    add_counter(all, "coppice_monitor_rejected_messages_total",
                "Samples that the monitor dropped as invalid.", number(load.rejected));
  add_gauge(all, "coppice_monitor_connections", "Connected pages, Foxglove clients and listeners to events.",
            static_cast<double>(load.connections));
  add_counter(all, "coppice_monitor_sent_bytes_total", "Bytes sent to pages and Foxglove clients.",
              number(load.bytes_sent));
  add_counter(all, "coppice_monitor_refused_logins_total", "Requests to the API that showed a wrong token.",
              number(load.refused_logins));
  add_counter(all, "process_cpu_seconds_total", "Processor time of the monitor.", load.processor_seconds);
  add_gauge(all, "process_resident_memory_bytes", "Resident memory of the monitor.",
            number(load.resident_bytes));
}

}  // namespace

std::string metrics_text(const FleetView& view, const MonitorLoad& load, WallTime now,
                         const AlarmBoard& alarms) {
  Families all;
  add_fleet(all, view, now);
  add_alarms(all, alarms);
  add_robots(all, view, now);
  add_brokers(all, view);
  add_monitor(all, load);
  std::erase_if(all, [](const prometheus::MetricFamily& family) { return family.metric.empty(); });
  return prometheus::TextSerializer().Serialize(all);
}

}  // namespace coppice
