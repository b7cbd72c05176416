#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "bench/centralised.h"
#include "bench/experiments.h"
#include "bench/output.h"
#include "bench/reference_figures.h"
#include "bench/statistics.h"
#include "coppice/files/scenario_file.h"
#include "coppice/motion/kinematics.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

namespace {

constexpr std::size_t most_nodes_of_cbs = 20'000;  // about ten seconds

struct Flow {
  std::size_t arrived = 0;
  bool touched = false;
  double sum = 0;        ///< of the arrival times, seconds
  double last = 0;       ///< arrival, seconds
  double free_flow = 0;  ///< sum of the times that the robots' paths take with nobody in the way
  double goals_a_second = 0;
  WaitTimes waits;             ///< sums over the robots
  std::vector<double> moving;  ///< by second: share of the robots under way that move
};

/// The waits of all missions, and the goals that were reached in time, from the agents' statuses.
class StatusLog {
 public:
  void hear(const Message& message, double lifelong) {
    const auto* const status = std::get_if<AgentStatus>(&message);
    if (status == nullptr) return;
    const std::pair key{status->robot, status->mission};
    waits_[key] = status->waits;
    if (status->phase == Phase::arrived && status->arrival_time <= lifelong) reached_.insert(key);
  }
  std::size_t reached() const { return reached_.size(); }
  WaitTimes waits() const {
    WaitTimes all;
    for (const auto& [mission, waits] : waits_) {
      for (const auto kind : wait_kinds) all.*kind += waits.*kind;
    }
    return all;
  }

 private:
  std::map<std::pair<RobotName, std::uint32_t>, WaitTimes> waits_;
  std::set<std::pair<RobotName, std::uint32_t>> reached_;
};

/// By second, of the robots that have not arrived by then.
std::vector<double> moving_shares(const Scenario& scenario, std::span<const NamedTrack> tracks,
                                  const proto::Report& report) {
  std::vector<int> moving;
  std::vector<int> under_way;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const proto::Report::Robot& row = report.robots(static_cast<int>(i));
    for (const TrackPoint& point : tracks[i].track.points) {
      if (point.time < 0 || (row.arrived() && point.time >= row.run_time())) continue;
      const auto second = static_cast<std::size_t>(point.time);
      if (second >= moving.size()) {
        moving.resize(second + 1);
        under_way.resize(second + 1);
      }
      ++under_way[second];
      moving[second] += point.velocity.norm() >= waiting_speed_share * scenario.robots[i].max_speed;
    }
  }
  std::vector<double> shares;
  for (std::size_t k = 0; k < moving.size(); ++k)
    shares.push_back(under_way[k] > 0 ? static_cast<double>(moving[k]) / under_way[k] : 0);
  return shares;
}

Flow simulated(const Scenario& scenario, double lifelong, const std::function<bool()>& stop) {
  FleetSimulation simulation(scenario, {.lifelong = lifelong});
  StatusLog log;
  simulation.set_listener([&](const Message& message, double) { log.hear(message, lifelong); });
  simulation.run([&](const PlannerService&, double) { return !stop(); });
  const std::vector<NamedTrack>& tracks = simulation.tracks();
  const proto::Report report = simulation.service().report(in_parts(tracks));
  Flow flow{.touched = report.collisions() > 0,
            .last = report.run_time(),
            .goals_a_second = lifelong > 0 ? static_cast<double>(log.reached()) / lifelong : 0,
            .waits = log.waits(),
            .moving = moving_shares(scenario, tracks, report)};
  for (const auto& robot : report.robots()) {
    flow.arrived += robot.arrived();
    flow.sum += robot.run_time();
    flow.free_flow += robot.free_flow_time();
  }
  return flow;
}

/// Sum of the times that the robots would take on straight lines to their goals: no plan is faster.
double straight_drive(const Scenario& scenario) {
  double sum = 0;
  for (const RobotTask& robot : scenario.robots)
    sum += std::max(0.0, (robot.goal - robot.start).norm() - robot.goal_tolerance) / robot.max_speed;
  return sum;
}

/// The trials of one scenario.
class Row {
 public:
  Row(std::string scenario, std::size_t robots, double straight)
      : scenario_(std::move(scenario)), robots_(robots), straight_(straight) {}

  void add(Flow flow) { flows_.push_back(std::move(flow)); }
  bool empty() const { return flows_.empty(); }

  std::vector<std::string> trial(std::uint64_t seed) const {
    const Flow& f = flows_.back();
    std::vector<std::string> cells{scenario_, std::to_string(robots_), std::to_string(seed),
                                   std::to_string(f.arrived), std::to_string(static_cast<int>(f.touched))};
    for (const double value : {f.sum, f.last, straight_, f.free_flow})
      cells.push_back(fmt::format("{:.3f}", value));
    for (const auto kind : wait_kinds) cells.push_back(fmt::format("{:.3f}", f.waits.*kind));
    cells.push_back(fmt::format("{:.3f}", f.goals_a_second));
    return cells;
  }

