// The bodies of the robots of a fuzz case: size, shape, speed, brakes and drive, and the margin of their
// scenario.
//
// Metres, seconds, radians.
#pragma once

#include <cstdint>

#include "coppice/files/scenario.h"

namespace coppice {

/// Gives the robots bodies that have room where their tasks lie (fuzz_tasks.h), and the scenario a margin.
/// Many fleets are of equals. `follow`: the robots get tracking tolerances.
void draw_bodies(Scenario& scenario, bool follow, std::uint32_t seed);

}  // namespace coppice
