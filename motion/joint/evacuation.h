// Evacuates a cluster to parking vertices, where no robot is in another's way (parking.h), and reassembles it
// at the goals.
//
// The robots park one after the other. The search does the same in thought from the final configuration. The
// moves are the first evacuation, those from the first parking vertices to the second ones (lacam.h), and the
// reverse of the second evacuation: a way may be driven back while the others stand. So a dead end that was
// filled in the wrong order is emptied and filled again, the deepest position first.
//
// There are no such moves where robots shut each other in, at the beginning or at the end, or have no vertex
// to park.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/joint/cluster.h"
#include "motion/joint/lacam.h"
#include "motion/joint/parking.h"

namespace coppice {

class Evacuation {
 public:
  /// `cluster` must outlive it.
  Evacuation(Cluster& cluster, Random random);

  /// Does a bounded amount of work. Gives up after some attempts, or if they take too long.
  SearchState step();
  /// The moves of the solution. Valid only once solved.
  std::vector<VertexMove> moves() const;

 private:
  struct Leaves {  ///< from the starts
    Parking first;
    SearchState step() { return first.step(); }
    std::size_t effort() const { return first.effort(); }
  };
  struct Returns {  ///< from the goals, in thought
    Parking first;
    Parking second;
    SearchState step() { return second.step(); }
    std::size_t effort() const { return first.effort() + second.effort(); }
  };
  struct Exchanges {  ///< from the first parking vertices to the second ones
    Parking first;
    Parking second;
    std::unique_ptr<Cluster> cluster;
    Lacam lacam;
    int steps_left;
    SearchState step();
    std::size_t effort() const { return first.effort() + second.effort(); }
  };

  bool goals_touch() const;
  Leaves begun_attempt();
  bool go_on();
  Parking from_the_goals(const Parking& first) const;
  Exchanges exchange(Parking first, Parking second) const;

  Cluster& cluster_;
  Random random_;
  int attempts_ = 0;        ///< those that have ended
  std::size_t effort_ = 0;  ///< edges that these have examined
  std::vector<std::uint32_t> order_{};
  std::variant<Leaves, Returns, Exchanges> stage_;
};

}  // namespace coppice
