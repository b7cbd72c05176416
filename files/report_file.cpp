#include "files/report_file.h"

#include <algorithm>

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>

#include "files/input_error.h"
#include "files/text_file.h"

namespace coppice {

void write_report(const std::filesystem::path& path, const proto::Report& report) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string json;
  if (!google::protobuf::util::MessageToJsonString(report, &json, options).ok()) {
    throw InputError(fmt::format("{}: the report cannot be written as JSON", path.string()));
  }
  write_file(path, json);
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
  table += fmt::format(
      "plan time {:.3f} s, shorter paths after {:.3f} s, run time {:.2f} s, mean path length {:.1f} m\n",
      report.plan_time(), report.improve_time(), report.run_time(), report.path_length());
  table += fmt::format("nodes {} valid, {} invalid; trees {} published, {} grafted\n", report.nodes_valid(),
                       report.nodes_invalid(), report.trees_published(), report.trees_grafted());
  const auto metres = [](bool there, double value) {
    return there ? fmt::format("{:.3f} m", value) : std::string("-");
  };
  table += fmt::format("collisions {}, least separation {}, least clearance {}\n\n", report.collisions(),
                       metres(report.has_least_separation(), report.least_separation()),
                       metres(report.has_least_clearance(), report.least_clearance()));
  table += fmt::format("{:<{}}  {:>8}  {:>9}  {:>8}  {:>9}  {:>7}  {:>7}  {:>7}\n", "robot", name_width,
                       "plan s", "run s", "path m", "driven m", "valid", "invalid", "grafted");
  for (const auto& robot : report.robots()) {
    const std::string run = robot.arrived() ? fmt::format("{:.2f}", robot.run_time()) : "-";
    table += fmt::format("{:<{}}  {:>8.4f}  {:>9}  {:>8.1f}  {:>9.1f}  {:>7}  {:>7}  {:>7}", robot.name(),
                         name_width, robot.plan_time(), run, robot.path_length(), robot.driven_length(),
                         robot.nodes_valid(), robot.nodes_invalid(), robot.grafted_trees());
    table += robot.reason().empty() ? "\n" : fmt::format("  {}\n", robot.reason());
  }
  return table;
}

}  // namespace coppice
