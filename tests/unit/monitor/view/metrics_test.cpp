// Tests of the metrics that Prometheus reads.

#include "monitor/view/metrics.h"

#include <iterator>
#include <regex>

#include <gtest/gtest.h>

#include "tests/support.h"
#include "tests/unit/monitor/seen_fleet.h"

namespace coppice {
namespace {

bool has_line(const std::string& text, const std::string& line) {
  return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

std::ptrdiff_t lines_of(const std::string& text, const std::string& name) {
  const std::regex line("\n" + name + "(\\{[^\n]*\\})? [^\n]*");
  const std::string all = "\n" + text;
  return std::distance(std::sregex_iterator(all.begin(), all.end(), line), std::sregex_iterator());
}

TEST(Metrics, TheMetricsDescribeTheFleet) {
  test::SeenFleet fleet;
  fleet.map();
  for (const char* name : {"a", "b", "c"}) fleet.mission(name);
  fleet.state("a", {1, 1});
  fleet.state("b", {2, 1}, {2, 0});
  fleet.status("a", Phase::arrived, 3.5);
  fleet.status("b", Phase::driving, 1);
  fleet.path("a", {{0.5, 1.5}, {3.5, 1.5}});
  fleet.tree(1);
  fleet.hear(BrokerStatus{.broker = 255, .trees_active = 4});
  const std::string text = metrics_text(fleet.view, {.messages = 12, .connections = 2}, fleet.now);
  for (const char* line :
       {"coppice_robots 3", "coppice_robots_planned 1", "coppice_robots_in_phase{phase=\"arrived\"} 1",
        "coppice_robots_in_phase{phase=\"waiting\"} 1", "coppice_trees_published_total 1",
        "coppice_missions_fulfilled_total 1", "coppice_separation_meters 0.5",
        "coppice_robot_driven_meters{robot=\"a\"} 3.5", "coppice_robot_path_meters{robot=\"a\"} 3",
        "coppice_robot_speed_meters_per_second{robot=\"b\"} 2", "coppice_robot_arrived{robot=\"a\"} 1",
        "coppice_brokers 1", "coppice_broker_trees_active{broker=\"ff\"} 4",
        "coppice_monitor_messages_total 12", "coppice_monitor_connections 2"})
    EXPECT_TRUE(has_line(text, line)) << line << "\n" << text;
  EXPECT_EQ(lines_of(text, "coppice_robot_speed_meters_per_second"), 2) << "c was not heard";
}

TEST(Metrics, AlarmsAreCountedAndNamed) {
  test::SeenFleet fleet;
  for (const char* name : {"a", "b"}) {
    fleet.mission(name);
    fleet.state(name, {1, 1});
    fleet.status(name, Phase::arrived);
  }
  AlarmBoard board;
  board.look(fleet.view, fleet.now);
  const std::string calm = metrics_text(fleet.view, {}, fleet.now, board);
  EXPECT_TRUE(has_line(calm, "coppice_alarms{kind=\"robot_silent\"} 0")) << calm;
  EXPECT_EQ(lines_of(calm, "coppice_robot_alarm"), 0);
  fleet.now += 4;
  fleet.state("b", {1, 1});
  board.look(fleet.view, fleet.now);
  const std::string text = metrics_text(fleet.view, {.refused_logins = 7}, fleet.now, board);
  for (const char* line :
       {"coppice_alarms{kind=\"robot_silent\"} 1", "coppice_alarms{kind=\"periods_missed\"} 0",
        "coppice_robot_alarm{robot=\"a\",kind=\"robot_silent\"} 1", "coppice_monitor_refused_logins_total 7"})
    EXPECT_TRUE(has_line(text, line)) << line << "\n" << text;
  EXPECT_EQ(lines_of(text, "coppice_robot_alarm"), 1);
}

TEST(Metrics, OrdersAreCountedOnceByState) {
  test::SeenFleet fleet;
  fleet.mission("a");
  fleet.state("a", {1, 1});
  const auto hear = [&](const char* id, OrderState state, double begun, double ended) {
    OrderStatus status{.order = {.id = id, .visits = {{{1, 2}}}, .deadline = 20}, .state = state};
    status.accepted_at = 10;
    status.begun_at = begun;
    status.ended_at = ended;
    fleet.hear(status);
  };
  hear("1", OrderState::accepted, 0, 0);
  hear("1", OrderState::under_way, 12, 0);
  hear("2", OrderState::under_way, 13, 0);
  hear("2", OrderState::done, 13, 25);
  hear("2", OrderState::done, 13, 25);
  hear("3", OrderState::failed, 0, 11);
  fleet.hear(OrderStatus{.order = {.id = "4", .action = Action::stop}});
  const std::string text = metrics_text(fleet.view, {}, fleet.now);
  for (const char* line : {"coppice_orders{state=\"accepted\"} 0", "coppice_orders{state=\"under_way\"} 1",
                           "coppice_orders_ended_total{state=\"done\"} 1",
                           "coppice_orders_ended_total{state=\"failed\"} 1", "coppice_orders_late_total 1",
                           "coppice_orders_set_out_total 1", "coppice_order_waited_seconds_total 3",
                           "coppice_order_under_way_seconds_total 12", "coppice_utilisation 1"})
    EXPECT_TRUE(has_line(text, line)) << line << "\n" << text;
}

TEST(Metrics, UnknownValuesAreLeftOut) {
  const std::string text = metrics_text(FleetView(), {}, 0);
  EXPECT_TRUE(has_line(text, "coppice_robots 0"));
  EXPECT_EQ(text.find("coppice_separation_meters"), std::string::npos);
  EXPECT_EQ(text.find("coppice_robot_"), std::string::npos);
  EXPECT_EQ(text.find("coppice_broker_"), std::string::npos);
}

TEST(Metrics, RobotsBeyondTheFirst500CountOnlyInTheSums) {
  test::SeenFleet fleet;
  for (int k = 0; k < 700; ++k) {
    fleet.mission("robot" + std::to_string(k));
    fleet.status("robot" + std::to_string(k), Phase::driving);
  }
  const std::string text = metrics_text(fleet.view, {}, fleet.now);
  EXPECT_TRUE(has_line(text, "coppice_robots 700"));
  EXPECT_TRUE(has_line(text, "coppice_robots_in_phase{phase=\"driving\"} 700"));
  EXPECT_EQ(lines_of(text, "coppice_robot_driven_meters"), 500);
}

TEST(Metrics, NamesOfRobotsAreEscaped) {
  test::SeenFleet fleet;
  fleet.mission("a\"b\\c");
  fleet.status("a\"b\\c", Phase::driving);
  EXPECT_NE(metrics_text(fleet.view, {}, fleet.now).find(R"({robot="a\"b\\c"})"), std::string::npos);
}

TEST(Metrics, TheDashboardAndTheAlertsUseExistingMetrics) {
  test::SeenFleet fleet;
  fleet.mission("a");
  fleet.mission("b");
  fleet.state("a", {1, 1});
  fleet.state("b", {2, 1});
  fleet.status("a", Phase::driving);
  fleet.hear(BrokerStatus{.broker = 1});
  const std::string text = metrics_text(fleet.view, {}, fleet.now);
  const std::filesystem::path deploy = std::filesystem::path(COPPICE_SOURCE_DIR) / "deploy";
  const std::string asked =
      test::contents(deploy / "grafana-dashboard.json") + test::contents(deploy / "prometheus-alerts.yml");
  const std::regex name("(coppice|process)_[a-z_]+");
  std::size_t seen = 0;
  for (std::sregex_iterator it(asked.begin(), asked.end(), name); it != std::sregex_iterator(); ++it, ++seen)
    EXPECT_GT(lines_of(text, it->str()), 0) << it->str();
  EXPECT_GT(seen, 40u);
}

TEST(Metrics, EveryMetricHasHelpAndAType) {
  test::SeenFleet fleet;
  fleet.mission("a");
  fleet.status("a", Phase::driving);
  const std::string text = "\n" + metrics_text(fleet.view, {}, fleet.now);
  const std::regex sample("\n([a-z_]+)[ {]");
  std::size_t seen = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), sample); it != std::sregex_iterator();
       ++it, ++seen) {
    EXPECT_NE(text.find("\n# HELP " + it->str(1) + " "), std::string::npos) << it->str(1);
    const bool counter = text.find("\n# TYPE " + it->str(1) + " counter") != std::string::npos;
    EXPECT_EQ(counter, it->str(1).ends_with("_total")) << it->str(1);
  }
  EXPECT_GT(seen, 25u);
}

