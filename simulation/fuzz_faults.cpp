#include "simulation/fuzz_faults.h"

#include <algorithm>
#include <utility>

#include "messages/clock_offset.h"
#include "simulation/drive_limits.h"
#include "simulation/fault_schedule.h"
#include "simulation/fuzz_random.h"

namespace coppice {

namespace {

// Seconds for which a robot may lose all others, less than the 60 s after which it counts as failed (A6). A
// pause counts, and two pauses may follow each other closely.
constexpr double longest_loss = 58;
constexpr double longest_cut = 50;
constexpr double shortest_cut = 0.5;
constexpr double longest_short_cut = 3;
constexpr double longest_short_pause = 1.2;
constexpr double longest_pause = 30;  // A6
// Seconds. Two robots that do not reach each other stay safe for any time if other robots that reach both are
// alive. After 120 s they give up.
constexpr double longest_cut_of_a_link = 110;
constexpr std::size_t robots_a_cut_link = 4;
// Robots. In fewer, all that could have heard a robot may be dead, or sleep.
constexpr std::size_t large_fleet = 10;

double sometimes(double most, Random& random) {
  return chance(0.5, random) ? random.uniform(0, most) : 0;
}

void draw_network(BusFaults& bus, Random& random) {
  bus.loss = sometimes(0.4, random);
  bus.delay = sometimes(0.25, random);
  bus.jitter = bus.delay * random.uniform();
  bus.duplicate = sometimes(0.1, random);
  bus.reorder = chance(0.5, random);
}

void draw_clocks(Faults& faults, Random& random) {
  faults.clock_skew = chance(0.1, random) ? log_uniform(2, 100, random) : sometimes(2, random);
  if (chance(0.4, random))
    faults.clock_drift = chance(0.5, random) ? clock_drift : random.uniform(0, clock_drift);
}

/// Events of one agent in an hour, if these happen in the fleet every so many seconds.
double rate_of_one(double seconds, std::size_t agents) {
  return 3600 / (seconds * static_cast<double>(agents));
}

/// Seconds for which a robot stands after a silence: until all others have braked (A10). Pauses and restarts
/// are rarer than that, or no run would end.
double recovery(const Scenario& scenario) {
  double longest = 0;
  for (const RobotTask& robot : scenario.robots) longest = std::max(longest, braking_time(limits_of(robot)));
  return longest;
}

/// Short pauses are frequent, long ones rare.
void draw_pauses(const Scenario& scenario, Faults& faults, Random& random) {
  const double kind = random.uniform();
  if (kind < 0.35) {
    faults.pause_rate = rate_of_one(2 * recovery(scenario) + random.uniform(30, 360), 1);
    faults.pause = random.uniform(0.1, longest_short_pause);
  } else if (kind < 0.6) {
    faults.pause_rate = rate_of_one(recovery(scenario) + random.uniform(20, 120), scenario.robots.size());
    faults.pause = log_uniform(longest_short_pause, longest_pause, random);
  }
}

bool has_long_pauses(const Faults& faults) {
  return faults.pause_rate > 0 && faults.pause > longest_short_pause;
}

/// Several short partitions, or one that may be long: as long in all as pauses leave time.
std::vector<Partition> draw_partitions(const Faults& faults, double driving, Random& random) {
  const double kind = random.uniform();
  double left = longest_loss - (faults.pause_rate > 0 ? 2 * faults.pause : 0);
  std::vector<Partition> cuts;
  if (kind < 0.2) {
    const double from = random.uniform(0, driving);
    const double lasts = std::min(left, random.uniform(shortest_cut, longest_cut));
    if (lasts >= shortest_cut) cuts.push_back({from, from + lasts});
  } else if (kind < 0.5) {
    double from = random.uniform(0, driving / 2);
    for (int k = whole_number(2, 6, random); k > 0; --k) {
      const double lasts = random.uniform(shortest_cut, longest_short_cut);
      if ((left -= lasts) < 0) break;
      cuts.push_back({from, from + lasts});
      from += lasts + log_uniform(0.5, std::max(2.0, driving / 3), random);
    }
  }
  return cuts;
}

/// Draws cut links between robots; no robot has two of them.
std::vector<CutLink> draw_cut_links(const Scenario& scenario, const Faults& faults, double driving,
                                    Random& random) {
  const std::size_t robots = scenario.robots.size();
  const bool others_may_all_be_dead = faults.kill_rate > 0 && robots < large_fleet;
  std::vector<CutLink> links;
  if (chance(0.7, random) || !faults.bus.partitions.empty() || others_may_all_be_dead ||
      has_long_pauses(faults))
    return links;
  const std::size_t first = random.index(robots);
  const std::size_t count = robots < robots_a_cut_link ? 0 : 1 + random.index(robots / robots_a_cut_link);
  for (std::size_t k = 0; k < count; ++k) {
    const double from = chance(0.5, random) ? 0 : random.uniform(0, driving);
    links.push_back({scenario.robots[(first + k) % robots].name,
                     scenario.robots[(first + k + robots / 2) % robots].name, from,
                     from + random.uniform(1, longest_cut_of_a_link)});
  }
  return links;
}

/// A robot that is alone on its side of a partition and fails there may be anywhere (A6). So it fails after
/// the last one; in a small fleet, where those on its side may be down, in any case.
void postpone_lonely_kills(const Scenario& scenario, Faults& faults) {
  const std::vector<Partition>& cuts = faults.bus.partitions;
  if (cuts.empty()) return;
  const std::vector<AgentFaults> drawn = draw_faults(faults, scenario, 0);
  for (Faults::Kill& kill : faults.kills) {
    const auto victim = std::ranges::find(scenario.robots, kill.robot, &RobotTask::name);
    const int side = drawn[static_cast<std::size_t>(victim - scenario.robots.begin())].side;
    const bool is_alone = std::ranges::count(drawn, side, &AgentFaults::side) == 1;
    if (kill.time > cuts.front().from && (is_alone || drawn.size() < large_fleet))
      kill.time += cuts.back().until;
  }
}

/// A robot whose agent fails while all others sleep may be anywhere, as if it were cut off.
void draw_kills(const Scenario& scenario, Faults& faults, double driving, Random& random) {
  if (!chance(0.3, random)) return;
  if (has_long_pauses(faults) && scenario.robots.size() < large_fleet) return;
  const RobotTask& victim = scenario.robots[random.index(scenario.robots.size())];
  faults.kills.push_back({victim.name, random.uniform(0, driving)});
}

/// If restarts were more frequent than joint plans take, no run would end. No pause is long: a peer that
/// counts as failed must not come back while an agent is restarted (A8).
void draw_restarts(const Scenario& scenario, Faults& faults, Random& random) {
  constexpr double recoveries = 3;  // a robot has to stand, to speed up, and to come on
  const double seconds = recoveries * recovery(scenario) + random.uniform(10, 60);
  faults.kill_rate = rate_of_one(seconds, scenario.robots.size());
  faults.restart_after = random.uniform(0.1, 8);
  faults.pause = std::min(faults.pause, longest_short_pause);
  for (Faults::Kill& kill : faults.kills) kill.for_good = true;
}

}  // namespace

Faults draw_faults_of_case(const Scenario& scenario, double driving, bool restarts, std::uint32_t seed) {
  Faults faults;
  Random of_network = source_of(FuzzPart::network, seed);
  Random of_clocks = source_of(FuzzPart::clocks, seed);
  Random of_agents = source_of(FuzzPart::agents, seed);
  draw_network(faults.bus, of_network);
  draw_clocks(faults, of_clocks);
  draw_pauses(scenario, faults, of_agents);
  draw_kills(scenario, faults, driving, of_agents);
  if (restarts) {
    Random of_restarts = source_of(FuzzPart::restarts, seed);
    draw_restarts(scenario, faults, of_restarts);
  }
  faults.bus.partitions = draw_partitions(faults, driving, of_network);
  postpone_lonely_kills(scenario, faults);
  faults.bus.cut_links = draw_cut_links(scenario, faults, driving, of_network);
  return faults;
}

DriveFaults draw_drive_faults(const Scenario& scenario, Random& random) {
  DriveFaults most = largest_drive_faults(scenario.robots.front());
  for (const RobotTask& robot : scenario.robots) {
    const DriveFaults bears = largest_drive_faults(robot);
    most.odometry_noise = std::min(most.odometry_noise, bears.odometry_noise);
    most.lag = std::min(most.lag, bears.lag);
    most.slip = std::min(most.slip, bears.slip);
  }
  return {.odometry_noise = random.uniform(0, most.odometry_noise),
          .lag = random.uniform(0, most.lag),
          .slip = random.uniform(0, most.slip)};
}

}  // namespace coppice
