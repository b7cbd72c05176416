// Test of a fleet whose processes are killed at random and restarted: nothing touches, every mission ends,
// and no tree is lost. COPPICE_CHAOS_SECONDS sets the duration; the default is 20 s.
//
// CTest: PARALLEL

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"
#include "dds/dds_bus.h"
#include "files/report_file.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/run_check.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

double chaos_seconds() {
  const char* const wanted = std::getenv("COPPICE_CHAOS_SECONDS");
  return wanted != nullptr ? std::strtod(wanted, nullptr) : 30;
}

struct ChaosRun {
  ChaosRun(const std::string& scenario, const std::vector<std::string>& options)
      : process(command(scenario, options), file("log")) {}
  std::filesystem::path file(const std::string& name) const { return folder.path() / name; }
  std::vector<std::string> command(const std::string& scenario,
                                   const std::vector<std::string>& options) const {
    std::vector<std::string> all{test::program("coppice"),
                                 "run",
                                 (test::scenarios() / scenario).string(),
                                 "--domain",
                                 test::domain_name(),
                                 "--restart",
                                 "--standby",
                                 "--report",
                                 file("report.json").string(),
                                 "--trajectory",
                                 file("t.csv").string()};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }
  std::string log() const { return test::contents(file("log")); }
  std::vector<test::ProcessInfo> children(const std::string& name) const {
    auto all = test::children_of(process.pid());
    std::erase_if(all, [&](const test::ProcessInfo& child) { return child.name != name; });
    return all;
  }

  test::TemporaryFolder folder;
  test::Background process;
};

/// What a process uses of the machine.
struct Use {
  std::size_t files = 0;
  double megabytes = 0;
};

Use use_of(pid_t pid) {
  Use use;
  std::error_code gone;
  for (const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd", gone)) {
    (void)entry;
    ++use.files;
  }
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) use.megabytes = std::stod(line.substr(6)) / 1024;
  }
  return use;
}

int count_of(const std::string& what, const std::string& text) {
  int count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

/// The ids of all trees that an observer has after `time`.
std::set<TreesId> trees_within(DdsBus& observer, std::chrono::milliseconds time,
                               std::set<TreesId> known = {}) {
  const auto end = Clock::now() + time;
  while (Clock::now() < end) {
    observer.wait(0.05);
    for (const Arrival& arrival : observer.take()) {
      if (const auto* tree = std::get_if<InactiveTreesMessage>(arrival.message.get())) known.insert(tree->id);
    }
  }
  return known;
}

void expect_sound(const ChaosRun& run, double radius, const std::string& map_name, std::size_t robots) {
  const auto tracks = test::read_trajectory_rows(run.file("t.csv"));
  const test::PlainMap map(test::scenarios() / map_name);
  ASSERT_EQ(tracks.size(), robots);
  for (auto a = tracks.begin(); a != tracks.end(); ++a) {
    for (auto b = std::next(a); b != tracks.end(); ++b)
      EXPECT_GE(test::least_distance(a->second, b->second), 2 * radius - 1e-3) << a->first << " " << b->first;
    for (std::size_t i = 1; i < a->second.size(); ++i) {
      const auto& from = a->second[i - 1];
      const auto& to = a->second[i];
      ASSERT_GE(map.clearance(from.place, to.place, radius + 1), radius - 1e-3)
          << a->first << " at " << from.time;
      ASSERT_LE(test::distance(from.place, to.place), 20 * (to.time - from.time) + 1e-3)
          << a->first << " jumps at " << from.time;
    }
  }
}

TEST(Chaos, EveryKilledProcessIsRestartedAndNothingIsLost) {
#ifdef __SANITIZE_ADDRESS__
  // The sanitizer keeps freed memory, 256 MB by default. That growth is not the programs'.
  setenv("ASAN_OPTIONS", "quarantine_size_mb=8", 0);
#endif
  const double seconds = chaos_seconds();
  ChaosRun run("rooms-8.json", {"--lifelong", std::to_string(seconds)});
  DdsBus observer({.domain = test::own_domain()}, Role::observer, "chaos observer");
  ASSERT_TRUE(test::within(20s, [&] { return run.log().find("paths found 8/8") != std::string::npos; }))
      << run.log();
  std::set<TreesId> trees = trees_within(observer, 1s);

  Random random(7);
  std::map<std::string, int> kills;
  std::map<std::string, Use> early;
  std::map<std::string, Use> late;
  const auto begin = Clock::now();
  const auto share = [&] { return std::chrono::duration<double>(Clock::now() - begin).count() / seconds; };
  const std::vector<std::string> roles{"tree_broker", "planner_service", "robot_agent", "robot_agent"};
  for (std::size_t k = 0; share() < 0.9 || k < roles.size(); ++k) {
    // Each process is killed at least once.
    const std::string role = k < roles.size() ? roles[k] : roles[random.index(roles.size())];
    if (const auto alive = run.children(role); !alive.empty()) {
      kill(alive[random.index(alive.size())].pid, SIGKILL);
      ++kills[role];
    }
    trees =
        trees_within(observer, std::chrono::milliseconds(2000 + 1000 * random.index(3)), std::move(trees));
    auto all = test::children_of(run.process.pid());
    all.push_back({.pid = run.process.pid(), .name = "coppice"});  // it lives all the time
    for (const auto& process : all) {
      Use& most = (share() < 0.4 ? early : late)[process.name];
      const Use now = use_of(process.pid);
      most = {std::max(most.files, now.files), std::max(most.megabytes, now.megabytes)};
    }
  }
  EXPECT_GT(kills["tree_broker"], 0);
  EXPECT_GT(kills["planner_service"], 0);
  EXPECT_GT(kills["robot_agent"], 0);

  // A new participant finds every tree that was ever published.
  DdsBus latecomer({.domain = test::own_domain()}, Role::observer, "late chaos observer");
  std::set<TreesId> found;
  EXPECT_TRUE(test::within(10s,
                           [&] {
                             found = trees_within(latecomer, 200ms, std::move(found));
                             return std::ranges::includes(found, trees);
                           }))
      << found.size() << " of " << trees.size();
  EXPECT_FALSE(trees.empty());

  EXPECT_EQ(run.process.wait(), 0) << run.log();
  int killed = 0;
  for (const auto& [role, count] : kills) killed += count;
  EXPECT_EQ(count_of("ended early", run.log()), killed) << "a process ended by itself\n" << run.log();
  EXPECT_EQ(count_of("ended early, exit code 137", run.log()), killed) << run.log();
  const proto::Report report = read_report(run.file("report.json"));
  EXPECT_EQ(report.outcome(), "arrived");
  EXPECT_GT(report.missions(), 8u);
  expect_sound(run, 5, "rooms-8.map", 8);
  for (const auto& [role, use] : late) {
    EXPECT_LE(use.files, early[role].files + 2) << role;
    EXPECT_LE(use.megabytes, early[role].megabytes * 1.3 + 5) << role;
  }
}

}  // namespace
}  // namespace coppice
