#include <array>
#include <optional>

#include <fmt/format.h>

#include "bench/experiments.h"
#include "bench/output.h"
#include "bench/statistics.h"
#include "bench/trial.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

namespace {

constexpr double speed = 20;            // metres per second
constexpr double longest_drive = 1200;  // fleet seconds
constexpr double longest_search = 10;   // seconds: of plain MA-RRdT* for the fleet, of RRT* for a robot

/// A planner of the experiment.
struct Contender {
  const char* name;
  PlannerKind kind;
  /// With the paper's plain parameters, and with first paths that are only straightened.
  bool is_plain;

  bool improves() const { return kind == PlannerKind::ma_rrdt_star && !is_plain; }
};
const std::array<Contender, 3> contenders{{{"MA-RRdT*", PlannerKind::ma_rrdt_star, false},
                                           {"plain MA-RRdT*", PlannerKind::ma_rrdt_star, true},
                                           {"MA-RRT*", PlannerKind::rrt_star, false}}};

/// The paper's measures of one run.
struct Measures {
  double plan_seconds = 0;
  std::optional<double> run_seconds{};  ///< fleet time until the last robot arrived; none: not all did
  double path_length = 0;               ///< mean over the robots with a path
  double nodes = 0;                     ///< valid and invalid
  double invalid = 0;
  int solved = 0;
};

/// Drives the fleet in the simulation, with paths of the contender. Not with the plain one: where its trees
/// find no way, they grow without bound, and so slowly that a run takes hours. Nor if a robot has no path:
/// its agent would search as long again, whenever it looks for a path.
std::optional<double> run_time(const TrialCase& trial, const Contender& contender, bool all_solved,
                               std::uint64_t seed) {
  if (contender.is_plain || !all_solved) return std::nullopt;
  Scenario scenario{
      .map_name = trial.map, .map = trial.occupancy, .seed = static_cast<std::uint32_t>(seed), .robots = {}};
  for (std::size_t i = 0; i < trial.problems.size(); ++i) {
    const PlanningProblem& p = trial.problems[i];
    scenario.robots.push_back({fmt::format("r{}", i + 1), p.start, p.goal, p.radius, speed, 2 * speed, 1});
  }
  FleetSimulation simulation(
      scenario,
      {.timeout = longest_drive, .planner = contender.kind, .plan_budget = contender.improves() ? 1.0 : 0.0});
  simulation.run([](const PlannerService&, double) { return true; });
  const proto::Report report = simulation.service().report();
  return report.outcome() == "arrived" ? std::optional(report.run_time()) : std::nullopt;
}

TrialResult planned(const TrialCase& trial, const Contender& contender, std::uint64_t seed) {
  if (contender.kind == PlannerKind::rrt_star) return run_ma_rrt_star(trial, seed, longest_search);
  if (!contender.is_plain) return run_ma_rrdt_star(trial, seed);
  return run_ma_rrdt_star(trial, seed, plain_parameters(static_cast<std::uint32_t>(trial.problems.size())),
                          Improvement::until_taut, longest_search);
}

Measures measures(const TrialResult& result) {
  Measures m{.plan_seconds = result.first_seconds, .solved = result.solved()};
  for (const double length : result.lengths) m.path_length += length;
  if (m.solved > 0) m.path_length /= m.solved;
  m.nodes = static_cast<double>(result.valid_nodes + result.invalid_nodes);
  m.invalid = static_cast<double>(result.invalid_nodes);
  return m;
}

struct Column {
  std::string name;
  std::optional<double> (*value)(const Measures&);
  bool logarithmic;
};
const std::vector<Column> columns{
    {"plan time, s", [](const Measures& m) { return std::optional(m.plan_seconds); }, true},
    {"run time, s", [](const Measures& m) { return m.run_seconds; }, false},
    {"path length, m", [](const Measures& m) { return std::optional(m.path_length); }, false},
    {"nodes", [](const Measures& m) { return std::optional(m.nodes); }, true}};

std::optional<double> invalid_nodes(const Measures& m) {
  return m.invalid;
}

/// The values of the runs that have one.
std::vector<double> values_of(const std::vector<Measures>& runs,
                              std::optional<double> (*value)(const Measures&)) {
  std::vector<double> values;
  for (const Measures& m : runs) {
    if (const auto v = value(m)) values.push_back(*v);
  }
  return values;
}

std::string mean_and_spread(const std::vector<Measures>& runs,
                            std::optional<double> (*value)(const Measures&)) {
  const std::vector<double> values = values_of(runs, value);
  if (values.empty()) return "-";
  const std::string text = fmt::format("{:.4g} ± {:.2g}", mean(values), deviation(values));
  return values.size() == runs.size() ? text : fmt::format("{} ({} of {})", text, values.size(), runs.size());
}

}  // namespace

