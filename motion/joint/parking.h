// Finds parking positions, at which robots of a cluster close no way, and the ways there past the others.
// Evacuate and reassemble (evacuate_and_reassemble.h) uses them.
//
// A position is suitable if the largest of the robots can drive around it. In narrow maps it is also suitable
// if the free space around all parked robots stays in one piece: the position takes away no more space than a
// robot covers, and all robots' positions and aims remain connected. An infrastructure with such positions is
// well-formed (Cap, Vokrinek, Kleiner, "Complete Decentralized Method for On-Line Multi-Robot Trajectory
// Planning in Well-formed Infrastructures", 2015).
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "motion/joint/route_finders.h"

namespace coppice {

/// The lattices on which ways are searched. `scouts` are further ones for queries in the middle of a search.
struct Lattices {
  const ClearanceField& field;
  RouteFinders finders{field};
  RouteFinders scouts{field};
  std::size_t effort() const { return finders.effort() + scouts.effort(); }
};

class Parking {
 public:
  struct Robot {
    Point2 at = Point2::Zero();
    std::optional<Point2> aim{};  ///< where the robot wants to be in the end; none: any position will do
    double radius = 0;
    bool takes_part = false;  ///< false: the robot stands at `at` for good
  };

  /// `lattices` must outlive it.
  Parking(Lattices& lattices, std::vector<Robot> robots);

  /// The way to the robot's aim, if it closes no way there. Otherwise the robot stays where it is, if it
  /// closes no way there; otherwise the way to the nearest suitable position. Empty: there is no such way
  /// now.
  Path way(std::size_t robot);
  /// The way to the nearest suitable position.
  Path way_aside(std::size_t robot);
  /// The way to its aim, even if the robot closes ways there. Empty: another robot is in the way, or there is
  /// no way.
  Path way_to_aim(std::size_t robot);

  /// The robot drives that way and parks at its end.
  void park(std::size_t robot, const Path& way);
  const Point2& at(std::size_t robot) const { return robots_[robot].at; }
  /// The robots that take part and are not parked yet; ascending.
  std::vector<std::size_t> left() const;

 private:
  struct Group {  ///< of points that are connected
    std::vector<Point2> places;
    std::size_t room;  ///< number of lattice vertices that they are connected with
  };

  void begin_search(std::size_t robot);
  std::vector<Disc> others(std::size_t robot) const;
  bool closes_nothing(const Point2& place);
  bool overlaps(const Point2& place) const;
  bool can_be_driven_around(const Point2& place) const;
  bool keeps_all_connected(const Point2& place);
  std::vector<Point2> to_be_connected() const;
  std::vector<Group> groups(double radius);
  std::vector<Disc> standing() const;

  Lattices& lattices_;
  std::vector<Robot> robots_;
  double smallest_ = 0;  ///< radius of the smallest robot that takes part
  double largest_ = 0;
  /// From the parking position back to the start; empty: the robot has not parked.
  std::vector<Path> way_out_;

  std::size_t robot_ = 0;                        ///< the robot that looks for a position
  std::vector<Point2> asked_;                    ///< positions that were examined closely
  std::size_t asks_until_ = 0;                   ///< limit of the scouts' effort
  std::map<double, std::vector<Group>> groups_;  ///< by radius; empty: not computed yet
};

}  // namespace coppice
