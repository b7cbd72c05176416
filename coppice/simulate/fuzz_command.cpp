#include <iostream>

#include <fmt/format.h>

#include "coppice/commands.h"
#include "coppice/simulate/simulation_recording.h"
#include "files/report_file.h"
#include "runtime/process.h"
#include "simulation/fuzz.h"
#include "simulation/fuzz_judge.h"

namespace coppice {

namespace {

constexpr double progress_period = 10;  // wall seconds

bool go_on(const PlannerService&, double) {
  return !stop_requested();
}

void tell_failures(const FuzzCase& fuzz_case, const FuzzResult& result) {
  std::cout << fmt::format("seed {}: {}\n", fuzz_case.seed, fuzz_case.what);
  for (const std::string& failure : result.failures) std::cout << "  " << failure << '\n';
  for (const std::string& robot : result.shut_in)
    std::cout << "  " << robot
              << " (no joint plan is known that leads it past the failed robots and the others)\n";
}

/// Totals of all cases so far.
struct Sum {
  std::size_t cases = 0;
  std::size_t failed = 0;
  std::size_t shut_in = 0;  ///< robots
  double robot_hours = 0;
  std::size_t decisions = 0;
  SufferedFaults suffered;

  void add(const FuzzResult& result) {
    ++cases;
    failed += !result.failures.empty();
    shut_in += result.shut_in.size();
    robot_hours += result.robot_hours;
    decisions += result.decisions;
    suffered.lost += result.suffered.lost;
    suffered.kills += result.suffered.kills;
    suffered.restarts += result.suffered.restarts;
    suffered.pauses += result.suffered.pauses;
  }
  std::string in_words() const {
    return fmt::format(
        "{} cases, {} failed; {:.2f} robot-hours, {} decisions checked, {} samples lost, {} agents killed, "
        "{} "
        "of them restarted, {} pauses, {} robots blocked by failed robots",
        cases, failed, robot_hours, decisions, suffered.lost, suffered.kills, suffered.restarts,
        suffered.pauses, shut_in);
  }
};

/// Runs one case, and writes its files.
int replay(const FuzzOptions& options) {
  const FuzzCase fuzz_case = draw_fuzz_case(*options.replay, options.restarts);
  check_results(options.files, fuzz_case.scenario, options.record.file);
  FleetSimulation simulation(fuzz_case.scenario, fuzz_case.settings);
  SimulationRecording recording(simulation, options.record);
  run_fuzz_case(fuzz_case, simulation, go_on);
  recording.finish();
  const FuzzResult result = judge(fuzz_case, simulation);
  const std::vector<NamedTrack>& tracks = simulation.tracks();
  const proto::Report report = simulation.service().report(in_parts(tracks));
  write_results(options.files, report, in_parts(tracks), [&] { return simulation.service().picture(); });
  std::cout << report_table(report);
  tell_failures(fuzz_case, result);
  return result.failures.empty() ? 0 : 1;
}

}  // namespace

int fuzz_command(const FuzzOptions& options) {
  install_stop_signals();
  if (options.replay) return replay(options);
  Sum sum;
  ProcessClock clock;
  WallTime next_line = clock.now() + progress_period;
  for (std::uint32_t seed = options.first_seed; sum.robot_hours < options.robot_hours; ++seed) {
    const FuzzCase fuzz_case = draw_fuzz_case(seed, options.restarts);
    FleetSimulation simulation(fuzz_case.scenario, fuzz_case.settings);
    run_fuzz_case(fuzz_case, simulation, go_on);
    if (stop_requested()) break;
    const FuzzResult result = judge(fuzz_case, simulation);
    sum.add(result);
    if (!result.failures.empty() || !result.shut_in.empty()) {
      tell_failures(fuzz_case, result);
      std::cout << fmt::format("  repeat with: coppice fuzz --replay {}{}\n", seed,
                               options.restarts ? " --restarts" : "")
                << std::flush;
    }
    if (clock.now() < next_line) continue;
    next_line = clock.now() + progress_period;
    std::cout << fmt::format("up to seed {}: {}", seed, sum.in_words()) << std::endl;
  }
  std::cout << fmt::format("seeds from {}: {}\n", options.first_seed, sum.in_words());
  return sum.failed == 0 ? 0 : 1;
}

}  // namespace coppice