void bench_paper(const ExperimentOptions& options) {
  Table trials{{"map", "robots", "seed", "planner", "plan_s", "run_s", "path_length", "nodes_valid",
                "nodes_invalid", "solved"},
               {}};
  Table means{{"map", "robots", "planner", "plan time s", "run time s", "path length m", "nodes",
               "of these invalid", "solved"},
              {}};
  std::vector<Plot> plots;
  for (const std::string& source : options.maps) {
    const std::string map = map_title(source);
    std::vector<Series> of_all;
    for (const Contender& contender : contenders) of_all.push_back({contender.name, {}, {}, {}});
    std::vector<std::vector<Series>> series(columns.size(), of_all);
    for (const int robots : options.robots) {
      std::array<std::vector<Measures>, contenders.size()> runs;
      const auto measure = [&](std::uint64_t seed) {
        const TrialCase trial = make_case(source, options.side, robots, options.radius, seed);
        for (std::size_t c = 0; c < contenders.size(); ++c) {
          const TrialResult result = planned(trial, contenders[c], seed);
          Measures m = measures(result);
          m.run_seconds = run_time(trial, contenders[c], m.solved == robots, seed);
          trials.rows.push_back({map, std::to_string(robots), std::to_string(seed), contenders[c].name,
                                 fmt::format("{:.6f}", m.plan_seconds),
                                 m.run_seconds ? fmt::format("{:.2f}", *m.run_seconds) : "",
                                 fmt::format("{:.1f}", m.path_length), std::to_string(result.valid_nodes),
                                 std::to_string(result.invalid_nodes), std::to_string(m.solved)});
          runs[c].push_back(m);
        }
        options.tell(fmt::format("{} {} robots, seed {}", map, robots, seed));
      };
      for (int k = 0; k < options.seeds_on(source) && !options.stop(); ++k) {
        const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(k);
        if (!succeeds(options, source, robots, [&] { measure(seed); })) break;
      }
      if (runs.back().empty()) continue;
      for (std::size_t p = 0; p < runs.size(); ++p) {
        std::vector<std::string> row{map, std::to_string(robots), series[0][p].name};
        for (std::size_t c = 0; c < columns.size(); ++c) {
          row.push_back(mean_and_spread(runs[p], columns[c].value));
          const std::vector<double> values = values_of(runs[p], columns[c].value);
          if (values.empty()) continue;
          series[c][p].x.push_back(robots);
          series[c][p].y.push_back(mean(values));
          series[c][p].spread.push_back(deviation(values));
        }
        row.push_back(mean_and_spread(runs[p], invalid_nodes));
        int solved = 0;
        for (const Measures& m : runs[p]) solved += m.solved;
        row.push_back(fmt::format("{} of {}", solved, robots * static_cast<int>(runs[p].size())));
        means.rows.push_back(row);
      }
    }
    for (std::size_t c = 0; c < columns.size(); ++c)
      plots.push_back({map, "robots", columns[c].name, columns[c].logarithmic, series[c]});
    write_experiment(options, "paper", trials, means, plots, static_cast<int>(columns.size()));
  }
  options.tell(as_markdown(means));
}

}  // namespace coppice
