#include "messages/wire_forms.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "messages/validation.h"
#include "planning/geometry/packed_cells.h"

namespace coppice {

PackedMap wire_form(const MapMessage& m) {
  return {.map_id = m.map_id,
          .width = static_cast<std::uint32_t>(m.map.width),
          .height = static_cast<std::uint32_t>(m.map.height),
          .resolution = m.map.resolution,
          .origin = m.map.origin,
          .y_axis = m.map.y_axis,
          .occupancy = packed_cells<std::vector<std::uint8_t>>(m.map.blocked),
          .radii = m.radii,
          .trees = m.trees,
          .margin = m.margin};
}

MapMessage from_wire_form(PackedMap&& map) {
  const bool may_be_large = map.width <= largest_map_side && map.height <= largest_map_side;
  const std::size_t cells = may_be_large ? std::size_t{map.width} * map.height : 0;
  const bool fits = map.occupancy.size() == (cells + 7) / 8;
  return {.map_id = std::move(map.map_id),
          .map = {.width = static_cast<int>(map.width),
                  .height = static_cast<int>(map.height),
                  .resolution = map.resolution,
                  .origin = map.origin,
                  .y_axis = map.y_axis,
                  .blocked = unpacked_cells(map.occupancy, fits ? cells : 0)},
          .radii = std::move(map.radii),
          .trees = map.trees,
          .margin = map.margin};
}

SentPlan wire_form(const JointPlanMessage& m) {
  SentPlan plan{.round = m.round, .basis = m.basis, .run = m.run};
  for (const JointPlanMessage::Member& member : m.members) {
    plan.members.push_back(
        {member.robot, member.radius, member.stranded, static_cast<std::uint32_t>(member.trajectory.size())});
    plan.points.insert(plan.points.end(), member.trajectory.begin(), member.trajectory.end());
  }
  return plan;
}

/// A member that claims more points than there are left gets fewer.
JointPlanMessage from_wire_form(SentPlan&& plan) {
  JointPlanMessage m{
      .round = std::move(plan.round), .members = {}, .basis = std::move(plan.basis), .run = plan.run};
  auto next = plan.points.begin();
  for (SentPlan::Member& member : plan.members) {
    const auto points = std::min<std::ptrdiff_t>(member.points, plan.points.end() - next);
    m.members.push_back(
        {std::move(member.robot), member.radius, member.stranded, Trajectory(next, next + points)});
    next += points;
  }
  return m;
}

}  // namespace coppice
