#include "simulation/fuzz_halts.h"

#include <algorithm>

#include <fmt/format.h>

#include "simulation/fuzz_random.h"

namespace coppice {

namespace {

constexpr double shortest_halt = 0.2;  // seconds
constexpr double longest_halt = 40;

/// No names: all robots.
std::vector<std::string> draw_halted(const Scenario& scenario, Random& random) {
  if (chance(0.3, random)) return {};
  std::vector<std::string> names{scenario.robots[random.index(scenario.robots.size())].name};
  const std::string& second = scenario.robots[random.index(scenario.robots.size())].name;
  if (chance(0.3, random) && second != names.front()) names.push_back(second);
  return names;
}

}  // namespace

std::vector<TimedOrder> draw_halts(const Scenario& scenario, double driving, std::uint32_t seed) {
  Random random = source_of(FuzzPart::halts, seed);
  std::vector<TimedOrder> orders;
  if (!chance(0.25, random)) return orders;
  for (int halts = whole_number(1, 3, random); halts > 0; --halts) {
    const bool stops = chance(0.5, random);
    const std::vector<std::string> robots = draw_halted(scenario, random);
    const double from = random.uniform(0, driving);
    const double until = from + log_uniform(shortest_halt, longest_halt, random);
    orders.push_back({from,
                      {.id = fmt::format("halt {}", halts),
                       .action = stops ? Action::stop : Action::pause,
                       .robots = robots}});
    orders.push_back({until,
                      {.id = fmt::format("end of halt {}", halts),
                       .action = stops ? Action::release : Action::resume,
                       .robots = robots}});
  }
  std::ranges::stable_sort(orders, {}, &TimedOrder::time);
  return orders;
}

}  // namespace coppice