  std::vector<std::string> summary(std::span<const ReferenceFigures> references, bool lifelong) const {
    const double sum = median_of([](const Flow& f) { return f.sum; });
    const double last = median_of([](const Flow& f) { return f.last; });
    const double goals = median_of([](const Flow& f) { return f.goals_a_second; });
    const auto wait = [&](double WaitTimes::*kind) {
      return fmt::format("{:.0f}", median_of([&](const Flow& f) { return f.waits.*kind; }));
    };
    const auto all_well =
        std::ranges::count_if(flows_, [&](const Flow& f) { return f.arrived == robots_ && !f.touched; });
    std::vector<std::string> cells{scenario_, std::to_string(robots_),
                                   fmt::format("{} of {}", all_well, flows_.size())};
    if (lifelong) {
      cells.push_back(fmt::format("{:.2f}", goals));
      cells.push_back(ratios(references, goals, &ReferenceFigures::goals_a_second));
    } else {
      cells.push_back(fmt::format("{:.0f}", sum));
      cells.push_back(fmt::format("{:.0f}", last));
      cells.push_back(fmt::format("{:.2f}", sum / straight_));
      cells.push_back(fmt::format("{:.2f}", sum / median_of([](const Flow& f) { return f.free_flow; })));
      cells.push_back(ratios(references, sum, &ReferenceFigures::sum));
      cells.push_back(ratios(references, last, &ReferenceFigures::last));
    }
    for (const auto kind : {&WaitTimes::startup, &WaitTimes::planning, &WaitTimes::reservation,
                            &WaitTimes::joint_plan, &WaitTimes::gate, &WaitTimes::promise})
      cells.push_back(wait(kind));
    return cells;
  }

  /// The plot shows the first trial.
  Plot plot() const {
    Series series{"of the robots under way", {}, {}, {}};
    for (std::size_t second = 0; second < flows_.front().moving.size(); ++second) {
      series.x.push_back(static_cast<double>(second));
      series.y.push_back(100 * flows_.front().moving[second]);
    }
    return {scenario_, "fleet seconds", "robots that move, %", false, {series}};
  }

  static Table trials_table() {
    return {{"scenario", "robots", "seed", "arrived", "touched", "sum_s", "last_s", "straight_s",
             "free_flow_s", "startup_s", "planning_s", "reservation_s", "joint_plan_s", "gate_s", "promise_s",
             "connection_s", "odometry_s", "goals_per_second"},
            {}};
  }
  static Table summary_table(bool lifelong) {
    std::vector<std::string> header{"scenario", "robots", "all arrived, none touched"};
    const std::vector<std::string> figures =
        lifelong ? std::vector<std::string>{"goals per second", "times those of"}
                 : std::vector<std::string>{"sum s",
                                            "last s",
                                            "sum / straight",
                                            "sum / free flow",
                                            "sum, times that of",
                                            "last, times that of"};
    header.insert(header.end(), figures.begin(), figures.end());
    for (const char* kind : {"startup", "planning", "reservation", "joint plan", "gate", "promise"})
      header.push_back(fmt::format("waits s: {}", kind));
    return {header, {}};
  }

 private:
  template <class Fn>
  double median_of(Fn&& value) const {
    std::vector<double> values;
    for (const Flow& flow : flows_) values.push_back(value(flow));
    return median(values);
  }
  std::string ratios(std::span<const ReferenceFigures> references, double value,
                     std::optional<double> ReferenceFigures::*figure) const {
    std::string text;
    for (const ReferenceFigures& reference : references) {
      if (reference.scenario != scenario_ || !(reference.*figure)) continue;
      text += fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", reference.planner,
                          value / *(reference.*figure));
    }
    return text.empty() ? "-" : text;
  }

  std::string scenario_;
  std::size_t robots_;
  double straight_;
  std::vector<Flow> flows_;
};

/// Adds what centralised planners reach on this scenario.
void add_centralised(std::vector<ReferenceFigures>& references, const std::string& name,
                     const Scenario& scenario, const ExperimentOptions& options) {
  const auto add = [&](std::optional<ReferenceFigures> figures, const char* otherwise) {
    if (!figures) {
      options.tell(fmt::format("{}: no figures of {}", name, otherwise));
      return;
    }
    figures->scenario = name;
    references.push_back(*figures);
  };
  add(prioritised_planning(scenario), "prioritised planning: in each order a robot finds no trajectory");
  if (is_for_conflict_based_search(scenario))
    add(conflict_based_search(scenario, most_nodes_of_cbs), "conflict-based search: it needs too many nodes");
}

}  // namespace

bool bench_throughput(const ExperimentOptions& options, const ThroughputSettings& settings) {
  const bool is_lifelong = settings.lifelong > 0;
  std::vector<ReferenceFigures> references;
  if (!settings.references.empty()) references = read_reference_figures(settings.references);
  std::vector<Scenario> scenarios;  // a bad file is told before hours of measuring
  for (const std::string& file : settings.scenarios)
    scenarios.push_back(
        read_scenario(file, {.radius = settings.radius, .max_speed = settings.max_speed, .margin = 0}));
  Table trials = Row::trials_table();
  Table summary = Row::summary_table(is_lifelong);
  std::vector<Plot> plots;
  bool all_well = true;
  for (std::size_t i = 0; i < scenarios.size() && !options.stop(); ++i) {
    Scenario& scenario = scenarios[i];
    const std::string name = std::filesystem::path(settings.scenarios[i]).stem().string();
    Row row(name, scenario.robots.size(), straight_drive(scenario));
    for (int k = 0; k < options.seeds && !options.stop(); ++k) {
      const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(k);
      scenario.seed = static_cast<std::uint32_t>(seed);
      Flow flow = simulated(scenario, settings.lifelong, options.stop);
      if (options.stop()) break;
      all_well = all_well && flow.arrived == scenario.robots.size() && !flow.touched;
      options.tell(fmt::format("{}, seed {}: sum {:.0f} s, last {:.1f} s", name, seed, flow.sum, flow.last));
      row.add(std::move(flow));
      trials.rows.push_back(row.trial(seed));
    }
    if (row.empty()) break;
    if (!is_lifelong) add_centralised(references, name, scenario, options);
    summary.rows.push_back(row.summary(references, is_lifelong));
    plots.push_back(row.plot());
    write_experiment(options, "throughput", trials, summary, plots, 3);
  }
  options.tell(as_markdown(summary));
  return all_well;
}

}  // namespace coppice
