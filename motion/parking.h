// Places at which robots of a crowd close no way, and the ways there past the others: what a crowd is taken
// apart with (evacuation.h).
//
// A place will do if the largest of the robots can drive around it; or, in narrow maps, if the free space
// around all that has parked stays in one piece with it: what the place takes away is no more than what a
// robot covers, and everybody's place and aim remain connected. Such places are what makes an infrastructure
// well-formed (Cap, Vokrinek, Kleiner, "Complete Decentralized Method for On-Line Multi-Robot Trajectory
// Planning in Well-formed Infrastructures", 2015).
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "motion/route_finders.h"
#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

/// The lattices that ways are looked for on; `scouts` are the same, for what is asked in the middle of a
/// search.
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
    std::optional<Point2> aim{};  ///< where it wants to be in the end
    double radius = 0;
    bool takes_part = false;  ///< else it stands there, for good
  };

  /// `lattices` outlives it.
  Parking(Lattices& lattices, std::vector<Robot> robots);

  /// To its aim, if it closes no way there; else it stays, if it closes none where it is; else to the nearest
  /// place that will do. Empty: there is none now.
  Path way(std::size_t robot);
  /// The same, but to a place that is neither.
  Path way_aside(std::size_t robot);
  /// To its aim, whatever it closes there. Empty: somebody stands in the way.
  Path way_to_aim(std::size_t robot);

  /// It drives that way, and parks at its end.
  void park(std::size_t robot, const Path& way);
  const Point2& at(std::size_t robot) const { return robots_[robot].at; }
  /// Who takes part and is not parked yet; ascending.
  std::vector<std::size_t> left() const;

 private:
  struct Group {  ///< of places that are connected
    std::vector<Point2> places;
    std::size_t room;  ///< lattice vertices that they are connected with
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
  double smallest_ = 0;  ///< radius of one that takes part
  double largest_ = 0;
  std::vector<Path> way_out_;  ///< from where it has parked; empty: it has not

  std::size_t robot_ = 0;                        ///< that looks for a place
  std::vector<Point2> asked_;                    ///< places that were looked at closely
  std::size_t asks_until_ = 0;                   ///< effort of the scouts
  std::map<double, std::vector<Group>> groups_;  ///< by radius; empty: not looked at yet
};

}  // namespace coppice
