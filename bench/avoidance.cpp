#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "bench/experiments.h"
#include "bench/output.h"
#include "bench/statistics.h"
#include "bench/trial.h"
#include "coppice/motion/reciprocal_velocity.h"
#include "coppice/motion/separation.h"
#include "motion/body/path_follower.h"
#include "robot_agent/peers/fleet.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

namespace {

constexpr double max_speed = 20;
constexpr Limits limits{max_speed, 2 * max_speed};
constexpr double longest_run = 300;  // fleet seconds; robots that are stuck stay stuck
constexpr double horizon = 2;
constexpr double obstacle_horizon = 0.25;

struct Outcome {
  bool succeeded = false;   ///< all robots arrived and nothing collided
  double mean_arrival = 0;  ///< seconds, of those that arrived
  double last_arrival = 0;
};

Outcome judged(const std::vector<double>& arrivals, std::size_t robots, std::span<const Track> tracks,
               const ClearanceField& field) {
  const auto separation = separation_of(tracks);
  const auto clearance = clearance_of(tracks, field);
  const bool touched =
      (separation && !separation->overlapping.empty()) || (clearance && !clearance->overlapping.empty());
  if (arrivals.empty()) return {};
  return {arrivals.size() == robots && !touched, mean(arrivals), std::ranges::max(arrivals)};
}

/// Robots with perfect knowledge of each other, which follow their paths and avoid each other by ORCA alone.
class RvoAlone {
 public:
  RvoAlone(const ClearanceField& field, const std::vector<Path>& paths, double radius) : field_(field) {
    for (const Path& path : paths)
      robots_.push_back({{path.front(), Point2::Zero(), radius}, PathFollower(path, radius), path.back()});
  }

  Outcome run() {
    std::vector<double> arrivals;
    for (double now = 0; now < longest_run && arrivals.size() < robots_.size(); now += control_period) {
      step(now);
      for (Robot& robot : robots_) {
        if (robot.there || (robot.disc.position - robot.goal).norm() > 0.5) continue;
        robot.there = true;
        arrivals.push_back(now + control_period);
      }
    }
    std::vector<Track> tracks;
    for (Robot& robot : robots_) tracks.push_back(std::move(robot.track));
    return judged(arrivals, robots_.size(), tracks, field_);
  }

 private:
  struct Robot {
    MovingDisc disc;
    PathFollower follower;
    Point2 goal;
    bool there = false;
    Track track{};
  };

  Point2 velocity_of(Robot& robot) {
    const MovingDisc& self = robot.disc;
    std::vector<HalfPlane> obstacles;
    std::vector<HalfPlane> others;
    obstacle_half_planes(field_, self.position, self.radius, max_speed * obstacle_horizon, obstacle_horizon,
                         obstacles);
    for (const Robot& other : robots_) {
      const double distance = (other.disc.position - self.position).norm();
      if (&other == &robot || distance > 2 * self.radius + 2 * horizon * max_speed) continue;
      others.push_back(orca_half_plane(self, other.disc, horizon, control_period));
    }
    const bool sees_its_path = robot.follower.look_from(self.position, field_, limits);
    const Point2 preferred = sees_its_path
                                 ? robot.follower.preferred_velocity(self.position, limits, control_period)
                                 : Point2::Zero();
    return within_limits(safe_velocity(preferred, max_speed, obstacles, others), self.velocity, limits,
                         control_period);
  }

  void step(double now) {
    std::vector<Point2> velocities;
    for (Robot& robot : robots_) velocities.push_back(velocity_of(robot));
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      MovingDisc& disc = robots_[i].disc;
      disc.velocity = velocities[i];
      robots_[i].track.radius = disc.radius;
      robots_[i].track.points.push_back({now, disc.position, disc.velocity});
      disc.position += control_period * disc.velocity;
    }
  }

  const ClearanceField& field_;
  std::vector<Robot> robots_;
};

struct WayToDrive {
  const char* name;
  std::optional<Coordination> coordination;  ///< none: with RVO alone
};
const std::array<WayToDrive, 4> ways{{{"reservations", Coordination::reservations},
                                      {"rvo", Coordination::rvo},
                                      {"rvo, no rounds", Coordination::rvo_without_rounds},
                                      {"RVO alone", std::nullopt}}};
constexpr std::size_t reserving = 0;
constexpr std::size_t alone = ways.size() - 1;
using Outcomes = std::array<Outcome, ways.size()>;

struct Simulated {
  Outcome outcome;
  std::vector<Path> paths;
};

