// How the robots of a run keep out of each other's way: the choices of a user.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace coppice {

enum class Coordination : std::uint8_t {
  /// Each robot reserves a trajectory around those of the others before it drives.
  reservations,
  /// The paper's protocol: a robot sets off as soon as it has a path, and avoids the others by reciprocal
  /// velocity obstacles. Robots that get stuck sort themselves out in coordination rounds.
  rvo,
  /// The same, but robots that get stuck stay stuck.
  rvo_without_rounds,
};

/// The names of the first two; a user leaves the rounds out by an option of its own.
inline constexpr std::array<std::string_view, 2> coordination_names{"reservations", "rvo"};

inline bool reserves(Coordination c) {
  return c == Coordination::reservations;
}
inline bool calls_rounds(Coordination c) {
  return c != Coordination::rvo_without_rounds;
}

}  // namespace coppice
