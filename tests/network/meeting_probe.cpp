// meeting_probe ROLE NAME: a process of a fleet that only meets the others, and prints when: "matched" when
// its states, trees or missions have all of their readers. An agent also prints "map" and "trees" when it has
// the map and all inactive trees. Times are seconds since its start. It stays until it is stopped.

#include <chrono>
#include <cstdint>
#include <iostream>
#include <set>
#include <string>
#include <variant>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "dds/dds_bus.h"

namespace {

using namespace coppice;
using Clock = std::chrono::steady_clock;

struct Fleet {
  std::size_t agents = 1;
  int map_side = 512;
  std::uint32_t trees = 500;
};

bool is_matched(const DdsBus& bus, Role role, std::size_t agents) {
  switch (role) {
    case Role::agent:
      return bus.matched_readers<RobotState>() >= agents;
    case Role::broker:
      return bus.matched_readers<InactiveTreesMessage>() >= agents + 2;
    case Role::service:
      return bus.matched_readers<MapMessage>() >= agents + 1 && bus.matched_readers<Mission>() >= agents + 1;
    case Role::observer:
    case Role::claimant:
    case Role::viewer:
    case Role::dispatcher:
    case Role::replayer:
      return true;
  }
  return true;
}

void publish_map(DdsBus& bus, int side) {
  MapMessage m{"map", {}, {5}};
  m.map.width = side;
  m.map.height = side;
  m.map.resolution = 1;
  m.map.blocked.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0);
  bus.publish(Message(std::move(m)));
}

/// Some trees have one node and some have many, as a broker's trees.
void publish_trees(DdsBus& bus, std::uint32_t count) {
  for (std::uint32_t k = 0; k < count; ++k) {
    InactiveTreesMessage tree{.id = {1, k}, .map_id = "map", .radius = 5, .nodes = {}};
    for (int i = 0; i < (k % 3 == 0 ? 100 : 4); ++i) tree.nodes.push_back({{1.0 * i, 1.0}, i - 1, 6});
    bus.publish(Message(std::move(tree)));
  }
}

int run(const DdsSettings& settings, Role role, const std::string& name, const Fleet& fleet) {
  const auto begin = Clock::now();
  const auto tell = [&](const std::string& what) {
    std::cout << fmt::format("{} {:.2f}", what, std::chrono::duration<double>(Clock::now() - begin).count())
              << std::endl;
  };
  DdsBus bus(settings, role, name);
  if (role == Role::service) publish_map(bus, fleet.map_side);
  if (role == Role::broker) publish_trees(bus, fleet.trees);
  bool matched = false;
  bool has_map = false;
  std::set<TreesId> trees;
  while (true) {
    bus.wait(0.02);
    for (const Arrival& arrival : bus.take()) {
      if (role != Role::agent) continue;
      if (std::holds_alternative<MapMessage>(*arrival.message) && !has_map) {
        has_map = true;
        tell("map");
      }
      const auto* const tree = std::get_if<InactiveTreesMessage>(arrival.message.get());
      if (tree != nullptr && trees.insert(tree->id).second && trees.size() == fleet.trees) tell("trees");
    }
    if (!matched && is_matched(bus, role, fleet.agents)) {
      matched = true;
      tell("matched");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string role;
  std::string name;
  DdsSettings settings;
  Fleet fleet;
  CLI::App app{"Meets the other processes of a fleet, and tells when"};
  app.add_option("role", role, "agent, broker or service")
      ->required()
      ->check(CLI::IsMember({"agent", "broker", "service"}));
  app.add_option("name", name, "of the process")->required();
  app.add_option("--domain", settings.domain, "DDS domain");
  app.add_option("--discovery", settings.discovery, "as for every process");
  app.add_option("--agents", fleet.agents, "in the fleet");
  app.add_option("--trees", fleet.trees, "that the broker publishes");
  CLI11_PARSE(app, argc, argv);
  if (role == "agent") settings.robot = name;
  return run(settings,
             role == "agent"    ? Role::agent
             : role == "broker" ? Role::broker
                                : Role::service,
             name, fleet);
}
