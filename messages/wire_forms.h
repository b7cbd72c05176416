// Two messages travel in another form than the one in which programs use them: a map with its cells packed
// as bits, and a joint plan with the points of all trajectories one after the other. All other messages
// travel as they are.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "messages/messages.h"

namespace coppice {

struct PackedMap {
  std::string map_id;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double resolution = 0;
  Point2 origin = Point2::Zero();
  YAxis y_axis = YAxis::down;
  std::vector<std::uint8_t> occupancy{};  ///< packed_cells.h; 1: blocked
  std::vector<double> radii{};
  TreeParameters trees{};
  double margin = 0;
};

struct SentPlan {
  RoundId round;
  struct Member {
    RobotName robot{};
    double radius = 0;
    bool stranded = false;
    std::uint32_t points = 0;  ///< of its trajectory
  };
  std::vector<Member> members{};
  Trajectory points{};
  std::vector<ReservationBasis> basis{};
  RunId run;
};

/// The form in which a message travels.
template <class M>
struct WireForm {
  using Type = M;
};
template <>
struct WireForm<MapMessage> {
  using Type = PackedMap;
};
template <>
struct WireForm<JointPlanMessage> {
  using Type = SentPlan;
};

template <class M>
const M& wire_form(const M& message) {
  return message;
}
PackedMap wire_form(const MapMessage& message);
SentPlan wire_form(const JointPlanMessage& message);

template <class M>
M from_wire_form(M&& message) {
  return std::forward<M>(message);
}
/// A map without cells if there are not as many as its size says. Validation refuses that.
MapMessage from_wire_form(PackedMap&& map);
JointPlanMessage from_wire_form(SentPlan&& plan);

}  // namespace coppice
