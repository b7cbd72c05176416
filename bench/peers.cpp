#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "bench/experiments.h"
#include "bench/output.h"
#include "bench/statistics.h"
#include "bench/trial.h"
#include "coppice/files/input_error.h"

namespace coppice {

namespace {

constexpr double close_to_shortest = 1.03;
constexpr double infinity = std::numeric_limits<double>::infinity();
const std::vector<std::string> ompl_planners{"RRTConnect", "BiEST", "RRTstar", "BITstar"};

/// The results of one planner on one map with one number of robots.
struct Row {
  std::vector<double> first_ms;
  std::vector<double> simplified_ms;
  std::vector<double> second_ms;
  std::vector<double> close_ms;  ///< until within 1.03 of the shortest known length, for trials that reach it
  std::vector<double> first_ratio;
  std::vector<double> ratio;
  std::vector<double> nodes;
  int solved = 0;
  int robots = 0;
  int trials = 0;
};

/// Seconds until the fleet's length is within 1.03 of the shortest known one; below 0: never.
double seconds_to_close(const TrialResult& result, double shortest) {
  for (const auto& [seconds, length] : result.progress) {
    if (length <= close_to_shortest * shortest) return seconds;
  }
  double length = 0;
  for (const double l : result.lengths) length += l;
  const bool whole = result.solved() == static_cast<int>(result.lengths.size());
  return result.progress.empty() && whole && length <= close_to_shortest * shortest
             ? result.simplified_seconds
             : -1;
}

TrialResult run_planner(std::size_t which, const TrialCase& trial, std::uint64_t seed, double cap) {
  switch (which) {
    case 0:
      return run_ma_rrdt_star(trial, seed);
    case 1:
      return run_visibility_graph(trial);
    case 2:
      return run_grid_a_star(trial);
    case 3:
      return run_jump_point_search(trial);
    default:
      return run_ompl(ompl_planners[which - 4], trial, seed, cap);
  }
}

/// The order of the planners changes with the seed. Those that may need only microseconds run twice, because
/// the first time finds cold caches; the second time counts.
std::vector<TrialResult> run_all(const TrialCase& trial, std::uint64_t seed, double cap) {
  constexpr std::size_t quick = 2;
  const std::size_t count = 4 + ompl_planners.size();
  std::vector<TrialResult> results(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t turn = (k + seed) % count;
    if (turn < quick) static_cast<void>(run_planner(turn, trial, seed, cap));
    results[turn] = run_planner(turn, trial, seed, cap);
  }
  return results;
}

void add(Row& row, const TrialResult& result, const std::vector<TrialResult>& all) {
  // Compares a planner only on the robots that it solved.
  double shortest = 0;
  double first = 0;
  double last = 0;
  for (std::size_t i = 0; i < result.lengths.size(); ++i) {
    if (result.lengths[i] <= 0) continue;
    double least = result.lengths[i];
    for (const TrialResult& other : all) {
      if (other.lengths[i] > 0) least = std::min(least, other.lengths[i]);
    }
    shortest += least;
    first += result.first_lengths[i];
    last += result.lengths[i];
  }
  row.first_ms.push_back(1e3 * result.first_seconds);
  row.simplified_ms.push_back(1e3 * result.simplified_seconds);
  if (result.second_seconds >= 0) row.second_ms.push_back(1e3 * result.second_seconds);
  if (shortest > 0) {
    row.first_ratio.push_back(first / shortest);
    row.ratio.push_back(last / shortest);
  }
  const double close = seconds_to_close(result, shortest_known(all));
  if (close >= 0) row.close_ms.push_back(1e3 * close);
  row.nodes.push_back(static_cast<double>(result.valid_nodes));
  row.solved += result.solved();
  row.robots += static_cast<int>(result.lengths.size());
  ++row.trials;
}

std::string number(double v) {
  return v >= 100 ? fmt::format("{:.0f}", v) : fmt::format("{:.3g}", v);
}

/// The median, with the quartiles.
std::string spread(const std::vector<double>& values) {
  if (values.empty()) return "-";
  return fmt::format("{} ({} to {})", number(median(values)), number(quantile(values, 0.25)),
                     number(quantile(values, 0.75)));
}

}  // namespace

void bench_peers(const ExperimentOptions& options) {
  if (!built_with_ompl())
    throw InputError(
        "bench peers: built without OMPL; install libompl-dev (deploy/install --bench) and build again");
  Table trials{{"map", "robots", "seed", "planner", "first_s", "simplified_s", "second_s", "close_s",
                "first_length", "length", "shortest_known", "nodes", "solved"},
               {}};
  Table medians{{"map", "robots", "planner", "first ms", "simplified ms", "within 1.03 ms", "second tasks ms",
                 "first / best peer", "within 1.03 / A*", "length first", "length", "nodes", "solved"},
                {}};
  std::vector<Plot> plots;
  for (const std::string& source : options.maps) {
    const std::string map = map_title(source);
    std::vector<Series> series;
    for (const int robots : options.robots) {
      std::vector<std::string> names;
      std::map<std::string, Row> rows;
      const auto measure = [&](std::uint64_t seed) {
        const TrialCase trial = make_case(source, options.side, robots, options.radius, seed);
        const std::vector<TrialResult> results = run_all(trial, seed, options.cap);
        const double shortest = shortest_known(results);
        for (const TrialResult& result : results) {
          if (!rows.contains(result.planner)) names.push_back(result.planner);
          add(rows[result.planner], result, results);
          double first = 0;
          double last = 0;
          for (const double l : result.first_lengths) first += l;
          for (const double l : result.lengths) last += l;
          trials.rows.push_back(
              {map, std::to_string(robots), std::to_string(seed), result.planner,
               fmt::format("{:.9f}", result.first_seconds), fmt::format("{:.9f}", result.simplified_seconds),
               result.second_seconds >= 0 ? fmt::format("{:.9f}", result.second_seconds) : "",
               fmt::format("{:.6f}", seconds_to_close(result, shortest)), fmt::format("{:.1f}", first),
               fmt::format("{:.1f}", last), fmt::format("{:.1f}", shortest),
               std::to_string(result.valid_nodes), std::to_string(result.solved())});
        }
        options.tell(fmt::format("{} {} robots, seed {}", map, robots, seed));
      };
      for (int k = 0; k < options.seeds && !options.stop(); ++k) {
        const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(k);
        if (!succeeds(options, source, robots, [&] { measure(seed); })) break;
      }
      if (rows.empty()) continue;
      double best_peer = infinity;  // of those that solved every robot
      for (const auto& [name, row] : rows) {
        if (name != "MA-RRdT*" && row.solved == row.robots)
          best_peer = std::min(best_peer, median(row.first_ms));
      }
      const double a_star = median(rows["grid A*"].simplified_ms);
      for (std::size_t p = 0; p < names.size(); ++p) {
        const Row& row = rows[names[p]];
        const bool always_close = static_cast<int>(row.close_ms.size()) == row.trials;
        medians.rows.push_back(
            {map, std::to_string(robots), names[p], spread(row.first_ms), spread(row.simplified_ms),
             always_close ? spread(row.close_ms) : fmt::format("{} of {}", row.close_ms.size(), row.trials),
             spread(row.second_ms),
             best_peer < infinity ? fmt::format("{:.3f}", median(row.first_ms) / best_peer) : "-",
             always_close ? fmt::format("{:.3f}", median(row.close_ms) / a_star) : "-",
             fmt::format("{:.3f}", median(row.first_ratio)), fmt::format("{:.3f}", median(row.ratio)),
             number(median(row.nodes)), fmt::format("{} of {}", row.solved, row.robots)});
        if (series.size() <= p) series.push_back({names[p], {}, {}, {}});
        series[p].x.push_back(robots);
        series[p].y.push_back(median(row.first_ms));
      }
    }
    plots.push_back({map, "robots", "first paths, ms", true, series});
    write_experiment(options, "peers", trials, medians, plots, 2);
  }
  options.tell(as_markdown(medians));
}

}  // namespace coppice
