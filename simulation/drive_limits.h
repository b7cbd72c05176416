// How badly a simulated robot may follow, so that it keeps within its tracking tolerance. The derivation is
// in docs/ros.md.
//
// Metres, seconds, radians.
#pragma once

#include "coppice/files/scenario.h"
#include "coppice/simulation/faults.h"

namespace coppice {

/// With each of these, and with all of them, a robot keeps within its tracking tolerance.
DriveFaults largest_drive_faults(const RobotTask& task);

/// Throws InputError, which names fault, robot and what is allowed, if a robot cannot keep within its
/// tolerance.
void check_drive(const DriveFaults& drive, const Scenario& scenario);

/// Gives the robots larger tolerances than the usual ones, as far as they need them for this drive and there
/// is room. Robots that do not bear it then get less speed. Throws InputError if there is no room at all.
void fit_to_drive(const DriveFaults& drive, Scenario& scenario);

}  // namespace coppice
