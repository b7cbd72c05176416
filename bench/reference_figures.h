// Figures of other planners for the same scenarios, from a file: for the tables of `coppice bench
// throughput`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace coppice {

/// Absent figures are not known.
struct ReferenceFigures {
  std::string scenario;  ///< name of its file, without folder and ending
  std::string planner;
  std::optional<double> sum;             ///< of the robots' arrival times, seconds
  std::optional<double> last;            ///< arrival, seconds
  std::optional<double> goals_a_second;  ///< where each robot that arrives gets a new goal
};

/// Reads CSV with the header line `scenario,planner,sum,last,goals_per_second`. Throws InputError, which
/// names the file and the line.
std::vector<ReferenceFigures> read_reference_figures(const std::filesystem::path& path);

}  // namespace coppice
