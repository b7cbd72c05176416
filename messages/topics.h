// The one table of topics: name, message, who writes, who reads, and how it is delivered.
//
// Used by every bus and by the tests; a topic is declared nowhere else.
#pragma once

#include <string_view>

#include "messages/bus.h"

namespace coppice {

enum class Reliability : unsigned char { best_effort, reliable };
enum class Durability : unsigned char { volatile_, transient_local };

struct TopicInfo {
  std::string_view name;
  Reliability reliability;
  Durability durability;
  int depth;  ///< samples kept for each key for late readers; 0: all of a mission
};

/// Specialised for each message type: `info`, and whether a role writes or reads the topic.
template <class M>
struct Topic;

#define COPPICE_TOPIC(MESSAGE, NAME, RELIABILITY, DURABILITY, DEPTH, WRITERS, READERS)                  \
  template <>                                                                                           \
  struct Topic<MESSAGE> {                                                                               \
    static constexpr TopicInfo info{NAME, Reliability::RELIABILITY, Durability::DURABILITY, DEPTH};     \
    static constexpr bool written_by(Role role) {                                                       \
      return ((WRITERS | topic_roles::replayer) >> static_cast<unsigned>(role)) & 1;                    \
    }                                                                                                   \
    static constexpr bool read_by(Role role) { return ((READERS) >> static_cast<unsigned>(role)) & 1; } \
  }

namespace topic_roles {
inline constexpr unsigned broker = 1u << static_cast<unsigned>(Role::broker);
inline constexpr unsigned claimant = 1u << static_cast<unsigned>(Role::claimant);
inline constexpr unsigned agent = (1u << static_cast<unsigned>(Role::agent)) | claimant;  // it becomes one
inline constexpr unsigned service = 1u << static_cast<unsigned>(Role::service);
inline constexpr unsigned observer = 1u << static_cast<unsigned>(Role::observer);
inline constexpr unsigned dispatcher = 1u << static_cast<unsigned>(Role::dispatcher);
inline constexpr unsigned onlooker = observer | dispatcher | (1u << static_cast<unsigned>(Role::viewer));
// A replayer writes every topic. It reads one topic of each role of a fleet, and stops if it hears one.
inline constexpr unsigned replayer = 1u << static_cast<unsigned>(Role::replayer);
}  // namespace topic_roles

// Ten minutes of a track: a service that is away for longer finds a gap in it.
// clang-format off
//            message              name             reliability  durability       depth  written by            read by
COPPICE_TOPIC(MapMessage,          "map",           reliable,    transient_local, 1,     topic_roles::service, topic_roles::agent | topic_roles::broker | topic_roles::onlooker | topic_roles::replayer);
COPPICE_TOPIC(Mission,             "mission",       reliable,    transient_local, 1,     topic_roles::service, topic_roles::agent | topic_roles::broker | topic_roles::onlooker);
COPPICE_TOPIC(RootNodes,           "root_nodes",    reliable,    transient_local, 0,     topic_roles::agent,   topic_roles::broker | topic_roles::service | topic_roles::onlooker);
COPPICE_TOPIC(InactiveTreesMessage,"inactive_tree", reliable,    transient_local, 1,     topic_roles::broker,  topic_roles::agent | topic_roles::broker | topic_roles::service | topic_roles::onlooker);
COPPICE_TOPIC(RobotState,          "robot_state",   best_effort, volatile_,       32,    topic_roles::agent,   topic_roles::agent | topic_roles::onlooker);
COPPICE_TOPIC(JointPlanMessage,    "joint_plan",    reliable,    transient_local, 1,     topic_roles::agent | topic_roles::service, topic_roles::agent | topic_roles::onlooker);
COPPICE_TOPIC(ReservationMessage,  "reservation",   reliable,    transient_local, 1,     topic_roles::agent,   topic_roles::agent | topic_roles::onlooker);
COPPICE_TOPIC(PathMessage,         "path",          reliable,    transient_local, 1,     topic_roles::agent,   topic_roles::service | topic_roles::onlooker);
COPPICE_TOPIC(TrackMessage,        "track",         reliable,    transient_local, 1200,   topic_roles::agent,   topic_roles::service | topic_roles::observer);
COPPICE_TOPIC(AgentStatus,         "agent_status",  reliable,    transient_local, 1,     topic_roles::agent,   topic_roles::broker | topic_roles::service | topic_roles::onlooker | topic_roles::replayer);
COPPICE_TOPIC(BrokerStatus,        "broker_status", reliable,    transient_local, 1,     topic_roles::broker,  topic_roles::broker | topic_roles::service | topic_roles::onlooker | topic_roles::replayer);
COPPICE_TOPIC(Claim,               "claim",         reliable,    transient_local, 1,     topic_roles::claimant, topic_roles::service | topic_roles::observer);
COPPICE_TOPIC(Assignment,          "assignment",    reliable,    transient_local, 1,     topic_roles::service, topic_roles::claimant | topic_roles::observer);
COPPICE_TOPIC(ServiceStatus,       "service_status", reliable,   transient_local, 1,     topic_roles::service, topic_roles::service | topic_roles::onlooker);
COPPICE_TOPIC(ActiveTreesMessage,  "active_trees",  reliable,    transient_local, 1,     topic_roles::broker,  topic_roles::onlooker);
COPPICE_TOPIC(OrderMessage,               "order",         reliable,    transient_local, 1,     topic_roles::dispatcher, topic_roles::service | topic_roles::observer);
COPPICE_TOPIC(OrderStatus,         "order_status",  reliable,    transient_local, 1,     topic_roles::service, topic_roles::onlooker);
COPPICE_TOPIC(HaltMessage,         "halt",          reliable,    transient_local, 1,     topic_roles::service, topic_roles::agent | topic_roles::onlooker);
// clang-format on

#undef COPPICE_TOPIC

}  // namespace coppice
