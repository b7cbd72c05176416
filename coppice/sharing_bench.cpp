#include "coppice/sharing_bench.h"

#include <array>
#include <filesystem>
#include <optional>
#include <stdexcept>

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
#include "coppice/planning/planner_kind.h"
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

/// Milliseconds from the last mission to the last path of one fleet; below 0 if a robot has no path.
double plan_ms(const std::string& program, const std::string& scenario, std::string_view planner,
               const std::string& report_file) {
  std::filesystem::remove(report_file);  // from the previous run
  run_quietly({program, "run", scenario, "--planner", std::string(planner), "--plan-budget", "0", "--timeout",
               fmt::format("{}", enough), "--report", report_file});
  const proto::Report report = read_report(report_file);
  for (const auto& robot : report.robots()) {
    if (!robot.planned()) return -1;
  }
  return 1e3 * report.plan_time();
}

}  // namespace

void bench_sharing(const ExperimentOptions& options, const std::string& program) {
  const TemporaryFolder folder;
  const std::string executable = std::filesystem::canonical(program).string();
  Table trials{{"map", "robots", "seed", "planner", "plan_ms"}, {}};
  Table medians{{"map", "robots", "shared ms", "alone ms", "shared / alone"}, {}};
  std::vector<Plot> plots;
  for (const std::string& source : options.maps) {
    const std::string map = map_title(source);
    std::vector<Series> series{{"shared", {}, {}, {}}, {"alone", {}, {}, {}}};
    for (const int robots : options.robots) {
      std::vector<std::vector<double>> ms(2);
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
        std::array<double, 2> times{};  // both, or none: the ratio is of the same seeds
        for (std::size_t alone = 0; alone < 2; ++alone)
          times[alone] =
              plan_ms(executable, scenario, planner_names[alone], (folder.path() / "report.json").string());
        for (std::size_t alone = 0; alone < 2; ++alone) {
          const double time = times[alone];
          ms[alone].push_back(time);
          trials.rows.push_back({map, std::to_string(robots), std::to_string(seed), series[alone].name,
                                 fmt::format("{:.3f}", time)});
        }
        options.tell(fmt::format("{} {} robots, seed {}", map, robots, seed));
      };
      for (int k = 0; k < options.seeds && !options.stop(); ++k) {
        const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(k);
        if (!succeeds(options, source, robots, [&] { measure(seed); })) break;
      }
      if (ms[1].empty()) continue;
      medians.rows.push_back({map, std::to_string(robots), fmt::format("{:.1f}", median(ms[0])),
                              fmt::format("{:.1f}", median(ms[1])),
                              fmt::format("{:.2f}", median(ms[0]) / median(ms[1]))});
      for (std::size_t alone = 0; alone < 2; ++alone) {
        series[alone].x.push_back(robots);
        series[alone].y.push_back(median(ms[alone]));
      }
    }
    plots.push_back({map, "robots", "mission to last path, ms", false, series});
    write_experiment(options, "sharing", trials, medians, plots, 2);
  }
  options.tell(as_markdown(medians));
}

}  // namespace coppice
