// The data that an agent keeps as long as its process lives, through all runs and missions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "messages/messages.h"
#include "robot_agent/control/map_context.h"
#include "robot_agent/control/saved_state.h"
#include "robot_agent/control/tracking.h"
#include "robot_agent/control/tree_store.h"
#include "robot_agent/peers/age_count.h"

namespace coppice {

/// Where a robot stands: a body that an earlier run left there, or a robot that is elsewhere and was seen
/// there.
struct Standing {
  Point2 position = Point2::Zero();
  double yaw = 0;
  WallTime seen_at = 0;  ///< if it is elsewhere
};

struct AgentProcess {
  RobotName name;
  std::shared_ptr<MapContexts> map_contexts;
  std::shared_ptr<MapContext> newest_map{};  ///< null: no map has come yet
  TreeStore trees{};
  std::optional<SavedState> saved_state{};     ///< of the process before this one; until its mission comes
  std::optional<TrackingSettings> tracking{};  ///< of a robot that is elsewhere and follows this body
  std::optional<Standing> stands{};            ///< where the robot stands as a run begins; none: not known
  std::uint32_t impossible = 0;                ///< messages that the map, or the time, contradicts
  std::uint32_t rejected_by_bus = 0;
  AgentLoad load{};
  AgeCount state_ages{};
  Halt halt = Halt::none;  ///< by an operator
  bool retired = false;    ///< the process is to end
};

}  // namespace coppice
