#include "coppice/bench/sharing_bench.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/output.h"
#include "bench/statistics.h"
#include "bench/trial.h"
#include "coppice/commands.h"
#include "coppice/planning/map_generator.h"
#include "files/report_file.h"
#include "files/temporary_folder.h"

namespace coppice {

namespace {

constexpr double enough = 2;  // fleet seconds: planning ends long before

/// Runs a command to its end, and discards its output.
void run_quietly(std::vector<std::string> command) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::vector<char*> arguments;
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  pid_t pid = -1;
  const int error = posix_spawn(&pid, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error(command[0] + " cannot be started");
  waitpid(pid, nullptr, 0);
}

/// How the robots of a run come by disjointed trees.
struct Way {
  const char* name;
  std::vector<std::string> options;
};
const std::array<Way, 3> ways{
    {{"ahead", {"--forest", "ahead"}}, {"together", {"--forest", "together"}}, {"alone", {"--no-sharing"}}}};
constexpr std::size_t alone = 2;

struct Measured {
  double plan_ms = -1;             ///< from the last mission to the last path; below 0: a robot has no path
  std::uint32_t agents_nodes = 0;  ///< valid nodes of all root trees, and of trees that grew in agents
  std::uint32_t published_trees = 0;  ///< by the broker
};

Measured measure_fleet(const std::string& program, const std::string& scenario, const Way& way,
                       const std::string& report_file) {
  std::filesystem::remove(report_file);  // from the previous run
  std::vector<std::string> command{
      program,    "run",      scenario, "--plan-budget", "0", "--timeout", fmt::format("{}", enough),
      "--report", report_file};
  command.insert(command.end(), way.options.begin(), way.options.end());
  run_quietly(std::move(command));
  const proto::Report report = read_report(report_file);
  Measured measured{.plan_ms = 1e3 * report.plan_time(), .published_trees = report.trees_published()};
  for (const auto& robot : report.robots()) {
    if (!robot.planned()) measured.plan_ms = -1;
    measured.agents_nodes += robot.nodes_valid();
  }
  return measured;
}

}  // namespace

void bench_sharing(const ExperimentOptions& options, const std::string& program) {
  const TemporaryFolder folder;
  const std::string executable = std::filesystem::canonical(program).string();
  Table trials{{"map", "robots", "seed", "trees", "plan_ms", "agents_nodes", "published_trees"}, {}};
  Table medians{{"map", "robots", "ahead ms", "together ms", "alone ms", "ahead / alone", "together / alone",
                 "least nodes of agents, together"},
                {}};
  std::vector<Plot> plots;
  for (const std::string& source : options.maps) {
    const std::string map = map_title(source);
    std::vector<Series> series;
    for (const Way& way : ways) series.push_back({way.name, {}, {}, {}});
    for (const int robots : options.robots) {
      std::array<std::vector<double>, ways.size()> ms;
      std::vector<double> nodes_together;
      const auto measure = [&](std::uint64_t seed) {
        const std::string scenario = (folder.path() / "scenario.json").string();
        const auto side =
            map_kind(source) ? std::optional(options.side) : std::nullopt;  // a file has its own
        map_command({.kind = source,
                     .width = side,
                     .height = side,
                     .seed = static_cast<std::uint32_t>(seed),
                     .robots = robots,
                     .radius = options.radius,
                     .output = scenario});
        std::array<Measured, ways.size()> measured;  // all, or none: the ratio is of the same seeds
        for (std::size_t w = 0; w < ways.size(); ++w)
          measured[w] =
              measure_fleet(executable, scenario, ways[w], (folder.path() / "report.json").string());
        for (std::size_t w = 0; w < ways.size(); ++w) {
          const Measured& m = measured[w];
          ms[w].push_back(m.plan_ms);
          trials.rows.push_back({map, std::to_string(robots), std::to_string(seed), ways[w].name,
                                 fmt::format("{:.3f}", m.plan_ms), std::to_string(m.agents_nodes),
                                 std::to_string(m.published_trees)});
        }
        nodes_together.push_back(measured[1].agents_nodes);
        options.tell(fmt::format("{} {} robots, seed {}", map, robots, seed));
      };
      for (int k = 0; k < options.seeds && !options.stop(); ++k) {
        const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(k);
        if (!succeeds(options, source, robots, [&] { measure(seed); })) break;
      }
      if (nodes_together.empty()) continue;
      std::vector<std::string> row{map, std::to_string(robots)};
      for (const auto& times : ms) row.push_back(fmt::format("{:.1f}", median(times)));
      for (std::size_t w = 0; w < alone; ++w)
        row.push_back(fmt::format("{:.2f}", median(ms[w]) / median(ms[alone])));
      row.push_back(fmt::format("{}", quantile(nodes_together, 0)));
      medians.rows.push_back(row);
      for (std::size_t w = 0; w < ways.size(); ++w) {
        series[w].x.push_back(robots);
        series[w].y.push_back(median(ms[w]));
      }
    }
    plots.push_back({map, "robots", "mission to last path, ms", false, series});
    write_experiment(options, "sharing", trials, medians, plots, 2);
  }
  options.tell(as_markdown(medians));
}

}  // namespace coppice
