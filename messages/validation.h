// Nothing that comes off a bus is trusted: what a message must fulfil before a role sees it.
#pragma once

#include <optional>
#include <string>

#include "messages/messages.h"
#include "planning/clearance_field.h"
#include "planning/quantities.h"

namespace coppice {

/// Longest robot name, map id and name of a neighbour, characters: bounded in idl/fleet.idl.
inline constexpr std::size_t longest_name = 64;
/// Longest reason or cause, characters: likewise.
inline constexpr std::size_t longest_reason = 256;
/// In one state.
inline constexpr std::size_t most_echoes = 32;
inline constexpr std::size_t most_missed = 16;
/// Largest map, cells a side: 32 MiB packed, and about a gigabyte of clearance.
inline constexpr int largest_map_side = 16384;
/// Nobody binds itself for longer, seconds: who is silent would not count as dead before.
inline constexpr double longest_promise = 600;
/// Pieces of a joint plan (pieces_of, motion/precedence.h): who takes it up compares their places. Thirty
/// times as many as in the largest that was seen, 312,479 for 250 robots on a circle.
inline constexpr double most_plan_pieces = 1e7;

/// What is wrong with the message, or nothing.
std::optional<std::string> problem_with(const Message& message);

/// Whether the tree keeps the clearance that it claims: what others say of the map is looked at before a path
/// may lead along it.
bool is_free(const InactiveTreeMessage& tree, const ClearanceField& field);

/// The robot whose agent alone may send this; null for what others send, or pass on.
const RobotName* sender_of(const Message& message);

}  // namespace coppice
