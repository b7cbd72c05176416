#include "files/report_file.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>

#include "coppice/files/input_error.h"
#include "files/text_file.h"

namespace coppice {

namespace {

constexpr double worth_telling = 0.01;  // share of the control periods from which the table reports misses
constexpr std::string_view no_robots = "\"robots\": []";

std::string json_of(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string json;
  if (const auto status = google::protobuf::util::MessageToJsonString(message, &json, options); !status.ok())
    throw InputError(fmt::format("the report cannot be written as JSON: {}", std::string(status.message())));
  json.erase(json.find_last_not_of('\n') + 1);
  return json;
}

/// Indents a robot's JSON to its depth in the list.
std::string indented(const std::string& json) {
  std::string result;
  for (const char c : "  " + json) {
    result += c;
    if (c == '\n') result += "  ";
  }
  return result;
}

/// Names the robot whose agent missed the largest share of its control periods. Empty for fewer than two
/// robots.
std::string worst_of(const proto::Report& report) {
  const auto worst = std::ranges::max_element(report.robots(), {}, &proto::Report::Robot::periods_missed);
  if (report.robots_size() < 2) return {};
  return fmt::format(" (of {}: {:.1f} %)", worst->name(), 100 * worst->periods_missed());
}

}  // namespace

/// Prints one robot at a time: Protobuf first builds a tree of all that it prints, which took 8 MB for 200
/// robots at once.
std::string report_json(const proto::Report& report) {
  proto::Report of_all = report;
  of_all.clear_robots();
  const std::string frame = json_of(of_all);
  const std::size_t found = frame.find(no_robots);
  if (found == std::string::npos) throw std::logic_error("Protobuf prints empty lists otherwise");
  const std::size_t gap = found + no_robots.size() - 1;  // position before the closing bracket
  std::string json = frame.substr(0, gap);
  for (const proto::Report::Robot& robot : report.robots()) {
    if (json.size() > gap) json += ',';
    json += '\n' + indented(json_of(robot));
  }
  return json + frame.substr(gap) + '\n';
}

void write_report(const std::filesystem::path& path, const proto::Report& report) {
  write_file(path, report_json(report));
}

proto::Report read_report(const std::filesystem::path& path) {
  proto::Report report;
  const auto status = google::protobuf::util::JsonStringToMessage(read_file(path), &report);
  if (!status.ok()) throw InputError(fmt::format("{}: {}", path.string(), std::string(status.message())));
  return report;
}

std::string report_table(const proto::Report& report) {
  int planned = 0;
  int arrived = 0;
  int name_width = 5;
  for (const auto& robot : report.robots()) {
    planned += robot.planned();
    arrived += robot.arrived();
    name_width = std::max(name_width, static_cast<int>(robot.name().size()));
  }
  const int n = report.robots_size();
  std::string table = fmt::format("{}: {} of {} robots have a path, {} of {} arrived\n", report.outcome(),
                                  planned, n, arrived, n);
  if (static_cast<int>(report.missions()) > n)
    table += fmt::format("{} missions fulfilled\n", report.missions());
  if (report.robots_without_goal() > 0)
    table += fmt::format("robots that arrived and got no new goal: {}\n", report.robots_without_goal());
  table += fmt::format(
      "plan time {:.3f} s, shorter paths after {:.3f} s, run time {:.2f} s, mean path length {:.1f} m\n",
      report.plan_time(), report.improve_time(), report.run_time(), report.path_length());
  table += fmt::format("nodes {} valid, {} invalid; trees {} published, {} grafted\n", report.nodes_valid(),
                       report.nodes_invalid(), report.trees_published(), report.trees_grafted());
  if (report.periods_missed() >= worth_telling)
    table += fmt::format(
        "control periods missed {:.1f} %{}: robots wait where their agents get too little processor time "
        "(fewer robots, a lower --time-scale, or more processors)\n",
        100 * report.periods_missed(), worst_of(report));
  const auto metres = [](bool there, double value) {
    const double rounded = std::round(1e3 * value) / 1e3 + 0.0;  // turns -0.0 into 0.0
    return there ? fmt::format("{:.3f} m", rounded) : std::string("-");
  };
  table += fmt::format("collisions {}, least separation {}, least clearance {}{}\n\n", report.collisions(),
                       metres(report.has_least_separation(), report.least_separation()),
                       metres(report.has_least_clearance(), report.least_clearance()),
                       report.margin() > 0 ? ", margin " + metres(true, report.margin()) : "");
  const bool some_turn =
      std::ranges::any_of(report.robots(), [](const auto& robot) { return robot.has_yaw(); });
  table += fmt::format("{:<{}}  {:>8}  {:>9}  {:>8}  {:>9}  {:>7}  {:>7}  {:>7}{}\n", "robot", name_width,
                       "plan s", "run s", "path m", "driven m", "valid", "invalid", "grafted",
                       some_turn ? "    yaw" : "");
  for (const auto& robot : report.robots()) {
    const std::string run = robot.arrived() ? fmt::format("{:.2f}", robot.run_time()) : "-";
    table += fmt::format("{:<{}}  {:>8.4f}  {:>9}  {:>8.1f}  {:>9.1f}  {:>7}  {:>7}  {:>7}", robot.name(),
                         name_width, robot.plan_time(), run, robot.path_length(), robot.driven_length(),
                         robot.nodes_valid(), robot.nodes_invalid(), robot.grafted_trees());
    if (some_turn) table += robot.has_yaw() ? fmt::format("  {:>5.2f}", robot.yaw()) : "      -";
    table += robot.reason().empty() ? "\n" : fmt::format("  {}\n", robot.reason());
  }
  return table;
}

}  // namespace coppice
