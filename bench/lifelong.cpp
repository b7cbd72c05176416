#include <fmt/format.h>

#include "bench/experiments.h"
#include "bench/output.h"
#include "bench/statistics.h"
#include "bench/trial.h"
#include "planning/trees/ma_rrdt_star.h"
#include "planning/trees/suggestions.h"

namespace coppice {

namespace {

constexpr int missions = 10;

}  // namespace

void bench_lifelong(const ExperimentOptions& options) {
  Table trials{{"map", "robots", "seed", "mission", "plan_s", "nodes_valid", "nodes_invalid"}, {}};
  Table medians{{"map", "robots", "mission", "plan ms", "of the first", "nodes"}, {}};
  std::vector<Plot> plots;
  for (const std::string& source : options.maps) {
    const std::string map = map_title(source);
    std::vector<Series> series;
    for (const int robots : options.robots) {
      std::vector<std::vector<double>> ms(missions);
      std::vector<std::vector<double>> nodes(missions);
      const auto measure = [&](std::uint64_t seed) {
        const TrialCase trial = make_case(source, options.side, robots, options.radius, seed);
        Random random(seed + 7);
        MaRrdtStar<ClearanceField> planner(trial.field, completed({}, trial.field, options.radius),
                                           Random(seed));
        std::uint32_t known = 0;
        std::uint32_t known_invalid = 0;
        for (int mission = 0; mission < missions; ++mission) {
          const auto tasks = random_tasks(trial.field, robots, options.radius, 0.2, random);
          const Stopwatch watch;
          for (const StartAndGoal& task : tasks) planner.add_group(task.start, task.goal, options.radius);
          while (planner.step()) {
          }
          planner.paths(planner.group_count() - tasks.size());
          const double seconds = watch.seconds();
          const auto valid = planner.all_counts().valid;
          const auto invalid = planner.all_counts().invalid;
          ms[static_cast<std::size_t>(mission)].push_back(1e3 * seconds);
          nodes[static_cast<std::size_t>(mission)].push_back(valid - known);
          trials.rows.push_back({map, std::to_string(robots), std::to_string(seed),
                                 std::to_string(mission + 1), fmt::format("{:.6f}", seconds),
                                 std::to_string(valid - known), std::to_string(invalid - known_invalid)});
          known = valid;
          known_invalid = invalid;
        }
        options.tell(fmt::format("{} {} robots, seed {}", map, robots, seed));
      };
      for (int k = 0; k < options.seeds && !options.stop(); ++k) {
        const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(k);
        if (!succeeds(options, source, robots, [&] { measure(seed); })) break;
      }
      Series line{fmt::format("{} robots", robots), {}, {}, {}};
      for (std::size_t m = 0; m < missions && !ms[m].empty(); ++m) {
        medians.rows.push_back(
            {map, std::to_string(robots), std::to_string(m + 1), fmt::format("{:.3f}", median(ms[m])),
             fmt::format("{:.3f}", median(ms[m]) / median(ms[0])), fmt::format("{:.0f}", median(nodes[m]))});
        line.x.push_back(static_cast<double>(m + 1));
        line.y.push_back(median(ms[m]));
      }
      series.push_back(line);
    }
    plots.push_back({map, "mission", "plan time, ms", true, series});
    write_experiment(options, "lifelong", trials, medians, plots, 2);
  }
  options.tell(as_markdown(medians));
}

}  // namespace coppice
