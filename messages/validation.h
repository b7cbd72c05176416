// The checks that a message passes before a role sees it.
#pragma once

#include <optional>
#include <string>

#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"
#include "planning/quantities.h"

namespace coppice {

/// Longest robot name, map id and name of a neighbour, characters: bounded in idl/fleet.idl.
inline constexpr std::size_t longest_name = 64;
/// Longest reason or cause, characters: likewise.
inline constexpr std::size_t longest_reason = 256;
/// Bytes of the reason that a client gives. With the client's name it makes a reason of a status.
inline constexpr std::size_t longest_why = 128;
/// In one state.
inline constexpr std::size_t most_echoes = 32;
inline constexpr std::size_t most_missed = 16;
inline constexpr std::size_t most_known_reservations = 16;
/// In one order.
inline constexpr std::size_t most_visits = 256;
/// Seconds that a robot may be told to stand at a place.
inline constexpr double longest_visit = 86'400;
/// Largest map, cells a side: 32 MiB packed, and about a gigabyte of clearance.
inline constexpr int largest_map_side = 16384;
/// The longest promise, seconds. A silent robot is not declared failed while its promise holds.
inline constexpr double longest_promise = 600;
/// Of a reservation.
inline constexpr std::size_t most_trajectory_points = 65'536;
/// Radii: its length, at most. Gates take time and memory in proportion.
inline constexpr double most_trajectory_radii = 1e6;

/// Describes what is wrong with the message; none if it is valid.
std::optional<std::string> problem_with(const Message& message);

/// Whether the trees keep the clearance that they claim on this map. A path may lead along them only then.
bool are_free(const InactiveTreesMessage& trees, const ClearanceField& field);

/// The robot whose agent alone may send this message. Empty: only processes that are no agents may send it.
/// Null: others may send or relay it.
const RobotName* sender_of(const Message& message);

}  // namespace coppice
