// Converts between the plain structs of messages.h and the types that fastddsgen generates from
// idl/fleet.idl, field by field (messages/fields.h).
#pragma once

#include "fleet.h"
#include "fleetPubSubTypes.h"
#include "messages/messages.h"

namespace coppice {

/// The DDS type of each message: `Type`, and `Support` for serialisation.
template <class M>
struct DdsType;

// clang-format off
#define COPPICE_DDS_TYPES(EACH)            \
  EACH(MapMessage, OccupancyMap)           \
  EACH(Mission, Mission)                   \
  EACH(RootNodes, RootNodes)               \
  EACH(InactiveTreesMessage, InactiveTree)  \
  EACH(RobotState, RobotState)             \
  EACH(JointPlanMessage, JointPlan)        \
  EACH(ReservationMessage, Reservation)    \
  EACH(PathMessage, Path)                  \
  EACH(TrackMessage, Track)                \
  EACH(AgentStatus, AgentStatus)           \
  EACH(BrokerStatus, BrokerStatus)         \
  EACH(Claim, Claim)                       \
  EACH(Assignment, Assignment)             \
  EACH(ActiveTreesMessage, ActiveTrees)    \
  EACH(ServiceStatus, ServiceStatus)       \
  EACH(OrderMessage, Order)                             \
  EACH(OrderStatus, OrderStatus)           \
  EACH(HaltMessage, Halt)
// clang-format on

#define COPPICE_DDS_TYPE(MESSAGE, TYPE)     \
  template <>                               \
  struct DdsType<MESSAGE> {                 \
    using Type = idl::TYPE;                 \
    using Support = idl::TYPE##PubSubType;  \
  };                                        \
  idl::TYPE to_dds(const MESSAGE& message); \
  MESSAGE from_dds(const idl::TYPE& sample);
COPPICE_DDS_TYPES(COPPICE_DDS_TYPE)
#undef COPPICE_DDS_TYPE

}  // namespace coppice
