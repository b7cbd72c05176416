// The messages of the brokers tell which trees see each other: their readers need not compare the trees.
#include <cstdint>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "planning/trees/suggestions.h"
#include "tests/unit/planner_service/roles.h"
#include "tree_broker/tree_broker.h"

namespace coppice {
namespace {

/// All nodes that were published, and which of them are connected.
class Published {
 public:
  void add(const InactiveTreesMessage& message) {
    if (first_.contains(message.id)) {
      links_.push_back(message);
      return;
    }
    first_[message.id] = nodes_.size();
    for (const auto& node : message.nodes) {
      nodes_.push_back({node.position, message.radius});
      parents_.push_back(node.parent < 0 ? nodes_.size() - 1
                                         : first_[message.id] + static_cast<std::size_t>(node.parent));
    }
    links_.push_back(message);
  }

  /// Checks that robots of `radius` know from the links of all pairs that see each other within `reach`.
  /// Returns the number of links.
  std::size_t expect_all_links(const ClearanceField& field, double radius, double reach) const {
    std::vector<std::size_t> above(nodes_.size());
    std::iota(above.begin(), above.end(), 0u);
    const auto root = [&](std::size_t n) {
      while (above[n] != n) n = above[n] = above[above[n]];
      return n;
    };
    for (std::size_t n = 0; n < nodes_.size(); ++n) above[root(n)] = root(parents_[n]);
    std::size_t links = 0;
    for (const InactiveTreesMessage& message : links_) {
      for (const auto& link : message.links) {
        const std::size_t a = first_.at(message.id) + link.node;
        const std::size_t b = first_.at(link.other) + link.other_node;
        if (std::min(nodes_[a].radius, nodes_[b].radius) < radius) continue;
        EXPECT_TRUE(see_each_other(field, a, b, reach * (1 + 1e-9)));
        above[root(a)] = root(b);
        ++links;
      }
    }
    for (std::size_t a = 0; a < nodes_.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (std::min(nodes_[a].radius, nodes_[b].radius) < radius || root(a) == root(b)) continue;
        EXPECT_FALSE(see_each_other(field, a, b, reach * (1 - 1e-9))) << a << ' ' << b;
      }
    }
    return links;
  }

 private:
  struct Node {
    Point2 position;
    double radius;
  };
  bool see_each_other(const ClearanceField& field, std::size_t a, std::size_t b, double reach) const {
    const Point2& p = nodes_[a].position;
    const Point2& q = nodes_[b].position;
    const double radius = std::min(nodes_[a].radius, nodes_[b].radius);
    return (p - q).norm() <= reach &&
           (field.segment_free(p, q, radius - 1e-9) || field.segment_free(q, p, radius - 1e-9));
  }

  std::vector<Node> nodes_{};
  std::vector<std::size_t> parents_{};  ///< of each node; a root is its own
  std::map<TreesId, std::size_t> first_{};
  std::vector<InactiveTreesMessage> links_{};
};

struct Case {
  MapKind kind;
  std::vector<double> ahead;  ///< radii to grow ahead for
  std::vector<double> missions;
};

void give_missions(TreeBroker& broker, const ClearanceField& field, const Case& fleet, double now) {
  Random random(3);
  for (std::size_t k = 0; k < fleet.missions.size(); ++k) {
    const double radius = fleet.missions[k];
    Mission mission{.robot = "r" + std::to_string(k), .number = 1, .map_id = "map"};
    mission.radius = radius;
    do {
      mission.start = random_point(field.bounds(), random);
    } while (!field.is_free(mission.start, radius));
    do {
      mission.goal = random_point(field.bounds(), random);
    } while (!field.is_free(mission.goal, radius));
    broker.on(arrival_of(mission, now));
  }
}

TEST(PublishedLinks, JoinAllTreesThatSeeEachOther) {
  const std::vector<Case> cases{{MapKind::maze, {}, {5, 5, 5, 5}},
                                {MapKind::room, {}, {8, 3, 8, 3}},
                                {MapKind::maze, {4, 8}, {}},
                                {MapKind::room, {3, 8}, {8, 5, 3, 3}}};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const Case& fleet : cases) {
      Random random(seed);
      const MapMessage map{"map", generate_map(fleet.kind, 300, 300, random), fleet.ahead};
      const ClearanceField field(map.map);
      const double largest = fleet.ahead.empty() ? fleet.missions.front() : fleet.ahead.back();
      const double epsilon = completed({}, field, largest).epsilon;
      TreeBroker broker(7, seed);
      TreeBroker standby(8, seed + 10);
      broker.on(arrival_of(map, 0));
      standby.on(arrival_of(map, 0));
      Published published;
      double now = 0;
      const auto run = [&](TreeBroker& leader, TreeBroker* other, double until) {
        for (; now < until; now += 0.001) {
          for (const Message& message : leader.step(now)) {
            if (other != nullptr) other->on(arrival_of(message, now));
            if (const auto* const trees = std::get_if<InactiveTreesMessage>(&message)) published.add(*trees);
          }
        }
      };
      run(broker, &standby, 0.2);
      give_missions(broker, field, fleet, now);
      run(broker, &standby, 0.5);
      EXPECT_GT(published.expect_all_links(field, 3, epsilon), 0u);
      published.expect_all_links(field, 5, epsilon);

      // The standby broker takes over, and grows trees of its own for later missions.
      give_missions(standby, field, fleet, now);
      run(standby, nullptr, 3.5);
      EXPECT_TRUE(standby.leads());
      published.expect_all_links(field, 3, epsilon);
      if (HasFailure()) FAIL() << "seed " << seed << ", case " << &fleet - cases.data();
    }
  }
}

}  // namespace
}  // namespace coppice
