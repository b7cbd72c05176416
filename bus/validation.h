// Nothing that comes off a bus is trusted: what a message must fulfil before a role sees it.
#pragma once

#include <optional>
#include <string>

#include "bus/messages.h"

namespace coppice {

/// Longest robot name, map id and name of a neighbour, characters: bounded in idl/fleet.idl.
inline constexpr std::size_t longest_name = 64;
/// In one state.
inline constexpr std::size_t most_echoes = 32;
/// Largest map, cells a side: 32 MiB packed, and about a gigabyte of clearance.
inline constexpr int largest_map_side = 16384;
/// Coordinates, radii, speeds and times beyond this (metres, seconds and their quotients) are nonsense on any
/// site.
inline constexpr double largest_quantity = 1e9;

/// What is wrong with the message, or nothing.
std::optional<std::string> problem_with(const Message& message);

}  // namespace coppice