Simulated simulated(const TrialCase& trial, double radius, Coordination coordination) {
  Scenario scenario{.map_name = trial.map,
                    .map = trial.occupancy,
                    .seed = static_cast<std::uint32_t>(trial.seed),
                    .robots = {}};
  for (const PlanningProblem& p : trial.problems) {
    scenario.robots.push_back({fmt::format("r{}", scenario.robots.size() + 1), p.start, p.goal, radius,
                               limits.max_speed, limits.max_acceleration, 1});
  }
  FleetSimulation simulation(scenario, {.timeout = longest_run, .coordination = coordination});
  simulation.run([](const PlannerService&, double) { return true; });
  const std::vector<NamedTrack>& named = simulation.tracks();
  const proto::Report report = simulation.service().report(in_parts(named));
  Simulated result;
  std::vector<double> arrivals;
  for (const auto& robot : report.robots()) {
    if (robot.arrived()) arrivals.push_back(robot.run_time());
    Path& path = result.paths.emplace_back();
    for (const auto& p : robot.path()) path.emplace_back(p.x(), p.y());
  }
  std::vector<Track> tracks;
  for (const NamedTrack& track : named) tracks.push_back(track.track);
  result.outcome = judged(arrivals, scenario.robots.size(), tracks, trial.field);
  return result;
}

/// RVO alone drives along the paths of the fleet with reservations.
Outcomes compared(const TrialCase& trial, double radius) {
  Outcomes outcomes;
  std::vector<Path> paths;
  for (std::size_t w = 0; w < ways.size(); ++w) {
    if (w == alone) {
      outcomes[w] = RvoAlone(trial.field, paths, radius).run();
      continue;
    }
    Simulated run = simulated(trial, radius, *ways[w].coordination);
    outcomes[w] = run.outcome;
    if (w == reserving) paths = std::move(run.paths);
  }
  return outcomes;
}

std::string arrivals_and_times(const std::vector<Outcomes>& trials, std::size_t way) {
  std::vector<double> seconds;
  for (const Outcomes& outcomes : trials) {
    if (outcomes[way].succeeded) seconds.push_back(outcomes[way].last_arrival);
  }
  const std::string arrived = fmt::format("{} of {}", seconds.size(), trials.size());
  if (seconds.empty()) return arrived;
  return fmt::format("{}, {:.1f} ± {:.1f} s", arrived, mean(seconds), deviation(seconds));
}

/// Mean times of arrival, where RVO alone succeeds.
std::vector<double> ratios_to_alone(const std::vector<Outcomes>& trials) {
  std::vector<double> ratios;
  for (const Outcomes& outcomes : trials) {
    if (outcomes[alone].succeeded)
      ratios.push_back(outcomes[reserving].mean_arrival / outcomes[alone].mean_arrival);
  }
  return ratios;
}

}  // namespace

void bench_avoidance(const ExperimentOptions& options) {
  Table trials{{"map", "robots", "seed", "driving", "succeeded", "mean_arrival_s", "last_arrival_s"}, {}};
  Table summary{{"map", "robots"}, {}};
  for (const WayToDrive& way : ways) summary.header.emplace_back(way.name);
  summary.header.emplace_back("mean run time, reservations / RVO alone");
  std::vector<Plot> plots;
  for (const std::string& source : options.maps) {
    Series line{"where RVO alone succeeds", {}, {}, {}};
    for (const int robots : options.robots) {
      std::vector<Outcomes> runs;
      const auto measure = [&](std::uint64_t seed) {
        runs.push_back(
            compared(make_case(source, options.side, robots, options.radius, seed), options.radius));
        for (std::size_t w = 0; w < ways.size(); ++w) {
          const Outcome& outcome = runs.back()[w];
          trials.rows.push_back({map_title(source), std::to_string(robots), std::to_string(seed),
                                 ways[w].name, std::to_string(outcome.succeeded),
                                 fmt::format("{:.3f}", outcome.mean_arrival),
                                 fmt::format("{:.3f}", outcome.last_arrival)});
        }
        options.tell(fmt::format("{} {} robots, seed {}", map_title(source), robots, seed));
      };
      for (int k = 0; k < options.seeds && !options.stop(); ++k) {
        const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(k);
        if (!succeeds(options, source, robots, [&] { measure(seed); })) break;
      }
      if (runs.empty()) continue;
      std::vector<std::string> row{map_title(source), std::to_string(robots)};
      for (std::size_t w = 0; w < ways.size(); ++w) row.push_back(arrivals_and_times(runs, w));
      const std::vector<double> ratios = ratios_to_alone(runs);
      row.push_back(ratios.empty() ? "-"
                                   : fmt::format("{:.3f} ({:.3f} to {:.3f})", median(ratios),
                                                 quantile(ratios, 0.25), quantile(ratios, 0.75)));
      summary.rows.push_back(row);
      if (ratios.empty()) continue;
      line.x.push_back(robots);
      line.y.push_back(median(ratios));
    }
    plots.push_back({map_title(source), "robots", "mean run time, reservations / RVO alone", false, {line}});
    write_experiment(options, "avoidance", trials, summary, plots, 2);
  }
  options.tell(as_markdown(summary));
}

}  // namespace coppice