TEST(Metrics, EachRobotReportsItsPhaseItsWayAndItsWaits) {
  test::SeenFleet fleet;
  fleet.map();
  fleet.mission("a");
  fleet.path("a", {{0.5, 1.5}, {3.5, 1.5}});
  fleet.state("a", {1.5, 1.5});
  fleet.status("a", Phase::driving);
  fleet.now += 2;
  RobotState waits = *fleet.view.robots()[0].state;
  waits.promise.stamp += 2;
  waits.waits_for = "b";
  fleet.hear(waits);
  fleet.now += 3;
  const std::string text = metrics_text(fleet.view, {}, fleet.now);
  for (const char* line :
       {"coppice_robot_phase{robot=\"a\",phase=\"driving\"} 1",
        "coppice_robot_phase{robot=\"a\",phase=\"no_path\"} 0",
        "coppice_robot_way_to_go_meters{robot=\"a\"} 2", "coppice_robot_waiting_seconds{robot=\"a\"} 3",
        "coppice_robot_waited_seconds_total{robot=\"a\"} 3",
        "coppice_robot_without_progress_seconds{robot=\"a\"} 5", "coppice_fleet_alive 1",
        "coppice_run_ended 0"})
    EXPECT_TRUE(has_line(text, line)) << line << "\n" << text;
  EXPECT_EQ(lines_of(text, "coppice_robot_phase"), 8);
  fleet.end_of_run("a");
  const std::string ended = metrics_text(fleet.view, {}, fleet.now);
  EXPECT_TRUE(has_line(ended, "coppice_run_ended 1")) << ended;
  EXPECT_TRUE(has_line(ended, "coppice_fleet_alive 0")) << ended;
}

TEST(Metrics, TheMonitorOfARecordingReportsNothingOfABus) {
  const std::string text =
      metrics_text(FleetView(), {.has_bus = false, .processor_seconds = 0.5, .resident_bytes = 1000}, 0);
  EXPECT_EQ(lines_of(text, "coppice_monitor_rejected_messages_total"), 0);
  EXPECT_TRUE(has_line(text, "process_cpu_seconds_total 0.5"));
  EXPECT_TRUE(has_line(text, "process_resident_memory_bytes 1000"));
}

}  // namespace
}  // namespace coppice
