// Converts between the plain structs of messages.h and the types that fastddsgen generates from
// idl/fleet.idl.
#pragma once

#include "fleet.h"
#include "fleetPubSubTypes.h"
#include "messages/messages.h"

namespace coppice {

/// The DDS type of each message: `Type`, and `Support` for serialisation.
template <class M>
struct DdsType;

#define COPPICE_DDS_TYPE(MESSAGE, TYPE)     \
  template <>                               \
  struct DdsType<MESSAGE> {                 \
    using Type = idl::TYPE;                 \
    using Support = idl::TYPE##PubSubType;  \
  };                                        \
  idl::TYPE to_dds(const MESSAGE& message); \
  MESSAGE from_dds(const idl::TYPE& sample)

COPPICE_DDS_TYPE(MapMessage, OccupancyMap);
COPPICE_DDS_TYPE(Mission, Mission);
COPPICE_DDS_TYPE(RootNodes, RootNodes);
COPPICE_DDS_TYPE(InactiveTreeMessage, InactiveTree);
COPPICE_DDS_TYPE(RobotState, RobotState);
COPPICE_DDS_TYPE(JointPlanMessage, JointPlan);
COPPICE_DDS_TYPE(PathMessage, Path);
COPPICE_DDS_TYPE(TrackMessage, Track);
COPPICE_DDS_TYPE(AgentStatus, AgentStatus);
COPPICE_DDS_TYPE(BrokerStatus, BrokerStatus);
COPPICE_DDS_TYPE(Claim, Claim);
COPPICE_DDS_TYPE(Assignment, Assignment);
COPPICE_DDS_TYPE(ActiveTreesMessage, ActiveTrees);
COPPICE_DDS_TYPE(ServiceStatus, ServiceStatus);

#undef COPPICE_DDS_TYPE

}  // namespace coppice
