// How badly a simulated robot may follow, so that it keeps within its tracking tolerance. The derivation is
// in docs/ros.md.
//
// Metres, seconds, radians.
#pragma once

#include "coppice/files/scenario.h"
#include "coppice/simulation/faults.h"

namespace coppice {

/// Seconds in which a differential robot that follows comes to its largest angular speed, at most: slower
/// ones cannot turn along with a reference.
inline constexpr double longest_spin_up = 10;

/// With each of these, and with all of them, a robot keeps within its tracking tolerance.
DriveFaults largest_drive_faults(const RobotTask& task);

/// Throws InputError, which names fault, robot and what is allowed, if a robot cannot keep within its
/// tolerance.
void check_drive(const DriveFaults& drive, const Scenario& scenario);

/// Gives the robots larger tolerances than the usual ones, as far as they need them for this drive. Throws
/// InputError if there is no room for them.
void widen_tolerances(const DriveFaults& drive, Scenario& scenario);

}  // namespace coppice
