// Evacuates a cluster: one robot after the other drives to a parking vertex, where it closes no way.
//
// A vertex is suitable if the roadmap around all parked robots stays in one piece: the position cuts off
// fewer vertices than the robot covers, and all robots' vertices and aims remain connected. A roadmap with
// such vertices is well-formed (Cap, Vokrinek, Kleiner, "Complete Decentralized Method for On-Line
// Multi-Robot Trajectory Planning in Well-formed Infrastructures", 2015).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "motion/joint/cluster.h"

namespace coppice {

class Parking {
 public:
  struct Robot {
    Vertex at = 0;
    std::optional<Vertex> aim{};  ///< where the robot wants to be in the end; none: any vertex will do
    bool takes_part = false;      ///< false: the robot stands at `at` for good
  };

  /// `graph` must outlive it. The robots are asked in the given order.
  Parking(const AnnotatedRoadmap& graph, std::vector<Robot> robots, std::vector<std::uint32_t> order);

  /// Parks one robot, or finds that it has no way now. Gives up if no robot has one.
  SearchState step();
  const std::vector<VertexMove>& moves() const { return moves_; }
  Vertex at(std::uint32_t robot) const { return robots_[robot].at; }
  /// Number of edges that were examined.
  std::size_t effort() const { return effort_; }

 private:
  enum Stands : std::uint8_t { nobody, somebody, for_good };
  using Vertices = std::vector<Vertex>;
  struct Part {
    Vertices wanted;  ///< vertices that must stay connected
    Vertices all;     ///< all vertices that are connected with them
  };

  template <class Wanted>
  std::optional<std::vector<VertexMove>> way(Vertex from, Stands walls, Wanted&& wanted);
  std::optional<std::vector<VertexMove>> way_to_park();
  void park(const std::vector<VertexMove>& way);
  Vertices flood(Vertex from, std::optional<Vertex> also_taken);
  Vertices to_be_connected() const;
  void find_parts();
  bool closes_nothing(Vertex place);
  bool stays_in_one_piece(const Part& part, Vertex place);

  const AnnotatedRoadmap& graph_;
  std::vector<Robot> robots_;
  std::vector<std::uint32_t> pending_;             ///< the first is next
  std::size_t in_vain_ = 0;                        ///< consecutive robots without a way
  std::uint32_t robot_ = 0;                        ///< the robot that is to park
  std::vector<Stands> stands_;                     ///< by vertex
  std::vector<std::vector<VertexMove>> ways_out_;  ///< by robot, from where it has parked
  std::vector<Part> parts_{};                      ///< while `robot_` looks for a vertex
  std::vector<std::uint32_t> seen_;                ///< by vertex: number of the search that reached it
  std::uint32_t search_ = 0;
  std::vector<VertexMove> moves_{};
  std::size_t effort_ = 0;
};

}  // namespace coppice
